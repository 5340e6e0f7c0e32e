"""Broken programs: each is refused with line, column and word."""

import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import cradle, phoenix, star, table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

MACHINE = table_table_bc()

# (program, line, column, word as shown, a piece of the reason)
BROKEN = [
    # numbers and characters
    ("G0 X", 1, 4, "X", "a number is missing behind X"),
    ("G0\nX Y1", 2, 1, "X", "a number is missing"),
    ("G0 X1.2.3", 1, 4, "X1.2.3", "1.2.3 is not a number"),
    ("G0 X--1", 1, 4, "X--1", "is not a number"),
    ("G0 X1-2", 1, 4, "X1-2", "is not a number"),
    ("G0 X.", 1, 4, "X.", "is not a number"),
    ("G0 X-", 1, 4, "X-", "is not a number"),
    ("G0 X1E3", 1, 6, "E3", "no words with the letter E"),
    ("G0 X1 2", 1, 7, "2", "a word begins with a letter"),
    ("G0 X1 (a) 2", 1, 11, "2", "a word begins with a letter"),
    ("G0 X- 2", 1, 7, "2", "a blank ends a number"),
    ("G0 X1 (a\rb)", 1, 9, "", "a carriage return ends no line"),
    ("G0 5", 1, 4, "5", "a word begins with a letter"),
    ("G0 X1,5", 1, 6, ",", "belongs to no word"),
    ("G0 X9999999999", 1, 4, "X9999999999", "too large"),
    ("G0 X1\nG0 X2 ?", 2, 7, "?", "belongs to no word"),
    ("G0 X1\nG0 Xé", 2, 5, "'\\xe9'", "ASCII"),
    ("G0 X1\x00", 1, 6, "'\\x00'", "ASCII"),
    ("G0 X1\rG0 X2", 1, 6, "", "ASCII"),
    ("G0 X1 % ", 1, 7, "%", "alone on its line"),
    ("G0 X1 /", 1, 7, "/", "block delete stands at the start"),
    ("(not finished\nG0 X1", 1, 1, "(not finished", "the comment is not finished"),
    ("G0 X1 (a (b) c)", 1, 10, "(", "do not nest"),
    ("G0 X1 )", 1, 7, ")", "has not begun"),
    ("G0 X1" + " " * 300, 1, 257, "", "305 characters"),
    ("", 1, 1, "", "the program is empty"),
    ("%\n(nothing)\n%\n", 1, 1, "", "the program is empty"),
    # words of one block
    ("G0 G1 X1", 1, 4, "G1", "G1 and G0 are both of the group motion"),
    ("G90 G91", 1, 5, "G91", "group distance"),
    ("G54 G55", 1, 5, "G55", "group work offset"),
    ("G17 X1 G17", 1, 8, "G17", "stands twice"),
    ("G0 X1 Y2 X3", 1, 10, "X3", "X stands twice"),
    ("G0 A1", 1, 4, "A1", "no axis A; it has X, Y, Z, B, C"),
    ("G0 U1", 1, 4, "U1", "no axis U"),
    ("M3 M4 S100", 1, 4, "M4", "both of the group spindle"),
    ("M8 M3 M10 M11 S100", 1, 11, "M11", "up to 3 M words"),
    ("N1.5 G0", 1, 1, "N1.5", "a whole number"),
    ("N-1 G0", 1, 1, "N-1", "a whole number"),
    ("G0 X1 L2", 1, 7, "L2", "has a use for the letter L"),
    ("G0 X1 P2", 1, 7, "P2", "has a use for the letter P"),
    ("G0 X1 I2", 1, 7, "I2", "has a use for the letter I"),
    ("G0 X1 H2", 1, 7, "H2", "has a use for the letter H"),
    # codes
    ("G12 X1", 1, 1, "G12", "no such G code"),
    ("G1.05 X1", 1, 1, "G1.05", "no such G code"),
    ("G-1 X1", 1, 1, "G-1", "no such G code"),
    ("M77", 1, 1, "M77", "no such M code"),
    ("M3.5", 1, 1, "M3.5", "a whole number"),
    ("G90\nG41 D1 X1", 2, 1, "G41", "G41 is not read: cutter radius compensation"),
    ("G81 X1 Z-1 R1 F100", 1, 1, "G81", "canned cycle"),
    ("G68.2 X0 Y0 Z0 I0 J10 K0", 1, 1, "G68.2", "tilted working plane"),
    ("G65 P100", 1, 1, "G65", "macro call"),
    ("M98 P100", 1, 1, "M98", "subprogram"),
    ("G31 Z-1 F1", 1, 1, "G31", "skip or probing"),
    ("G96 S100", 1, 1, "G96", "constant cutting speed"),
    # macro language
    ("#1=5", 1, 1, "#", "macro language"),
    ("G0\nG1 X#1", 2, 4, "X#", "macro language"),
    ("G0 X[1+2]", 1, 4, "X[", "macro language"),
    ("G0\nWHILE [#1 LT 5] DO1", 2, 1, "WHILE", "macro language"),
    ("IF [#1 EQ 1] GOTO 10", 1, 1, "IF", "macro language"),
    ("N10 GOTO 10", 1, 5, "GOTO", "macro language"),
    # feeds
    ("G1 X1", 1, 1, "G1", "F is missing; G94"),
    ("G94 F100 G1 X1\nG93 G1 X2", 2, 5, "G1", "inverse time feed (G93) needs it in every block"),
    ("G93 G1 X1 F2\nX2", 2, 1, "X2", "inverse time feed (G93)"),
    ("G1 X1 F0", 1, 7, "F0", "a feed is above 0"),
    ("G93 G1 X1 F-5", 1, 11, "F-5", "a feed is above 0"),
    ("G95 G1 X1 F0.1", 1, 5, "G1", "S is missing"),
    ("G93 G1 X1 F2\nG94 X2", 2, 5, "X2", "F is missing; G94"),
    ("M3 S-1", 1, 4, "S-1", "not negative"),
    # arcs
    ("F100 G2 X1 Y1", 1, 6, "G2", "needs the centre (I, J) or the radius (R)"),
    ("F100 G2 X1 Y1 I1 R1", 1, 18, "R1", "not both"),
    ("F100 G2 X1 Y0 I1 K1", 1, 18, "K1", "does not belong to the plane G17"),
    ("F100 G18 G2 X1 Z0 J1", 1, 19, "J1", "does not belong to the plane G18"),
    ("F100 G2 X10 Y0 I4", 1, 16, "I4", "2 mm off its circle; up to 0.01 mm"),
    ("F100 G2 X10 Y0 R4.9", 1, 16, "R4.9", "does not reach the end, which is 10 mm away"),
    ("F100 G2 X0 Y0 R5", 1, 15, "R5", "a full circle needs its centre"),
    ("F100 G2 X5 Y0 I0 J0", 1, 15, "I0", "the arc's centre is its start"),
    ("G43.4 H1\nF100 G2 X1 Y0 I0.5", 2, 6, "G2", "tool centre point control"),
    # tools, offsets, home
    ("M6", 1, 1, "M6", "no tool is called"),
    ("T1.5 M6", 1, 1, "T1.5", "a whole number"),
    ("G43 Z1", 1, 1, "G43", "H, the number of the tool length, is missing"),
    ("G43.4 H1\nT2 M6", 2, 4, "M6", "switch it off by G49"),
    ("G54.1 X1", 1, 1, "G54.1", "P, the number of the work offset, is missing"),
    ("G54.1 P0", 1, 7, "P0", "P1 to P300"),
    ("G28", 1, 1, "G28", "the axes that go home are missing"),
    ("G91\nG53 G0 X1", 2, 1, "G53", "absolute"),
    ("F100 G53 G2 X1 I1", 1, 6, "G53", "for G0 and G1"),
    ("G53", 1, 1, "G53", "axis words are missing"),
    ("G52", 1, 1, "G52", "axis words are missing"),
    ("G92", 1, 1, "G92", "axis words are missing"),
    ("G43.4 H1\nG28 Z0", 2, 1, "G28", "switch it off by G49"),
    ("G4", 1, 1, "G4", "one time to wait"),
    ("G4 P-1", 1, 4, "P-1", "not negative"),
    ("G4 P1 Y2", 1, 7, "Y2", "moves no axis"),
]  # fmt: skip


