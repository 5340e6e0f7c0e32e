from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, head_head_cb
from gearsim.programs.axis_table import AxisTable, format_axis_table, parse_axis_table

HEAD = head_head_cb()
HEADER = "machine,head-head-cb\nblock,X_mm,Y_mm,Z_mm,B_deg,C_deg\n"


def test_the_text_names_machine_axes_and_units():
    table = AxisTable(HEAD, np.array([[1.0, -2.5, 3.0, np.pi / 2, -1e-9]]), np.array([10]))
    assert format_axis_table(table, 3) == HEADER + "10,1.000,-2.500,3.000,90.000,0.000\n"


def test_comments_and_empty_lines_are_skipped_and_angles_become_radians():
    text = "# made by hand\n" + HEADER + "\n1, 0, 0, 0, 180, -90\n# end\n5,1,2,3,0,0\n"
    table = parse_axis_table(text, HEAD)
    assert np.allclose(table.values, [[0, 0, 0, np.pi, -np.pi / 2], [1, 2, 3, 0, 0]])
    assert table.blocks.tolist() == [1, 5]


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
        ("", "axes.csv: expected a line machine,head-head-cb, a line block,X_mm"),
        (HEADER, "at least one block"),
        ("machine,star\n" + HEADER, "axes.csv, line 1: expected machine,head-head-cb, got machine,star"),
        (HEADER.replace("B_deg", "B_rad") + "1,0,0,0,0,0", "line 2, column 5: expected B_deg, got 'B_rad'"),
        (HEADER.replace(",C_deg", "") + "1,0,0,0,0,0", "line 2: column C_deg is missing"),
        (HEADER.replace("C_deg", "C_deg,A_deg") + "1,0,0,0,0,0", "line 2: unknown column 'A_deg' behind C_deg"),
        (HEADER + "1,0,0,0,0", "axes.csv, line 3: 5 cells; expected 6"),
        (HEADER + "1,0,0,0,0,0\n\n2,0,x,0,0,0", "axes.csv, line 5, column Y_mm: 'x' is not a number"),
        (HEADER + "1,0,0,0,inf,0", "line 3, column B_deg: inf is not a finite number"),
        (HEADER + "1.5,0,0,0,0,0", "line 3, column block: '1.5' is not a block number"),
        (HEADER + "²,0,0,0,0,0", "line 3, column block: '²' is not a block number"),
        (HEADER + "7,0,0,0,0,0\n7,0,0,0,0,0", "line 4, column block: block 7 does not rise above 7"),
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
