"""Arcs where they are exact: circles that close, ends at a limit, half circles, no circles at all.

What LinuxCNC takes and refuses was measured with the stand-alone interpreter of linuxcnc-uspace 2.9.0~pre1.
"""

from itertools import product

import numpy as np
import pytest
from numpy.testing import assert_allclose

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ProgramError, ReadSettings, read_program

MACHINE = table_table_bc()
DIALECTS = ("fanuc", "linuxcnc")
OFFSETS = {"G55": {"X": 0.1, "Y": 0.7, "Z": 1 / 3}, "G54": {"X": 1 / 7, "Y": -300.1, "Z": 0.3}}


def blocks(program, dialect="linuxcnc", **settings):
    return read_program(program, MACHINE, dialect=dialect, settings=ReadSettings(start={}, **settings)).blocks


def sweep(program, dialect="linuxcnc", **settings):
    """The last arc's sweep [deg]."""
    return np.degrees(blocks(program, dialect, **settings).sweep[-1])


def runs(program, dialect="linuxcnc"):
    try:
        blocks(program, dialect)
    except ProgramError:
        return False
    return True


@pytest.mark.parametrize(("dialect", "units", "code"), list(product(DIALECTS, ("G20", "G21"), (2, 3))))
def test_a_circle_closes_whatever_the_sums_of_its_start(dialect, units, code, rng):
    """Steps under G91 and an offset leave the last bits of the start and of the end different."""
    unequal = 0
    for _ in range(40):
        steps = rng.integers(-300, 300, (rng.integers(1, 6), 2))
        x, y = steps.sum(axis=0) / 1000
        moves = "\n".join(f"X{a / 1000:.3f} Y{b / 1000:.3f}" for a, b in steps)
        program = f"{units} G54 F10\nG0 X0 Y0 Z0\nG55 X0 Y0\nG91 G1\n{moves}\nG90 G{code} X{x:.3f} Y{y:.3f} I.5 J-.25\n"
        found = blocks(program, dialect, offsets=OFFSETS)
        assert_allclose(np.degrees(found.sweep[-1]), 360.0 if code == 3 else -360.0, atol=1e-9)
        unequal += bool((found.before[-1, :2] != found.values[-1, :2]).any())
    assert unequal > 10


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_circle_closes_in_every_plane_and_across_offsets_and_units(dialect):
    for plane, ends, centre in (
        ("G17", "X{0} Y{1}", "I5 J1"),
        ("G18", "Z{0} X{1}", "K5 I1"),
        ("G19", "Y{0} Z{1}", "J5 K1"),
    ):
        a, b = "0.3", "0.7"
        program = f"{plane} F9\nG0 {ends.format(a, b)}\nG3 {ends.format(a, b)} {centre}\n"
        assert_allclose(sweep(program, dialect), 360.0, atol=1e-9)
        for step in (
            "G55\nG91 G0 " + ends.format(".1", ".2") + "\nG90",
            "G20 G91 G0 " + ends.format(".1", ".1") + "\nG21 G90",
        ):
            start = blocks(f"{plane} F9\nG0 {ends.format(a, b)}\n{step}", dialect, offsets=OFFSETS).values[-1]
            i, j = ("XYZ".index(word[0]) for word in ends.split())
            zero = [OFFSETS["G55" if "G55" in step else "G54"].get(axis, 0.0) - OFFSETS["G54"][axis] for axis in "XYZ"]
            here = ends.format(f"{start[i] - zero[i]:.12f}", f"{start[j] - zero[j]:.12f}")
            program = f"{plane} F9\nG0 {ends.format(a, b)}\n{step}\nG3 {here} {centre}"
            assert_allclose(sweep(program, dialect, offsets=OFFSETS), 360.0, atol=1e-9)


def test_ends_apart_by_more_than_the_resolution_make_a_short_arc():
    """LinuxCNC: 1e-6 rad (posemath's CIRCLE_FUZZ); a Fanuc with all its digits: half of 1e-6 mm."""
    for dialect, apart in (("linuxcnc", 1e-4), ("fanuc", 1e-6)):
        for factor, sign in product((0.4, 2.5), (1, -1)):
            arc = f"G0 X100 Y0 F9\nG3 X100 Y{sign * factor * apart:.9f} I-100 J0"
            turn = np.degrees(sign * factor * apart / 100.0)
            expected = turn if factor > 1 and sign > 0 else 360.0 + turn
            assert_allclose(sweep(arc, dialect), expected, atol=1e-9)
            assert_allclose(sweep(arc.replace("G3", "G2"), dialect), turn - 360.0 if expected == turn else
                            (turn if factor > 1 else turn - 360.0), atol=1e-9)  # fmt: skip