@pytest.mark.parametrize(("program", "line", "column", "word", "reason"), BROKEN, ids=[repr(b[0])[:30] for b in BROKEN])
def test_a_broken_program_is_refused_where_it_is_broken(program, line, column, word, reason):
    with pytest.raises(ProgramError) as caught:
        read_program(program, MACHINE)
    error = caught.value
    assert isinstance(error, InputError)
    assert (error.line, error.column) == (line, column)
    assert reason in str(error)
    expected = f"program, line {line}, column {column}" + (f", {word}:" if word else "")
    assert str(error).startswith(expected)


PLAIN = "".join(f"G1 X{i}. F100\n" for i in range(100))


@pytest.mark.parametrize(("program", "line", "column", "word", "reason"), BROKEN, ids=[repr(b[0])[:30] for b in BROKEN])
def test_the_same_error_is_found_behind_plain_lines(program, line, column, word, reason):
    if "empty" in reason:
        pytest.skip("not an error behind other lines")
    switch = "G80\nG94\nG0 X0 Y0\n" if "F is missing" not in reason else "G95\nG94\nG0 X0 Y0\n"
    with pytest.raises(ProgramError) as caught:
        read_program(PLAIN + switch + program, MACHINE)
    assert (caught.value.line, caught.value.column) == (103 + line, column)
    assert reason in str(caught.value)


