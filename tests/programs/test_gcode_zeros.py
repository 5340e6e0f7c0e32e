"""Codes that are no motion: their axis words move nothing; zeros, lengths and feeds hold as on the control.

What LinuxCNC does was measured with the stand-alone interpreter of linuxcnc-uspace 2.9.0~pre1.
"""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program
from gearsim.programs.gcode.dialect import FANUC, LINUXCNC

MACHINE = table_table_bc()


def read(program, dialect="linuxcnc", **settings):
    return read_program(program, MACHINE, dialect=dialect, settings=ReadSettings(**{"start": {}, **settings}))


def x(program, dialect="linuxcnc", **settings):
    """X of all moves."""
    return read(program, dialect, **settings).blocks.values[:, 0].tolist()


def refused(program, match, dialect="linuxcnc", **settings):
    with pytest.raises(ProgramError, match=match):
        read(program, dialect, **settings)


NEEDED = {100: "L2 P1 ", 51: "Q1 ", 50: "P0 ", 541: "P1 ", 430: "H1 ", 434: "H1 ", 432: "H1 "}


@pytest.mark.parametrize("dialect", [FANUC, LINUXCNC], ids=lambda d: d.name)
@pytest.mark.parametrize("motion", ["G0", "G1", "G2"])
def test_axis_words_of_codes_that_are_no_motion_move_nothing(dialect, motion):
    """Every code the control has: refused, or without motion where the axis words are its own."""
    tried = 0
    for code in sorted({*dialect.groups, *dialect.refused} - {0, 10, 20, 30, 280}):
        for words in ("X0 Y0", "X1. Y2. Z3. C45.", "Z-5. I1. J2. K0"):
            before = f"F100 G0 X5 Y5 Z5\n{motion} {'X5 Y5 I1' if motion == 'G2' else ''}\n"
            program = f"{before}G{code / 10:g} {NEEDED.get(code, '')}{words}"
            try:
                found = read(program, dialect.name).blocks
            except ProgramError:
                continue
            if code in dialect.own_axes:
                assert len(found) == (2 if motion == "G2" else 1), (code, words)
                tried += 1
            else:
                assert found.line[-1] == 3, (code, words)  # modal: the motion in force moves the axes
    assert tried >= 6


def test_mirrors_and_look_ahead_take_their_axis_words_with_them():
    assert x("G0 X5\nG50.1 X0 Y0\nG5.1 Q1 X0 Y0 Z0\nG5.1 Q1 R5\nG5.1 Q0\nX6", "fanuc") == [5, 6]
    assert x("G0 X5\nG0 G50.1 X0", "fanuc") == [5]
    refused("G50.1 X0 G92 Y0", r"column 10, G92: G92 and G50\.1 both want the axis words", "fanuc")
    for code in ("G51.1 X0", "G68 X0 Y0 R45", "G53.1", "G30 Z0", "G27 X0", "G29 X0", "G92.1 X0", "G12.1", "G51 X0 P2"):
        refused(code, rf"{code.split()[0]} is not read: ", "fanuc")


def test_what_clears_a_zero_leaves_the_axis_words_to_the_motion():
    """LinuxCNC: G92.1 to G92.3 do not want them; G4 dwells, then the axes move."""
    assert x("G92 X-5\nG0 G92.1 X1") == [1]
    assert x("G92 X-5\nG0\nG92.1 X1\nG92.3 X2") == [1, 2]
    refused("G92.1 X1", "column 7, X1: no motion is in force")
    found = read("G0 X1\nG4 P2 X3\nG1 F60 G4 P1 X5").blocks
    assert found.values[:, 0].tolist() == [1, 1, 3, 3, 5]
    assert_allclose(found.seconds[[1, 3, 4]], [2, 1, 2])
    refused("G4 P1 G92 X1", "both of the group one block")
    refused("G4 P1 Y2", "column 7, Y2: G4 moves no axis", "fanuc")