@pytest.mark.parametrize(("units", "radius", "off", "taken"), [
    ("G21", 10, 0.02828, True), ("G21", 10, 0.02829, False), ("G21", 0.02, 0.0282, True), ("G21", 0.02, -0.0182, True),
    ("G21", 28.31, 0.0283, True), ("G21", 28.25, 0.0283, False), ("G21", 1000, 0.99, True), ("G21", 1000, 1.002, False),
    ("G21", 10_000, 2.828, True), ("G21", 10_000, 2.829, False), ("G20", 1, 0.00282, True), ("G20", 1, 0.00284, False),
    ("G20", 10, 0.009, True), ("G20", 10, 0.0101, False), ("G20", 1000, 0.28, True), ("G20", 1000, 0.284, False),
])  # fmt: skip
def test_linuxcnc_takes_radii_that_differ_by_its_tolerances(units, radius, off, taken):
    assert runs(f"{units} F9\nG0 X{radius} Y0\nG3 X0 Y{radius + off:.5f} I-{radius} J0") == taken


@pytest.mark.parametrize(("units", "unit"), [("G21", 1.0), ("G20", 25.4)])
def test_fanuc_takes_radii_that_differ_by_its_parameter(units, unit):
    """0.01 mm in both units; the limit itself is within, whatever the last bit of the difference says."""
    for radius in (1, 3, 10, 77, 1000):
        assert runs(f"{units} F9\nG0 X{radius} Y0\nG3 X0 Y{radius + 0.00999 / unit:.7f} I-{radius} J0", "fanuc")
        assert not runs(f"{units} F9\nG0 X{radius} Y0\nG3 X0 Y{radius + 0.01001 / unit:.7f} I-{radius} J0", "fanuc")
        exact = f"G0 X{radius} Y0 F9\nG3 X0 Y{radius + 0.01:.2f} I-{radius} J0"
        assert runs(exact, "fanuc")
    with pytest.raises(
        ProgramError, match=r"line 2, column 13, I-5: the arc's end lies 0\.02 mm off .* up to 0\.01 mm are"
    ):
        blocks("F9 G0 X5 Y0\nG3 X0 Y5.02 I-5", "fanuc")
    assert len(blocks("G0 X5 Y0 F9\nG3 X0 Y5.3 I-5 J0", "fanuc", arc_tolerance=0.3)) == 2


@pytest.mark.parametrize(("program", "taken"), [
    ("G21\nG3 X10 Y0 R4.99874", True), ("G21\nG3 X10 Y0 R4.99872", False), ("G21\nG3 X10 Y0 R-4.9988", True),
    ("G20\nG3 X10 Y0 R4.99996", True), ("G20\nG3 X10 Y0 R4.99994", False), ("G21\nG3 X10 Y0 R0", False),
    ("G21\nG3 X.001 Y0 R0", False), ("G21\nG3 X.001 Y0 R.0005", True),
    ("G21\nG3 X0 Y0 I0.00126", False), ("G21\nG3 X0 Y0 I0.00128", True), ("G20\nG3 I0.0000496", False),
    ("G20\nG3 I0.0000504", True), ("G21\nG3 X5 I5", False), ("G21\nG3 I0 J0", False), ("G21\nG3 R5", False),
    ("G21\nG3 X0 Y0 R5", False), ("G21\nG3 Z-1 R5", False), ("G21\nG3", False), ("G21\nG3 Z-1", False),
])  # fmt: skip
def test_linuxcnc_takes_radii_that_are_too_short_or_too_small_by_its_tolerances(program, taken):
    assert runs("F9 G0 X0 Y0\n" + program) == taken


