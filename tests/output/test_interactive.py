import base64
import json
import re
from dataclasses import replace

import numpy as np
import pytest

from gearsim.output.colours import STEEL, class_colours, shades
from gearsim.output.interactive import MOST, interactive_view, viewer
from gearsim.output.meshes import quads
from gearsim.output.part_view import part_view
from gearsim.output.shapes import Classes, Shape, Values
from gearsim.output.thinning import thinned, thinned_together
from tests.output.browser import needs_chromium, opened, share_in_hue

SQUARE = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]])
ALONG = np.array([1.0, 0.0, 0.0])
BOTH = np.array([[0, 1, 2], [0, 2, 3]])
OPERATIONS = ("rough", "finish </script><b>")


def square(x, um, operation):
    colours = {"deviation": Values(np.full(4, um), -5.0, 5.0, "µm"),
               "operation": Classes(np.full(2, operation), OPERATIONS)}  # fmt: skip
    return Shape(f"square at {x}", SQUARE + x * ALONG, BOTH, colours)


SQUARES = [square(0.0, -9.0, 0), square(1.0, np.nan, 1), square(2.0, 5.0, 1)]
SHAPES = [*SQUARES, Shape("table", SQUARE + 3.0 * ALONG, BOTH)]


def sheet(n, value):
    x, y = np.meshgrid(np.linspace(0.0, 10.0, n), np.linspace(0.0, 10.0, n))
    index = np.arange(n * n).reshape(n, n)
    a, b, c, d = (i.ravel() for i in (index[:-1, :-1], index[:-1, 1:], index[1:, 1:], index[1:, :-1]))
    points = np.stack([x, y, 0.0 * x], axis=-1).reshape(-1, 3)
    return Shape("sheet", points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]),
                 {"deviation": Values(value(points), -5.0, 5.0, "µm"),
                  "operation": Classes((np.arange(2 * len(a)) >= len(a)).astype(int), OPERATIONS)})  # fmt: skip


def tube(hole):
    """A square tube along x as two shapes that only together are closed; ``hole``: half its width, of 2."""
    corner = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    points = np.array([[x, *(half * at)] for x in (0.0, 4.0) for half in (2.0, hole) for at in corner])
    i = np.arange(16).reshape(2, 2, 4)  # end, ring, corner
    outer, inner, low, high = (
        [[a[k], a[(k + 1) % 4], b[(k + 1) % 4], b[k]] for k in range(4)]
        for a, b in ((i[0, 0], i[1, 0]), (i[0, 1], i[1, 1]), (i[0, 0], i[0, 1]), (i[1, 0], i[1, 1]))
    )

    def skin(name, faces):
        a, b, c, d = np.array(faces).T
        return Shape(name, points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]), body="tube")

    return [skin("outside", outer), skin("inside and ends", [*inner, *low, *high])]


def scene(html):
    return json.loads(re.search(r'<script type="application/json">(.*?)</script>', html, re.S)[1])


def unpacked(array):
    return np.frombuffer(base64.b64decode(array["data"]), dtype=f"<{array['type']}")


def test_a_view_holds_its_shapes_and_no_text_breaks_out_of_it():
    html = interactive_view(SHAPES, "a <b> & c", ["note </section>"], way=(0.0, 0.0, 2.0), up=(0.0, 3.0, 0.0))
    assert "<h2>a &lt;b&gt; &amp; c</h2>" in html
    assert html.count("<script") == html.count("</script>") == html.count("</section>") == 1
    assert "<noscript>" in html
    assert "http" not in html
    told = scene(html)
    assert (told["way"], told["up"]) == ([0.0, 0.0, 1.0], [0.0, 1.0, 0.0])
    first = told["shapes"][0]
    assert np.array_equal(unpacked(first["points"]), SQUARE.ravel())
    assert np.array_equal(unpacked(first["triangles"]), BOTH.ravel())
    assert np.isnan(unpacked(told["shapes"][1]["colours"]["deviation"])).all()
    assert [c["name"] for c in told["colourings"]] == ["deviation", "operation"]
    assert told["colourings"][0]["scale"] == shades("diverging")
    assert [name for name, _ in told["colourings"][1]["classes"]] == list(OPERATIONS)


