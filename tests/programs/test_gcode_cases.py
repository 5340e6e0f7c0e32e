"""Small programs that were read wrongly once: what each of them does on the control it is written for."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

FOLDER = Path(__file__).parents[1] / "data" / "gcode"
MACHINE = table_table_bc()


def blocks(name, **settings):
    """The blocks of a file, in the dialect of its ending, from machine zero."""
    dialect = "linuxcnc" if name.endswith(".ngc") else "fanuc"
    chosen = ReadSettings(**{"start": {}, **settings})
    return read_program(FOLDER / name, MACHINE, dialect=dialect, settings=chosen).blocks


def circle(name):
    last = blocks(name)
    assert_allclose(np.degrees(last.sweep[-1]), 360.0, atol=1e-9)
    assert_allclose(last.centre[-1, :2], [5.0, 0.3], atol=1e-12)


def turns(name):
    last = blocks(name)
    assert_allclose(last.sweep[-1], -4 * 2 * np.pi, rtol=1e-15)
    assert_allclose(last.values[-1, :3], [0.0, 80.0, -12.0])
    assert_allclose(last.centre[-1, :2], [0.0, 0.0])


def units(name):
    """20 inch/min are 508 mm/min, in G21, too."""
    assert_allclose(blocks(name).seconds[-1], 60.0 * 50.8 / 508.0, rtol=1e-12)


def absolute_centre(name):
    arc = blocks(name, offsets={"G57": {"X": 100.0}})
    assert_allclose(arc.centre[-1, :2], [105.0, 1.0], atol=1e-12)
    assert_allclose(np.degrees(arc.sweep[-1]), -np.degrees(2 * np.arctan2(1.0, 5.0)), atol=1e-12)


def loaded_length(name):
    """With the tool's own length compensated the tip goes where the program says; with none it was 50 mm lower."""
    assert_allclose(blocks(name, tool_lengths={1: 50.0}).values[-1, 2], 1.0)


def one_register(name):
    assert_allclose(blocks(name).values[:, 0], [1.0, 6.0])


def no_motion(name):
    assert_allclose(blocks(name).values[:, :2], [[5.0, 5.0]])


def arguments_behind_comments(name):
    assert_allclose(blocks(name).values[:, :2], [[1.0, 2.0]])


def equal_within_tolerance(name):
    assert_allclose(blocks(name).values[:, 0], [1.0])


def rounded_away_from_zero(name):
    assert_allclose(blocks(name).values[:, 0], [-3.0])


def text_behind_an_o_word(name):
    with pytest.raises(ProgramError, match=r"trailing\.ngc, line 3, column 10, G0 X2"):
        blocks(name)


CASES = {
    "circle.nc": circle,
    "turns.ngc": turns,
    "units.ngc": units,
    "g901_offset.ngc": absolute_centre,
    "g43_h0.ngc": loaded_length,
    "g92_g52.ngc": one_register,
    "fanuc_g501.nc": no_motion,
    "call_comment.ngc": arguments_behind_comments,
    "eq.ngc": equal_within_tolerance,
    "round.ngc": rounded_away_from_zero,
    "trailing.ngc": text_behind_an_o_word,
}


@pytest.mark.parametrize("name", CASES)
def test_a_program_does_what_its_control_does(name):
    CASES[name](name)


def test_every_program_has_its_answer():
    assert {path.name for path in FOLDER.iterdir() if path.is_file()} == set(CASES)