@pytest.mark.parametrize(
    ("dialect", "radius", "code"), list(product(DIALECTS, ("R5", "R-5", "R5.000", "R4.999"), (2, 3)))
)
def test_half_a_circle_by_its_radius_has_its_centre_in_the_middle(dialect, radius, code):
    """The chord is the diameter: the root of the difference must not make 1e-8 of the last bit."""
    for start, end in (((0, 0), (10, 0)), ((0.1, 0.2), (6.1, 8.2)), ((-3.3, 7.7), (-3.3, -2.3))):
        found = blocks(f"F9 G0 X{start[0]} Y{start[1]}\nG{code} X{end[0]} Y{end[1]} {radius}", dialect)
        middle = 0.5 * (np.array(start) + end)
        assert_allclose(found.centre[-1, :2], middle, atol=1e-14)
        assert_allclose(np.degrees(found.sweep[-1]), 180.0 if code == 3 else -180.0, atol=1e-12)


@pytest.mark.parametrize("dialect", DIALECTS)
def test_a_radius_does_not_settle_ends_that_are_one_point(dialect):
    for apart in ("0", "0.000000001"):
        with pytest.raises(ProgramError, match=r"R5: a full circle needs its centre"):
            blocks(f"F9 G0 X0.1 Y0\nG91 G0 X.2\nG90 G3 X0.3 Y{apart} R5", dialect)


@pytest.mark.parametrize(("dialect", "code"), list(product(DIALECTS, (2, 3))))
def test_quadrants_end_where_they_should(dialect, code):
    for quarter in range(1, 4):
        angle = quarter * 90.0 if code == 3 else -quarter * 90.0
        x, y = (round(10 * f(np.radians(angle)), 6) + 0.0 for f in (np.cos, np.sin))
        assert_allclose(sweep(f"F9 G0 X10 Y0\nG{code} X{x:g} Y{y:g} I-10 J0", dialect), angle, atol=1e-12)
        big = "-" if quarter > 2 else ""
        if quarter != 2:
            assert_allclose(sweep(f"F9 G0 X10 Y0\nG{code} X{x:g} Y{y:g} R{big}10", dialect), angle, atol=1e-9)


def test_an_absolute_centre_counts_in_the_offset_in_force():
    for zero in (
        "G55",
        "G55\nG92 X0 Y0",
        "G55\nG52 X1.5 Y-3",
        "G55\nG10 L2 P2 X9 Y8",
        "G55\nG10 L20 P2 X9 Y8",
        "T1 M6 G43",
    ):
        program = f"F9\nG0 X0 Y0 Z0\n{zero}\nG0 X0 Y0 Z0\nG90.1 G3 X6 Y8 I3 J4\nG91.1"
        found = blocks(program, offsets=OFFSETS, tool_lengths={1: 33.3})
        assert_allclose(found.centre[-1, :2] - found.before[-1, :2], [3.0, 4.0], atol=1e-12)
        assert_allclose(np.degrees(found.sweep[-1]), 180.0, atol=1e-12)
    assert_allclose(blocks("F9 G20 G0 X1 Y1\nG90.1 G2 X3 I2 J1").centre[-1, :2], [2 * 25.4, 25.4])
    with pytest.raises(
        ProgramError, match=r"line 2, column 1, G3: J is missing; an absolute centre \(G90\.1\) has both"
    ):
        blocks("F9 G90.1\nG3 X1 I.5")


def test_p_counts_turns():
    found = blocks("F60\nG0 X10 Y0 Z0\nG3 X0 Y10 Z-3 I-10 J0 P3\nG2 X0 Y10 J-10 P2\nG2 X10 Y0 R10 P2\nG2 I-10\n")
    assert_allclose(np.degrees(found.sweep[1:]), [90 + 720, -720, -90 - 360, -360], atol=1e-9)
    length = np.hypot(np.radians(810) * 10, 3.0)
    assert_allclose(found.seconds[1], length, rtol=1e-12)
    for wrong in ("P0", "P1.5", "P-1", "P1.0011"):
        with pytest.raises(ProgramError, match=rf"{wrong}: P of an arc is its number of turns"):
            blocks(f"F9 G0 X0 Y0\nG2 X0 Y0 I5 {wrong}")
    for program in ("G2 X2 Y0 I1 G4 P1", "G4 P1 X2 I1"):
        with pytest.raises(ProgramError, match="P counts the time of G4 and the turns of the arc"):
            blocks("F9 G17 G0 X0 Y0\nG2 X0 Y0 I1\n" + program)
    with pytest.raises(ProgramError, match="P2: nothing in this block has a use"):
        blocks("F9 G0 X0 Y0\nG2 X0 Y0 I5 P2", "fanuc")