def test_a_view_of_nothing_is_refused_and_no_part_view_is_made_of_it():
    with pytest.raises(ValueError, match="a view has at least one triangle"):
        interactive_view([], "title")
    hole = quads(np.full((2, 2, 3), np.nan), {"deviation_um": np.zeros((2, 2))})
    assert part_view({}, {"left": hole}) == ""


def test_one_colouring_has_one_scale():
    other = replace(SQUARES[0], colours={"deviation": Values(np.zeros(4), -4.0, 4.0, "µm")})
    with pytest.raises(ValueError, match="its deviation has another scale"):
        interactive_view([SQUARES[0], other], "")


@pytest.mark.parametrize(
    ("changes", "wrong"),
    [
        ({"points": SQUARE[:, :2]}, "points are finite and have shape"),
        ({"points": np.where(SQUARE == 1.0, np.nan, SQUARE)}, "points are finite"),
        ({"triangles": BOTH + 1}, "triangles name points from 0 to 3"),
        ({"colours": {"um": Values(np.zeros(3), -1.0, 1.0, "µm")}}, "expected a value at each of 4 points"),
        ({"colours": {"um": Values(np.zeros(4), 1.0, 1.0, "µm")}}, "are no scale"),
        ({"colours": {"tool": Classes(np.array([0, 2]), OPERATIONS)}}, "classes run from 0 to 1"),
        ({"colours": {"tool": Classes(np.array([0]), OPERATIONS)}}, "a class of each of 2 triangles"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(changes, wrong):
    with pytest.raises(ValueError, match=wrong):
        Shape("square", **{"points": SQUARE, "triangles": BOTH, **changes})


def test_thinning_keeps_the_worst_value_and_what_is_missing():
    def value(points):
        at = np.hypot(points[:, 0] - 5.0, points[:, 1] - 5.0)
        return np.where(at < 1e-9, -4.0, np.where(points[:, 0] + points[:, 1] < 1e-9, np.nan, 0.25))

    fine = sheet(101, value)
    coarse, cell = thinned(fine, 2000)
    assert 500 < len(coarse.triangles) <= 2000
    kept = coarse.colours["deviation"].value
    assert (np.sum(kept == -4.0), np.sum(np.isnan(kept)), np.sum(kept == 0.25)) == (1, 1, len(kept) - 2)
    assert np.linalg.norm(coarse.points[kept == -4.0] - 5.0 * np.array([1.0, 1.0, 0.0])) < cell * 3.0**0.5
    assert set(coarse.colours["operation"].number) == {0, 1}
    assert thinned(fine, len(fine.triangles)) == (fine, 0.0)


def test_shapes_of_one_body_are_thinned_alike_and_stay_closed():
    turn, up = np.meshgrid(
        np.linspace(0.0, 2.0 * np.pi, 60, endpoint=False), np.linspace(0.0, np.pi, 31), indexing="ij"
    )
    ball = np.stack([np.sin(up) * np.cos(turn), np.sin(up) * np.sin(turn), np.cos(up)], axis=-1)
    i = np.arange(60 * 31).reshape(60, 31)
    a, b, c, d = (k.ravel() for k in (i[:, :-1], np.roll(i, -1, 0)[:, :-1], np.roll(i, -1, 0)[:, 1:], i[:, 1:]))
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    upper = (ball.reshape(-1, 3)[faces][..., 2] >= 0.0).all(axis=1)
    halves = [Shape(str(k), ball.reshape(-1, 3), faces[k], body="ball") for k in (upper, ~upper)]
    coarse, _ = thinned_together(halves, 700)
    corners = np.concatenate([s.points[s.triangles] for s in coarse])
    assert 200 < len(corners) <= 700
    _, number = np.unique(corners.reshape(-1, 3), axis=0, return_inverse=True)
    edges = np.sort(number.reshape(-1, 3)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert np.all(np.unique(edges, axis=0, return_counts=True)[1] % 2 == 0)


def test_a_view_says_what_a_section_fills():
    assert "A section fills the cut face of tube;" in interactive_view(tube(1.0), "")
    assert "they enclose no material" in interactive_view(SHAPES, "")


def test_a_view_says_how_far_it_was_thinned():
    fine = sheet(21, lambda points: 0.0 * points[:, 0])
    html = interactive_view([fine, *SHAPES], "", most=200)
    assert re.search(r"Thinned for display from 808 to \d+ triangles: points within cells of [\d.]+ mm are one", html)
    assert sum(len(unpacked(s["triangles"])) // 3 for s in scene(html)["shapes"]) <= 200
    assert "808 triangles, coordinates rounded" in interactive_view([fine, *SHAPES], "")
    assert MOST >= 100_000


FETCHED = """addEventListener("load", () => setTimeout(() => {
  for (const { name } of performance.getEntriesByType("resource"))
    if (!/^(data|blob):/.test(name)) console.error(`fetched ${name}`);
}, 3000));"""


def page(folder, html, script=""):
    file = folder / "page.html"
    styles = "body{margin:0}.legend,.controls{visibility:hidden}body>*:not(.gearsim-view){display:none}"
    file.write_text(html.replace("</body>", f"<style>{styles}</style><script>{FETCHED}{script}</script></body>"))
    return file


CUT = re.search(r'CUT = "(#\w+)"', viewer())[1]
SECOND_BY_OPERATION = """setTimeout(() => {
  const [first, second, ...closed] = document.querySelectorAll(".gearsim-view");
  const press = (text) => [...second.querySelectorAll("button")].find((b) => b.textContent === text).click();
  press("operation"); press("nearer"); press("farther"); press("reset view");
  const [select, slider] = second.querySelectorAll("select, input[type=range]");
  select.value = 1; slider.value = 0.5; slider.dispatchEvent(new Event("input"));
  for (const view of closed) {
    const [select, slider] = view.querySelectorAll("select, input[type=range]");
    select.value = 0; slider.value = 0.5; slider.dispatchEvent(new Event("input"));
  }
}, 500)"""


@needs_chromium
def test_chromium_shows_colours_classes_and_sections_filled(tmp_path):
    view = interactive_view(SHAPES, "", way=(0.0, 0.0, 1.0), up=(0.0, 1.0, 0.0))
    full, hollow = (interactive_view(tube(hole), "", way=(1.0, 0.0, 0.0)) for hole in (0.0, 1.0))
    whole = f"<!doctype html><html><body>{view}{view}{full}{hollow}{viewer()}</body></html>"
    picture, said = opened(page(tmp_path, whole, SECOND_BY_OPERATION), (700, 3252))
    assert said == []
    upper, lower, full, hollow = np.split(picture, 4)
    assert share_in_hue(upper, CUT) < 1e-3
    assert share_in_hue(full, CUT) > 0.05
    assert share_in_hue(hollow, CUT) / share_in_hue(full, CUT) == pytest.approx(0.75, abs=0.02)
    scale = shades("diverging")
    in_first = {colour: share_in_hue(upper, colour) for colour in (scale[0], scale[-1], STEEL)}
    assert all(share > 0.01 for share in in_first.values()), in_first
    missing = (upper.max(axis=-1) < 0.05).mean()
    assert missing > 0.01
    in_second = {colour: share_in_hue(lower, colour) for colour in class_colours(OPERATIONS)}
    assert all(share > 0.005 for share in in_second.values()), in_second
    assert (lower.max(axis=-1) < 0.05).mean() < 0.3 * missing  # by operation nothing is missing
    left = in_second[class_colours(OPERATIONS)[0]] / in_first[scale[0]]
    assert 0.4 < left < 0.6  # of one square under the section plane


@needs_chromium
def test_chromium_shows_the_tooth_of_a_run(folder, tmp_path):
    picture, said = opened(page(tmp_path, (folder / "report.html").read_text()), (500, 900))
    assert said == []
    assert share_in_hue(picture, shades("diverging")[-1]) > 0.01  # stock left on the bottom land
    assert share_in_hue(picture, STEEL) > 0.02
    assert (folder / "report.html").stat().st_size < 15e6


@needs_chromium
def test_the_console_is_heard(tmp_path):
    broken = interactive_view(SQUARES, "").replace('"points"', '"point"')
    fetching = '<script src="http://localhost/x.js"></script>'
    _, said = opened(page(tmp_path, f"<html><body>{broken}{fetching}{viewer()}</body></html>"), (300, 300))
    assert any("Cannot read properties of undefined" in line for line in said)
    assert any("fetched http://localhost/x.js" in line for line in said)
