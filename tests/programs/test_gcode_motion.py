"""Valid programs in the Fanuc dialect: their blocks, derived by hand."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from gearsim.machines.catalogue import head_head_cb, phoenix, table_table_bc
from gearsim.programs.gcode import ReadSettings, read_program

MACHINE = table_table_bc()
DEG = np.pi / 180.0


def read(program, machine=MACHINE, **settings):
    return read_program(program, machine, settings=ReadSettings(**settings))


def values(program, **settings):
    return read(program, **settings).blocks.values


def test_modal_words_hold_until_they_change():
    blocks = read("N1 G90 G94 G0 X1. Y2 Z3\nN2 G1 X4 F100\nN3 Y5\nN4\nN5 G0 Z6\nN6 B-90. C180").blocks
    z = [1.0, 2.0, 3.0, 0.0, 0.0]
    assert_allclose(blocks.start, [0, 0, 500, 0, 0])
    expected = [z, [4, 2, 3, 0, 0], [4, 5, 3, 0, 0], [4, 5, 6, 0, 0], [4, 5, 6, -90 * DEG, 180 * DEG]]
    assert_allclose(blocks.values, expected, atol=1e-15)
    assert_array_equal(blocks.rapid, [True, False, False, True, True])
    assert_array_equal(blocks.line, [1, 2, 3, 5, 6])
    assert_array_equal(np.isnan(blocks.seconds), blocks.rapid)
    assert_allclose(blocks.seconds[[1, 2]], [60 * 3 / 100, 60 * 3 / 100])


def test_incremental_and_absolute_and_inches():
    assert_allclose(values("G0 X1 Z0\nG91 X2 C90\nX-0.5\nG90 X7")[:, 0], [1, 3, 2.5, 7])
    inches = values("G20 G90 G0 X1 Y.5 Z-2. B10\nG91 X1\nG21 X1")
    assert_allclose(inches[:, 0], [25.4, 50.8, 51.8])
    assert_allclose(inches[0], [25.4, 12.7, -50.8, 10 * DEG, 0])
    assert_allclose(values("G0 X1", units="inch")[0, 0], 25.4)


def test_numbers_are_read_as_a_calculator_does():
    """X10 is ten millimetres; signs, leading and trailing points, spaces and lower case are all right."""
    assert_allclose(values("g0 x10\nX-.5\nX+5.\nX 007.250\nX 1;\nG00X2Y3Z4")[:, 0], [10, -0.5, 5, 7.25, 1, 2])


def test_inverse_time_states_the_seconds():
    blocks = read("G93 G1 X1 F4\nX1 F2.5\nG0 X5\nG1 B9 F60").blocks
    assert_allclose(blocks.seconds, [15, 24, np.nan, 1])


def test_feed_per_minute_counts_all_axes_per_revolution_times_the_speed():
    """Fanuc: sqrt(30^2 + 40^2) = 50, a degree counting as a millimetre."""
    assert_allclose(read("G1 F500 X30 Z540\nF100 B30 C40").blocks.seconds, [6.0, 30.0])
    assert_allclose(read("G1 F500 X30 C40").blocks.seconds, [6.0])
    assert_allclose(read("G20 G1 F10 X5").blocks.seconds, [30.0])
    assert_allclose(read("G95 S200 M3\nG1 X40 F.1").blocks.seconds, [60 * 40 / 20])


def test_arcs_have_centre_and_sweep():
    blocks = read(
        "G0 X10 Y0 Z0\nG3 X0 Y10 I-10 J0 F100\nG2 X10 Y0 R10\nG2 X0 Y-10 R10\nG2 X10 Y0 R-10\nG3 I-10\n"
        "G0 X0 Y0 Z0\nG18 G3 Z0 X20 I10 Y5\nG19 G2 Y5 Z10 K5\n"
    ).blocks
    assert_allclose(np.degrees(blocks.sweep), [0, 90, -90, -90, -270, 360, 0, 180, -180], atol=1e-12)
    assert_allclose(blocks.centre[1:6], np.zeros((5, 3)), atol=1e-9)
    assert_allclose(blocks.centre[7:], [[10, 0, 0], [20, 5, 5]], atol=1e-12)
    assert_array_equal(blocks.normal[blocks.sweep != 0], [2, 2, 2, 2, 2, 1, 0])
    quarter = 60 * 10 * np.pi / 2 / 100
    assert_allclose(blocks.seconds[[1, 2, 3, 4, 5]], quarter * np.array([1, 1, 1, 3, 4]))
    assert_allclose(blocks.seconds[7], 60 * np.pi * 10 / 100)  # the way in the arc's plane


@pytest.mark.parametrize("plane", [17, 18, 19])
@pytest.mark.parametrize("radius", [7.0, -7.0, 5.0])
@pytest.mark.parametrize("code", [2, 3])
def test_an_arc_by_radius_ends_where_it_should(plane, radius, code):
    """Turning the start about the centre by the sweep gives the end; R < 0 is more than half a circle."""
    a, b, c = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    end = [0.0, 0.0, 0.0]
    end[a], end[b] = 6.0, 8.0
    words = " ".join(f"{axis}{value}" for axis, value in zip("XYZ", end, strict=True))
    blocks = read(f"G0 X0 Y0 Z0\nG{plane} G{code} {words} R{radius} F1").blocks
    sweep, centre = blocks.sweep[1], blocks.centre[1]
    assert (sweep > 0) == (code == 3)
    assert (abs(sweep) > np.pi + 1e-9) == (radius < 0)
    arm = -centre
    turned = np.cos(sweep) * arm + np.sin(sweep) * np.cross(np.eye(3)[c], arm)
    assert_allclose(centre + turned, end, atol=1e-12)
    assert_allclose(np.linalg.norm(arm), abs(radius))


def test_home_is_reached_by_an_intermediate_point():
    blocks = read("G0 X10 Y10 Z10\nG91 G28 Z5\nG90 G28 X20 Y0\nG91 G28 Z0", home={"X": -7, "Z": 400}).blocks
    expected = [[10, 10, 10], [10, 10, 15], [10, 10, 400], [20, 0, 400], [-7, 0, 400]]
    assert_allclose(blocks.values[:, :3], expected)
    assert blocks.rapid.all()
    assert_array_equal(blocks.line, [1, 2, 2, 3, 3])


def test_the_usual_first_lines_are_understood():
    program = "G0 G17 G21 G40 G49 G50 G69 G80 G90 G94 G98\nG00 G91 G28 Z0.\nG0 G90 G54 X1 M3 S100\nG43 Z5 H1 M8\nX2"
    blocks = read(program, start={"Z": 400}).blocks
    assert_allclose(blocks.values[:, [0, 2]], [[0, 500], [1, 500], [1, 5], [2, 5]])


def test_work_offsets_count_from_the_workpiece():
    offsets = {"G54": {"X": 100.0, "Z": 50.0}, "G55": {"X": 130.0, "Z": 50.0, "C": 90 * DEG}, "G54.1 P2": {"X": 99.0}}
    program = "G0 X1\nG55 X1 C0\nG54.1 P2 X1\nG54 X1\nG53 X1\nX2"
    assert_allclose(values(program, offsets=offsets)[:, 0], [1, 31, 0, 1, -99, 2])
    assert_allclose(values(program, offsets=offsets)[1, 4], 90 * DEG)
    assert_allclose(values(program, offsets=offsets, workpiece="G55")[:, 0], [-29, 1, -30, -29, -129, -28])
    assert_allclose(values("G0 Z0", offsets=offsets, home={"Z": 0.0})[0, 2], 0.0)
    assert_allclose(read("G0 X0", offsets=offsets, home={"X": 7.0}).blocks.start[0], -93.0)


def test_local_and_shifted_zeros():
    assert_allclose(values("G52 X10\nG0 X1\nG52 X0\nX1")[:, 0], [11, 1])
    assert_allclose(values("G0 X5\nG92 X0 Y1\nX1 Y1\nG91 X1")[:, 0], [5, 6, 7])


def test_without_length_compensation_the_tip_is_lower_by_the_tool():
    lengths = {1: 100.0, 2: 80.0}
    program = "T1 M6\nG0 Z0\nG43 H1 Z0\nG49 Z0\nG43 H2 Z0\nG0 G53 Z0"
    blocks = read(program, tool_lengths=lengths, home={"Z": 300.0}).blocks
    assert_allclose(blocks.values[:, 2], [200, -100, 0, -100, -20, -100])
    assert_allclose(values("T1 M6\nG43 H1 G0 Z5\nT2 M6\nZ5\nG43 H2 Z5", tool_lengths=lengths)[1:, 2], [5, 25, 25, 5])


def test_tip_control_solves_the_slides():
    program = "G0 B10 C20\nG43.4 H1 X1 Y2 Z3\nG93 G1 X2 B30 F6\nG49\nG0 Z100"
    blocks = read(program).blocks
    tips = MACHINE.forward(blocks.values)[0]
    assert_allclose(tips[[1, 2]], [[1, 2, 3], [2, 2, 3]], atol=1e-12)
    assert_array_equal(blocks.tip_control, [False, True, True, False])
    assert_allclose(blocks.values[2, 3:], [30 * DEG, 20 * DEG])
    assert_allclose(blocks.values[3, :2], blocks.values[2, :2])
    assert blocks.values[3, 2] == 100.0
    assert_allclose(blocks.seconds[2], 10.0)


@pytest.mark.parametrize("machine", [head_head_cb(), phoenix()], ids=["head-head", "phoenix"])
def test_tip_control_under_offsets_and_a_wrong_length(machine):
    """A linear offset moves all tips as it does at rest; a tool longer than H says stands lower along its axis."""
    axis = machine.axes[4]
    program = f"T1 M6\nG55\nG43.4 H2\nG0 X1 Y2 Z3 {axis}35\nG91 X1\n"
    settings = {"offsets": {"G55": {"X": 10.0, "Y": 20.0, "Z": 30.0}}, "tool_lengths": {1: 103.0, 2: 100.0}}
    blocks = read(program, machine, **settings).blocks
    tip, direction = machine.forward(blocks.values[1:])
    still = machine.forward(machine.values(X=[0.0, 10.0], Y=[0.0, 20.0], Z=[0.0, 30.0]))[0]
    wanted = np.array([[1, 2, 3], [2, 2, 3]]) + still[1] - still[0] - 3.0 * direction
    assert_allclose(tip, wanted, atol=1e-11)


def test_feed_under_tip_control_counts_the_tips_way():
    blocks = read("G43.4 H1\nG0 X0 Y0 Z0\nG1 X3 Y4 C90 F10\nC0").blocks
    assert_allclose(blocks.seconds[1:], [30.0, 540.0])


def test_dwell_stands_for_its_time():
    blocks = read("G0 X1\nG4 P1500\nG4 X2.5\nG93\nG04 P100").blocks
    assert_allclose(blocks.seconds[1:], [1.5, 2.5, 0.1])
    assert_allclose(blocks.values[1:], blocks.values[:3])


def test_the_program_tells_of_itself():
    program = read(
        "%\nO0042 (SPUR GEAR)\n(HEADER)\nG21 G40\nN10 (ROUGHING)\n(MORE)\nG91 G28 Z0\nT3 M6\nG90 G0 X1\nG1 X2 F1\n"
        "N20 (FINISHING)\nG0 X3\nG1 X4\nT5 M6 (DRILL)\nX5\nG64 X6\nM30\nG0 X9\n%\n"
    )
    assert (program.number, program.title) == (42, "SPUR GEAR")
    assert program.operations == ("ROUGHING", "FINISHING", "DRILL")
    assert program.tools == (3, 5)
    assert_array_equal(program.blocks.operation, [0, 0, 1, 1, 2, 2])
    assert_array_equal(program.blocks.tool, [3, 3, 3, 3, 5, 5])
    assert len(program.notes) == 2
    assert "G64 (line 16 first)" in program.notes[0]
    assert "numbers without a decimal point are read as those with one" in program.notes[1]


def test_block_delete_and_the_end_of_the_program():
    program = "%\nG0 X1\n/G0 X2\n /2 X3\n%\nnothing here is read"
    assert_allclose(values(program)[:, 0], [1, 2, 3])
    assert_allclose(values(program, block_delete=True)[:, 0], [1])
    assert_allclose(values("G0 X1\nM2\nrest")[:, 0], [1])


def test_a_program_without_motion_has_no_blocks():
    program = read("G90 G54\nT1 M6")
    assert len(program.blocks) == 0
    assert program.tools == (1,)
