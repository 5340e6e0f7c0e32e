"""What the control knows beside the program: the tool at the start, what is zero, what numbers without a point are."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

MACHINE = table_table_bc()
BARE = "numbers without a decimal point"


def read(program, dialect="fanuc", **settings):
    chosen = ReadSettings(**{"start": {}, "home": {}, **settings})
    return read_program(program, MACHINE, dialect=dialect, settings=chosen)


def last(program, dialect="fanuc", **settings):
    return read(program, dialect, **settings).blocks.values[-1].tolist()


def test_a_number_without_a_point_is_that_with_one_and_told_once():
    program = read("G0 X0. Y0\nG1 X1. F100\nX5\nY7\nX6.\n")
    assert program.blocks.values[-1, :2].tolist() == [6.0, 7.0]
    (note,) = program.notes
    assert note.startswith(f"{BARE} are read as those with one")
    assert note.endswith("(line 3 first)")
    assert read("N5 G1 F100 X0 Y0. Z5. S1 M3").notes == ()


@pytest.mark.parametrize(
    ("program", "place"),
    [
        ("G0 X100 Y20. C90000", [0.1, 20.0, 0.0, 0.0, np.pi / 2]),
        ("G20 X10000 Y2. B-1000", [25.4, 50.8, 0.0, np.radians(-1.0), 0.0]),
        ("G91 X100\nX100\nX1.", [1.2, 0.0, 0.0, 0.0, 0.0]),
        ("G10 L2 P2 X1000\nG55 X1000", [2.0, 0.0, 0.0, 0.0, 0.0]),
    ],
)
def test_least_increments_count_thousandths(program, place):
    assert last(program, least_increment=1e-3) == pytest.approx(place, abs=1e-12)
    assert f"{BARE} count least increments, 0.001 mm" in read(program, least_increment=1e-3).notes[-1]
    padding = "G1 X1.5 F100\n" * 50
    assert last(padding + "G90 G0 X0 Y0\n" + program, least_increment=1e-3) == pytest.approx(place, abs=1e-12)


def test_least_increments_hold_in_long_runs_of_plain_lines_and_in_arcs():
    lines = [f"X{i}" if i % 3 else f"X{i}.5" for i in range(1, 300)]
    values = read("G1 F100.\n" + "\n".join(lines), least_increment=1e-3).blocks.values[:, 0]
    assert values == pytest.approx([1e-3 * i if i % 3 else i + 0.5 for i in range(1, 300)], abs=1e-12)
    arc = read("G0 X10.\nG2 X-10000 I-10000 F50", least_increment=1e-3).blocks
    assert arc.values[-1, 0] == -10.0
    assert abs(arc.sweep[-1]) == pytest.approx(np.pi)
    assert last("G0 X100", "linuxcnc", least_increment=1e-3)[0] == 100.0


def test_every_line_is_found_whichever_road_reads_it():
    plain = "G1 X1.5 F100\n" * 60
    for before in (0, 10, 60):
        program = plain[: 14 * before] + "Y3\n" + plain
        lines = program[: program.index("Y3")].count("\n") + 1
        assert f"(line {lines} first)" in read(program).notes[-1]


def test_a_radius_number_and_another_length_are_told_once():
    notes = read("T1 M6\nG43 H2 Z5. D3\nX1. D4\nG43 H2\nG43 H1", tool_lengths={1: 50.0, 2: 60.0}).notes
    assert notes == (
        "D, the number of a tool's radius, is not used: the tool's centre is programmed (line 2 first)",
        "H2 is compensated while T1 is in the spindle (line 2 first)",
    )


def test_the_tool_at_the_start_cuts_until_the_first_change():
    program = "G54 G43 H2 G0 X0. Y0. Z5.\nG1 X9. F100\nT1 M6\nG43 H1 G0 X0. Y0. Z5.\nG1 X8. F100\n"
    with pytest.raises(ProgramError, match=r"line 1, .* no tool is in the spindle here; .* or control\.start_tool"):
        read(program, tools=(1, 2))
    blocks = read(program, tools=(1, 2), start_tool=2).blocks
    assert set(blocks.tool.tolist()) == {1, 2}
    assert blocks.values[blocks.tool == 2, 0].max() == 9.0
    known = read("G0 Z5.", tools=(2,), start_tool=2, offsets={"G54": {}}, tool_lengths={2: 40.0})
    assert known.blocks.values[-1, 2] == -35.0
    with pytest.raises(ProgramError, match=r"line 2, .* no tool is in the spindle"):
        read("T0 M6\nG0 X1.", tools=(1,), start_tool=1)


@pytest.mark.parametrize(
    ("program", "note"),
    [
        ("T1 M6\nG55 G0 X1. Y1. Z1.\nG1 X2. F9", "G55 has no place in the settings, zero is assumed (line 2 first)"),
        ("T1 M6\nG54.1 P7 G0 X1.", "G54.1 P7 has no place in the settings, zero is assumed (line 2 first)"),
        ("T1 M6\nG43 H12 G0 X1. Z1.", "nobody states the length of H12, zero is assumed (line 2 first)"),
        ("T1 M6\nG0 X1. Z1.\nG1 X2. F9", ""),
    ],
)
@pytest.mark.parametrize("many", ["", "X1.5\n" * 60])
def test_what_nobody_states_is_zero_where_the_settings_say_so(program, note, many):
    with pytest.raises(ProgramError, match="not known here"):
        read(f"{program}\nZ1.\n{many}", tools=(1,))
    found = read(f"{program}\nZ1.\n{many}", tools=(1,), unstated_is_zero=True)
    assert found.blocks.values[-1, 2] == 1.0
    assert not note or note in found.notes
    with pytest.raises(ProgramError, match="no tool is in the spindle"):
        read("G0 X1.", tools=(1,), unstated_is_zero=True)


def test_an_increment_that_is_no_number_is_refused():
    with pytest.raises(InputError, match="least_increment: expected a finite number"):
        ReadSettings(least_increment=float("nan"))
