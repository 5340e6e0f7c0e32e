"""A program's axes against travel and speed: beyond by a thousandth of a degree, exactly on the limit, within arcs."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.geometry.rigid import Rigid
from gearsim.machines.catalogue import table_table_bc
from gearsim.metrology.axis_check import AxisInspection
from gearsim.metrology.inspection import perform
from gearsim.metrology.job import Job
from gearsim.motion.axis_travel import axis_travel
from gearsim.programs.gcode import read_program
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.part import Part

STILL = Rigid(np.eye(3), np.zeros(3))
MACHINE = table_table_bc()


def blocks(*lines, machine=MACHINE):
    return read_program("\n".join(["%", "O1", "G21 G17 G90 G94 G54", *lines, "M30", "%"]) + "\n", machine).blocks


def told(given, feed=(), rapid=(), names=()):
    asked = AxisInspection("program", given, STILL, names, dict(feed), dict(rapid))
    reading = perform(asked.steps(Job("x", Part("frame", None, {}), (), "program", ())), Workshop("cpu"))
    assert all(f.fails for f in reading.findings)
    return [f.text for f in reading.findings], reading.measurements[0]


@pytest.mark.parametrize(("text", "beyond"), [("60.001", True), ("60.", False), ("59.999", False)])
def test_an_axis_beyond_its_limit_is_told_and_one_exactly_on_it_is_not(text, beyond):
    machine = MACHINE.limited(B=(np.radians(-30.0), np.radians(60.0)))
    given = blocks("G0 X0. Y0. Z50. B0. C0.", f"G1 B{text} F500.", "G1 B0.", machine=machine)
    texts, measured = told(given)
    assert len(texts) == beyond
    if beyond:
        assert texts == ["axis B goes to 60.001 deg, 0.001 deg beyond its limit of 60 deg, in line 5"]
    (b,) = (a for a in measured.axes if a.joint.name == "B")
    assert np.degrees(b.largest) == pytest.approx(float(text))


def test_both_ends_and_the_first_of_several_are_told_by_operation():
    machine = MACHINE.limited(X=(-10.0, 10.0))
    given = blocks("G0 X0. Y0. Z50. B0. C0.", "G1 X11. F500.", "G1 X12.", "G1 X-10.5", machine=machine)
    texts, _ = told(replace(given, operation=np.zeros(len(given), dtype=int)), names=("facing",))
    assert texts == [
        "axis X goes to -10.5 mm, 0.5 mm beyond its limit of -10 mm, in line 7 of facing",
        "axis X goes to 12 mm, 2 mm beyond its limit of 10 mm, in line 6 of facing, first in line 5 of facing",
    ]


@pytest.mark.parametrize(("limit", "beyond"), [(9.9999, True), (10.00001, False)])
def test_an_arc_that_bulges_beyond_a_limit_is_told(limit, beyond):
    machine = MACHINE.limited(X=(-50.0, limit))
    given = blocks("G0 X6. Y-8. Z5. B0. C0.", "G3 X6. Y8. I-6. J8. F300.", machine=machine)
    texts, measured = told(given)
    assert len(texts) == beyond
    assert measured.axes[0].largest == pytest.approx(10.0, abs=1e-6)
    assert 60.0 * measured.axes[1].fastest == pytest.approx(300.0)  # Y, where the arc runs along it
    assert 60.0 * measured.axes[0].fastest == pytest.approx(300.0 * 0.8)


def test_slides_are_looked_at_between_the_ends_of_blocks_with_tip_control():
    """The tip stands still on the workpiece while B turns by 60 deg either way: the slides swing about its centre."""
    lines = ("G43.4 H1", "G0 X0. Y0. Z0. B-60. C0.", "G1 X0. Y0. Z0. B60. F100.")
    given = blocks(*lines)
    travel = axis_travel(given)
    k = int(np.argmax(given.tip_control & (given.values[:, 3] > 1.0)))
    turn = np.linspace(-1.0, 1.0, 20001) * np.pi / 3.0
    across, up = 120.0 * np.sin(turn), 120.0 * (np.cos(turn) - 1.0)
    for column, way in ((0, across), (2, up)):
        assert travel.least[k, column] == pytest.approx(way.min(), abs=1e-6)
        assert travel.largest[k, column] == pytest.approx(way.max(), abs=1e-6)
    assert travel.rate[k, 0] == pytest.approx(120.0 * 2.0 * np.pi / 3.0, rel=1e-9)
    assert travel.rate[k, 3] == pytest.approx(2.0 * np.pi / 3.0)


def test_speeds_beyond_an_axis_s_own_are_told_and_rapids_take_as_long_as_the_slowest_axis():
    given = blocks("G0 X0. Y0. Z50. B0. C0.", "G0 X100. B30.", "G1 X0. F600.", "G1 X100. F900.")
    texts, measured = told(given, feed={"X": 10.0}, rapid={"X": 100.0, "B": np.radians(10.0), "Z": 1000.0})
    assert texts == ["axis X goes at 900 mm/min in feed, its limit is 600 mm/min, in line 7"]
    assert measured.rapid_s == pytest.approx(3.0 + abs(50.0 - given.start[2]) / 1000.0)
    assert np.isnan(told(given, rapid={"X": 100.0})[1].rapid_s)


def test_without_a_machine_nothing_is_known():
    texts, measured = told(None)
    assert (texts, measured.axes) == ([], ())


def test_where_a_control_is_assumed_to_begin_is_no_travel_of_the_program():
    """It begins, and ends by G28, at Z 500 and X 0; what the program itself states beyond the limits counts."""
    machine = MACHINE.limited(Z=(-10.0, 400.0), X=(0.5, 9.0))
    home = "G28 G91 Z0.", "G90"
    for z, beyond in ((400.0, False), (450.0, True)):
        given = blocks("G0 X0.5", f"G0 Z{z:g}.", *home, machine=machine)
        asked = AxisInspection("program", given, STILL, homing=given.line >= 6)
        reading = perform(asked.steps(Job("x", Part("frame", None, {}), (), "program", ())), Workshop("cpu"))
        assert [f.text for f in reading.findings] == (
            ["axis Z goes to 450 mm, 50 mm beyond its limit of 400 mm, in line 5"] * beyond
        )
        assert [a.largest for a in reading.measurements[0].axes if a.joint.name == "Z"] == pytest.approx([z])
