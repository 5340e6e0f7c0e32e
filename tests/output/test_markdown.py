"""Reports: names that are the user's own stay text."""

from gearsim.output.markdown import VIEW_MARK, table, write_report


def test_names_are_text_in_a_report(tmp_path):
    text = f"{VIEW_MARK}\n\n" + table(["name", "mm"], [["<script>turn()</script>", "a|b\nc"]])
    write_report(text, "<b>", tmp_path, view="<section>a view</section>")
    page = (tmp_path / "report.html").read_text()
    assert "<td>&lt;script&gt;turn()&lt;/script&gt;</td>\n<td>a|b c</td>" in page
    assert "<title>gearsim: &lt;b&gt;</title>" in page
    assert "<body><section>a view</section>" in page
