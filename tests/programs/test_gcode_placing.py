"""Programs that are meant to be cut: what must be known of every move, and where it is known all the same."""

import pytest

from gearsim.machines.catalogue import head_head_cb, phoenix, table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

HEAD = "T1 M6\nG54 G43 H1\nG0 X0 Y0 Z5\n"


def read(program, dialect="fanuc", machine=None, **settings):
    chosen = ReadSettings(**{"tools": (1, 2), **settings})
    return read_program(program, machine or table_table_bc(), dialect=dialect, settings=chosen).blocks


def refused(program, match, dialect="fanuc", **settings):
    with pytest.raises(ProgramError, match=match):
        read(program, dialect, **settings)


@pytest.mark.parametrize("machine", [table_table_bc(), head_head_cb(), phoenix()], ids=lambda m: m.name)
@pytest.mark.parametrize("length", ["G43", "G43.4"])
def test_a_program_that_says_everything_is_read_as_without_tools(machine, length):
    program = f"G91 G28 Z0\nT1 M6\nG90 G54 G0 X1 Y2\n{length} H1 Z50\nG1 Z-1 F100\nX5\nG91 Y3\nG90 G49\nG91 G28 Z0\n"
    program += f"T2 M6\nG90 G0 X1 Y2\n{length} H2 Z50\nG1 Z-1\n" + "".join(f"X{i}\n" for i in range(80))
    with_tools, without = read(program, machine=machine), read(program, machine=machine, tools=None)
    assert with_tools.values.tolist() == without.values.tolist()
    assert with_tools.seconds[~with_tools.rapid].tolist() == without.seconds[~without.rapid].tolist()


REFUSED = [
    ("G0 X1", "line 1, column 1, G0: no tool is in the spindle here"),
    ("G90 G28 Z0", "line 1, column 5, G28: no tool"),
    ("G53 G1 Z0 F9", "line 1, column 5, G1: no tool"),
    ("T1\nG0 X1", "line 2, column 1, G0: no tool"),
    (HEAD + "T0 M6\nX1", "line 5, column 1, X1: no tool"),
    (HEAD + "G1 X1 F9\n" + "X2\n" * 50 + "T0 M6\nX1", "line 56, column 1, X1: no tool"),
    ("T3 M6", "line 1, column 1, T3: tool T3 is not among the tools there are: T1, T2"),
    (HEAD + "G55 X1", r"line 4, column 5, X1: G55 is in force, .* known are G54"),
    (HEAD + "G55\n" + "G1 X1 F9\n" * 50, r"line 5, column 1, G1: G55 is in force"),
    (HEAD + "G49 Z1", r"line 4, column 5, Z1: no tool length is compensated, T1 .* G43 H1 is missing"),
    (HEAD + "G49\n" + "G1 Z1 F9\n" * 50, r"line 5, column 4, Z1: no tool length is compensated"),
    (HEAD + "G43 H2 Z1", r"line 4, column 8, Z1: H2 is compensated, T1 is in the spindle, .* expected H1"),
    ("T1 M6\nG43.4 H2 X1 Y1 Z1", r"line 2, column 16, Z1: H2 is compensated"),
    (HEAD + "T2 M6\nG1 X1 F9", r"line 5, column 1, G1: where Z stands is not known here; move it to an absolute Z"),
    (HEAD + "T2 M6\nZ1", r"line 5, column 1, Z1: H1 is compensated, T2 is in the spindle"),
    (HEAD + "G28 Z9\nG1 X1 F9", r"line 5, column 1, G1: where Z stands is not known here; .* with G43 in force"),
    (HEAD + "G53 X0\nG1 Y1 F9", r"line 5, column 1, G1: where X stands is not known"),
    (HEAD + "G53 X0\nG1 F9\n" + "Y1\n" * 50, r"line 6, column 1, Y1: where X stands is not known"),
    (HEAD + "G53 G1 X0 F9", r"line 4, column 5, G1: where X stands is not known"),
    ("T1 M6\nG43 H1\nG91 G0 X1 Y1 Z-100\nG1 X1 F9", r"line 4, column 1, G1: where X stands"),
    ("T1 M6\nG92 X0", "line 2, column 1, G92: it sets a zero where the tool stands, and where X stands is not known"),
    (HEAD + "G10 L2 P1 X1", "line 4, column 1, G10: it states a work offset in machine coordinates"),
]  # fmt: skip


@pytest.mark.parametrize(("program", "match"), REFUSED, ids=[str(i) for i in range(len(REFUSED))])
def test_a_move_of_which_something_is_not_known_is_refused(program, match):
    refused(program, match)
    read(program.replace("T3", "T2"), tools=None)  # and nothing else is wrong with it


def test_linuxcnc_is_asked_the_same():
    refused("G10 L20 P1 X0", "G10: it sets a zero where the tool stands", "linuxcnc")
    refused("G10 L2 P1 X0", "G10: it states a work offset in machine", "linuxcnc")
    refused("T1 M6\nG43.1 Z5\nG0 Z1", "Z1: a length of no table is compensated", "linuxcnc")
    refused("T1 M6\nG43\nG43.2 H2\nG0 Z1", "Z1: a length of no table is compensated", "linuxcnc")
    refused("T1 M6\nG0 X0 Y0\nG43 Z5\nG28\nG1 Z3 F9", "line 5, column 1, G1: where X stands", "linuxcnc")
    assert len(read("G28\nT1 M6\nG0 G43 X0 Y0 Z5\nG92 X3\nG10 L20 P2 Z9\nG55 G1 Z8 F9", "linuxcnc")) == 2


def test_what_the_settings_place_is_known():
    """With the workpiece in machine coordinates and lengths of both tools there is nothing left to ask."""
    known = {"offsets": {"G54": {"Z": 100.0}, "G55": {"X": 5.0}}, "tool_lengths": {1: 50.0, 2: 80.0}}
    program = "T1 M6\nG0 Z1\nG1 X1 F9\nG43 H2 Z1\nG53 Z-5\nX2\nG55 X1\nG10 L2 P3 X1\nG56 X1\nG92 Z5\nT2 M6\nX1"
    assert len(read(program, **known)) > 8
    refused("T1 M6\nG0 Z1", "no tool length", offsets=known["offsets"])
    refused("T1 M6\nG43 H1 G0 Z1\nG1 Z0 F9", "where X stands", tool_lengths=known["tool_lengths"])
    assert read("T1 M6\nG55 G43 H1 G0 X0 Y0 Z0", workpiece="G55").values[-1, :3].tolist() == [0, 0, 0]
    refused("T1 M6\nG43 H1 G0 X0 Y0 Z0", "G54 is in force, .* known are G55", workpiece="G55")
