"""The suite `program` at a tiny size; no assertion on time."""

from gearsim.bench import program, suites
from gearsim.machines.catalogue import table_table_bc
from gearsim.output.screen import print_bench
from gearsim.programs.gcode import read_program


def test_the_programs_have_as_many_blocks_as_asked_for():
    blocks = read_program(program.five_axis(1234, between="(PASS)\n"), table_table_bc()).blocks
    assert len(blocks) == 1234
    assert (blocks.seconds > 0.0).all()
    assert read_program(program.five_axis(10, "G43.4 H1"), table_table_bc()).blocks.tip_control.all()


def test_a_report_fits_its_columns_and_its_screen(monkeypatch, capsys):
    monkeypatch.setattr(program, "LINES", {"small": (50, 100)})
    monkeypatch.setattr(program, "MIXED_LINES", 30)
    report = suites.run_suite("program", "cpu")
    assert [row["lines"] for row in report["rows"]] == [58, 108, 108, 68]
    assert all(set(report["columns"]) <= set(row) and row["lines/s"] > 0 for row in report["rows"])
    print_bench(report)
    assert "lines/s" in capsys.readouterr().out
