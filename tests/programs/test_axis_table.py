import csv
from contextlib import suppress

import numpy as np
import pyarrow.csv
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, head_head_cb
from gearsim.programs.axis_table import AxisTable, format_axis_table, parse_axis_table

HEAD = head_head_cb()
HEADER = "block,X_mm,Y_mm,Z_mm,B_deg,C_deg,machine\n"
NAME = "head-head-cb"


def test_the_text_names_machine_axes_and_units():
    table = AxisTable(HEAD, np.array([[1.0, -2.5, 3.0, np.pi / 2, -1e-9]]), np.array([10]))
    assert format_axis_table(table, 3) == HEADER + "10,1.000,-2.500,3.000,90.000,0.000,head-head-cb\n"


def test_comments_and_empty_lines_are_skipped_and_angles_become_radians():
    text = "# made by hand\n" + HEADER + f"\n1, 0, 0, 0, 180, -90, {NAME}\n# end\n5,1,2,3,0,0,{NAME}\n"
    table = parse_axis_table(text, HEAD)
    assert np.allclose(table.values, [[0, 0, 0, np.pi, -np.pi / 2], [1, 2, 3, 0, 0]])
    assert table.blocks.tolist() == [1, 5]


def test_plain_readers_take_it_as_it_is(tmp_path):
    values = np.array([[1.0, -2.5, 3.0, np.pi / 2, 0.0], [1.5, -2.5, 3.0, np.pi / 4, 0.0]])
    (tmp_path / "axes.csv").write_text(format_axis_table(AxisTable(HEAD, values, np.array([10, 20])), 3))
    with (tmp_path / "axes.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["X_mm"]) for row in rows] == [1.0, 1.5]
    table = pyarrow.csv.read_csv(tmp_path / "axes.csv")
    assert table["B_deg"].to_pylist() == [90.0, 45.0]
    assert [str(t) for t in table.schema.types] == ["int64", *["double"] * 5, "string"]
    read = pytest.importorskip("pandas").read_csv(tmp_path / "axes.csv")
    assert (read["block"].tolist(), read["B_deg"].tolist()) == ([10, 20], [90.0, 45.0])


@given(st.sampled_from(sorted(MACHINES)), st.integers(0, 9), st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_what_is_printed_comes_back_digit_by_digit(name, decimals, seed):
    rng = np.random.default_rng(seed)
    machine = MACHINES[name]()
    values = 100.0 * rng.normal(size=(6, len(machine.axes)))
    table = AxisTable(machine, values, np.cumsum(rng.integers(1, 50, 6)))
    text = format_axis_table(table, decimals)
    again = parse_axis_table(text, machine)
    assert format_axis_table(again, decimals) == text
    assert np.array_equal(again.blocks, table.blocks)
    assert np.abs(again.values - values).max() <= 0.5001 * 10.0**-decimals + 1e-11


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "axes.csv: expected a line block,X_mm,Y_mm,Z_mm,B_deg,C_deg,machine and at least one block"),
        (HEADER, "at least one block"),
        (HEADER + "1,0,0,0,0,0,star", "axes.csv, line 2, column machine: expected head-head-cb, got 'star'"),
        (HEADER.replace("B_deg", "B_rad") + f"1,0,0,0,0,0,{NAME}", "line 1, column 5: expected B_deg, got 'B_rad'"),
        (HEADER.replace(",machine", "") + "1,0,0,0,0,0", "line 1: column machine is missing"),
        (HEADER.replace("machine", "machine,A_deg") + "1,0,0,0,0,0", "line 1: unknown column 'A_deg' behind machine"),
        (HEADER + f"1,0,0,0,0,{NAME}", "axes.csv, line 2: 6 cells; expected 7"),
        (HEADER + f"1,0,0,0,0,0,{NAME}\n\n2,0,x,0,0,0,{NAME}", "axes.csv, line 4, column Y_mm: 'x' is not a number"),
        (HEADER + f"1,0,0,0,inf,0,{NAME}", "line 2, column B_deg: inf is not a finite number"),
        (HEADER + f"1.5,0,0,0,0,0,{NAME}", "line 2, column block: '1.5' is not a block number"),
        (HEADER + f"²,0,0,0,0,0,{NAME}", "line 2, column block: '²' is not a block number"),
        (HEADER + f"7,0,0,0,0,0,{NAME}\n7,0,0,0,0,0,{NAME}", "line 3, column block: block 7 does not rise above 7"),
    ],
)
def test_mistakes_are_named_with_line_and_column(text, message):
    with pytest.raises(InputError, match=message):
        parse_axis_table(text, HEAD, "axes.csv")


@settings(max_examples=200, deadline=None)
@given(st.lists(st.one_of(st.sampled_from([",", "\n", "1", "-0.5", "nan", "#"]), st.text(max_size=4)), max_size=30))
def test_nothing_but_its_own_error_under_random_text(parts):
    with suppress(InputError):
        parse_axis_table(HEADER + "".join(parts), HEAD)


def test_rows_know_their_lines():
    values = np.array([[1.0, 2.0, 3.0, 0.5, 0.25], [4.0, 5.0, 6.0, 0.5, 0.25]])
    head, *rows = format_axis_table(AxisTable(HEAD, values, np.array([10, 20])), 3).splitlines()
    assert parse_axis_table("\n".join(["# by hand", head, rows[0], "", rows[1], ""]), HEAD).lines == (3, 5)