def test_g52_and_g92_share_a_register_in_linuxcnc():
    assert x("G0 X1\nG92 X0\nG52 X5\nG0 X1") == [1, 6]
    assert x("G0 X1\nG52 X5\nG92 X0\nG0 X1\nG92.1\nX1") == [1, 2, 1]
    assert x("G52 X5 Y3\nG0 X1\nG52 X0\nX1\nG92.1\nX2") == [6, 1, 2]
    assert read("G52 X5 Y3\nG52 X0\nG0 Y1").blocks.values[0, 1] == 4
    assert x("G0 X1\nG92 X0\nG92.2\nX1\nG92.3\nX1") == [1, 1, 2]
    assert x("G92 X3\nG92.1\nG92.3\nG0 X0") == [0]
    assert x("G92 X3\nG92.2\nG52 Y1\nG92.2\nG92.3\nG0 X0") == [0]
    assert x("G92 X3\nG80 G92 X1\nG0 X0") == [-1]
    assert x("G92 X3\nG92.1 G92 X1\nG0 X0") == [0]


def test_g92_ends_g52_for_its_axes_on_a_fanuc():
    assert x("G52 X10\nG0 X1\nG92 X0\nX1\nG52 X0\nX1", "fanuc") == [11, 12, 12]
    assert read("G52 X10 Y10\nG92 X0\nG0 Y1\nG52 Y0\nY1", "fanuc").blocks.values[:, 1].tolist() == [11, 1]


def test_tables_are_set_by_g10():
    assert x("G0 X1\nG10 L2 P1 X5\nX1\nG10 L20 P1 X0\nX1\nG10 L2 P0 X3\nX1") == [1, 6, 7, 4]
    assert x("G10 L20 P2 X3\nG55\nG0 X0") == [-3]
    assert x("G91 G10 L2 P1 X5\nG10 L2 P1 X5\nG90 G0 X0") == [5]
    assert x("G20 G10 L2 P1 X1 R0\nG0 X0") == [25.4]
    assert x("G10 L2 P9 X1\nG59.3 G0 X0\nG92 X2\nG10 L20 P0 X0\nG0 X0") == [1, 1]
    refused("G10 L2 P1 X1 R5", "R5: a rotation of the work offset is not read")
    refused("G10 L2 P10", "P10: expected a whole number from 0 to 9")
    refused("G10 L1 P1 Z5", "L1: G10 L1 is not read; put tool lengths")
    refused("G10 P1 X1", "L, what is set, is missing")
    assert x("G90 G10 L2 P2 X5\nG91 G10 L2 P2 X1\nG90 G55 G0 X0\nG10 L20 P7 X9\nG54.1 P7 X0", "fanuc") == [6, 9]
    refused("G10 L2 P0 X1", "P0: work offsets are P1 to P6", "fanuc")
    refused("G10 L12 P1 R1", "G10 L12 is not read", "fanuc")
    refused("G0 G10 L2 P1 X1", "G10 and G0 both want the axis words")


def test_lengths_of_linuxcnc():
    """G43 without H and with H0 takes the tool's; G43.1 states it; G43.2 adds another one."""
    z = {"tool_lengths": {1: 50.0, 2: 80.0}}
    for code, height in (("G43", 1), ("G43 H0", 1), ("G43 H1", 1), ("G43 H2", 31), ("G43.1 Z55", 6), ("G49", -49),
                         ("G43 H1\nG43.2 H2", 81), ("G43.1 Z50\nG43.1", 1)):  # fmt: skip
        assert read(f"T1 M6\n{code}\nG0 Z1", **z).blocks.values[-1, 2] == height
    assert read("T1 M6\nG0 Z9\nG43.1 Z20\nX1", **z).blocks.values[-1, 2] == -41.0  # nothing moves
    refused("T7", "column 1, T7: the settings have no length for tool 7", **z)
    refused("M61 Q1", "M61 is not read: setting the tool number without a change")
    refused("G0 @1 ^30", "@: polar coordinates are not read; write X and Y")
    refused("G43.1 X1", "X1: a tool offset beside its length is not read")
    refused("G43.2 H1 G0 X1", "column 13, X1: G43.2 takes H or axis words, not both")
    refused("G43.1 G53", "G53: G53 and G43.1 both want the axis words")
    refused("G43.2", "H, the number of the tool length, is missing")
    refused("G49 H1", "nothing in this block has a use for the letter H")
    refused("T1 M6\nG43 H3", "the settings have no length for tool 3", **z)
    assert read("T1 M6\nG43 H0\nG0 Z1", "fanuc", **z).blocks.values[-1, 2] == -49.0