def test_the_first_of_two_errors_is_told():
    """An arc's end is checked later than words are read; still the earlier line wins."""
    with pytest.raises(ProgramError, match="line 2, column 11"):
        read_program("F100\nG2 X10 Y0 I4\nG1 X", MACHINE)


def test_a_file_is_named(tmp_path):
    path = tmp_path / "part.nc"
    path.write_bytes(b"G0 X1\nG0 X\n")
    with pytest.raises(ProgramError, match=r"part\.nc, line 2, column 4, X: a number is missing"):
        read_program(path, MACHINE)
    with pytest.raises(InputError, match=r"cannot read program .*none\.nc: No such file"):
        read_program(tmp_path / "none.nc", MACHINE)
    path.write_bytes(bytes(range(256)))
    with pytest.raises(ProgramError, match="line 1, column 1"):
        read_program(path, MACHINE)


def test_settings_and_machines_that_do_not_fit_are_refused():
    with pytest.raises(InputError, match="no G-code dialect 'heidenhain'; there are fanuc, linuxcnc"):
        read_program("G0 X1", MACHINE, dialect="heidenhain")
    with pytest.raises(InputError, match="axis blank_offset has no letter"):
        read_program("G0 X1", cradle())
    with pytest.raises(InputError, match="G54: machine table-table-bc has no axis A"):
        read_program("G0 X1", MACHINE, settings=ReadSettings(offsets={"G54": {"A": 1.0}}))
    with pytest.raises(InputError, match="home, axis Z: expected a finite number, got nan"):
        ReadSettings(home={"Z": float("nan")})
    with pytest.raises(
        ProgramError, match=r"line 1, column 4, T3: the settings have no length for tool 3; they have 1"
    ):
        read_program("M6 T3", MACHINE, settings=ReadSettings(tool_lengths={1: 100.0}))


def test_rotary_positions_without_a_way_to_the_tip_are_refused():
    """The Star's slides lie in one plane where its tool head stands at right angles to the slide X."""
    with pytest.raises(ProgramError, match="line 3, column 4, B90"):
        read_program("G43.4 H1\nG0\nG0 B90 X1", star())
    assert len(read_program("G43.4 H1\nG0 B90 X1", phoenix()).blocks) == 1