@pytest.mark.parametrize("dialect", ["fanuc", "linuxcnc"])
def test_the_feed_stays_as_fast_across_units(dialect):
    seconds = read("G20\nF20\nG0 X0\nG21\nG1 X50.8\nG20 X4\nF10\nX5\nG21 X0\nF100 X100", dialect).blocks.seconds[1:]
    assert_allclose(seconds, [6.0, 6.0, 6.0, 30.0, 60.0])
    arc = read("G20 F20\nG0 X0\nG21\nG2 X50.8 I25.4\nG95 S100 F.2\nG20 G1 X0", dialect).blocks.seconds
    assert_allclose(arc[1:], [60 * 25.4 * np.pi / 508, 60 * 50.8 / 20])
    plain = "G1 X1\n" + "X2\nX3\n" * 30
    assert_allclose(np.nansum(read("G20\nF2\nG21\n" + plain, dialect).blocks.seconds), 60 * 61 / 50.8)


def test_degrees_a_minute_have_no_unit_of_length():
    assert_allclose(read("F90\nG20 G1 C45").blocks.seconds, [30.0])
    assert_allclose(read("G20 F90\nG21 G1 C45").blocks.seconds, [30.0])


def test_f_beside_its_units():
    """LinuxCNC takes F before the units of its block; beside the first of a program it counts by these."""
    assert_allclose(read("G20 F20\nG1 X1").blocks.seconds, [3.0])
    assert_allclose(read("G21\nG20 F20 G1 X1").blocks.seconds, [60 * 25.4 / 20])
    assert_allclose(read("G21\nG20 F20 G1 X1", "fanuc").blocks.seconds, [3.0])


def test_feed_modes_forget_the_feed():
    refused("F9 G94\nG94 G1 X1", "F is missing; G94 is in force and has no feed yet")
    refused("G94 F9\nG1 X1\nG95 S9 X2", "F is missing; G95")
    assert len(read("F9 G94\nG94 G1 X1", "fanuc").blocks) == 1
    refused("G1", "column 1, G1: F is missing")
    refused("F9\nG2", "line 2, column 1, G2: G2 needs the centre")
    assert len(read("G1\nG0 X1", "fanuc").blocks) == 1


def test_a_block_that_moves_nothing_takes_no_time_in_linuxcnc():
    program = "G93 G1 X0 F2\nX1 F2\n" + 40 * "X1 F4\n"
    assert_allclose(read(program).blocks.seconds, [0.0, 30.0, *(40 * [0.0])])
    assert_allclose(read(program, "fanuc").blocks.seconds, [30.0, 30.0, *(40 * [15.0])])


def test_semicolons_end_blocks_on_a_fanuc():
    """Text behind one is the next block; in a comment it is text; LinuxCNC takes what follows for a comment."""
    assert x("G0 X1; X2;X3 ;\n(A;B) X4 (C; D);G91 X1\n;\nX1;", "fanuc") == [1, 2, 3, 4, 5, 6]
    assert read("G0 X1; X2", "fanuc").blocks.line.tolist() == [1, 1]
    refused("G0 X1; the rest", r"line 1, column 8, th: a number is missing|line 1, column 8, t: ", "fanuc")
    refused("G0 X1;X2 (open", r"column 10, \(open: the comment is not finished", "fanuc")
    assert x("G0 X1;M30;X2", "fanuc") == [1]
    assert x("/X1;X2\nX3", "fanuc", block_delete=True) == [2, 3]
    assert x("G0 X1; X2") == [1]
    program = "G0 X0\n" + "".join(f"X{i};\n" for i in range(1, 80))
    assert x(program, "fanuc") == list(range(80))


def test_offsets_without_a_place_are_told():
    program = read("G54 G0 X1.\nG55 X2.\nG54.1 P3 X3.\nG55", "fanuc", offsets={"G54": {"X": 1.0}})
    assert program.notes == (
        "G55 has no place in the settings, zero is assumed (line 2 first)",
        "G54.1 P3 has no place in the settings, zero is assumed (line 3 first)",
    )
    assert read("G54 G0 X1.\nM2").notes == ()
