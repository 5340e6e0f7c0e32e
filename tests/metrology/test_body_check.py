"""Tools and what holds them against a machine's table and fixtures: a tenth in the way, exact touches, clear ones."""

import numpy as np
import pytest

from gearsim.cutters.end_mills import drill, flat
from gearsim.cutters.holder import holder, standing_on
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block, Shifted
from gearsim.geometry.turned import Turned
from gearsim.metrology.body_check import BodyInspection
from gearsim.metrology.body_rays import body_rays
from gearsim.metrology.inspection import perform
from gearsim.metrology.job import Job
from gearsim.motion.sources import CLMotion
from gearsim.simulation.operation import Variant, operation
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.part import Part

MILL = flat(10.0, 30.0)
STILL = Rigid(np.eye(3), np.zeros(3))
CLAMP = Block(np.array([20.0, -15.0, 0.0]), np.array([50.0, 15.0, 25.0]))
PLATE = Turned(np.array([[20.0, -30.0], [100.0, -30.0], [100.0, -20.0], [20.0, -20.0]]))
KERNELS = Workshop("cpu")


def looked(solid, *tips, cutter=MILL, held=None, axis=(0.0, 0.0, 1.0), frame=STILL, copies=1):
    """What is found of one straight path of a tool, and how it was looked at."""
    motion = CLMotion(np.array(tips, dtype=float), np.tile(axis, (len(tips), 1)))
    whole = operation("milling", cutter, [motion], 1e-9, holder=held, lines=[np.arange(11, 11 + len(tips))])
    job = Job("x", Part("frame", None, {}), (Variant("program", "", (whole,)),), "program", ())
    asked = BodyInspection("program", (("fixture", solid),), frame, copies)
    reading = perform(asked.steps(job), KERNELS)
    assert reading.doubts == ()
    return reading.findings, reading.measurements[0].looks[0]


@pytest.mark.parametrize(("lift", "hits"), [(0.1, True), (0.0, False), (-0.01, False)])
@pytest.mark.parametrize("way", ["over it", "beside it"])
def test_a_fixture_in_the_way_by_a_tenth_is_hit_and_one_that_is_touched_or_cleared_is_not(lift, hits, way):
    """The mill slides over the clamp's top, or along its side."""
    solid = (
        Block(CLAMP.lower, CLAMP.upper + np.array([0.0, 0.0, lift]))
        if way == "over it"
        else Shifted(CLAMP, np.array([-lift, 0, 0]))
    )
    tips = ([40, -40, 25], [40, -12, 25]) if way == "over it" else ([15, -40, 5], [15, 3, 5])
    found, look = looked(solid, [40, -60, 90], *tips)
    assert [f.fails for f in found] == [True] * hits
    assert look.near > 0
    if hits:
        assert found[0].kind == "machine_hit"
        assert (
            found[0].text
            == "the cutter of milling hits the fixture in the move of line 13: it goes 0.1 mm deep into it"
        )
        assert found[0].place_mm[0] == pytest.approx(40.0 if way == "over it" else 20.0, abs=5.0)


@pytest.mark.parametrize(("longer", "hits"), [(1.0, True), (-0.01, False)])
def test_a_holder_a_millimetre_too_long_hits_the_clamp(longer, hits):
    """The mill runs 6 mm beside the clamp, 20 mm of it below the clamp's top."""
    held = standing_on(
        flat(10.0, 20.0 - longer), None, [("shank", [(10.0, 10.0, 5.0)]), ("holder", [(40.0, 40.0, 30.0)])]
    )
    found, _ = looked(CLAMP, [9, -60, 0.0], [9, 60, 0.0], cutter=flat(10.0, 20.0 - longer), held=held)
    assert len(found) == hits
    if hits:
        assert "the holder of milling hits the fixture in the move of line 12: it goes 1 mm deep" in found[0].text


def test_a_drill_s_point_and_a_tilted_nose_hit_a_round_table_and_its_bore_is_free():
    point = drill(6.0, np.radians(118.0), 40.0)
    (found,), _ = looked(PLATE, [60.123, 0.3, 0], [60.123, 0.3, -20.1], cutter=point)
    assert "it goes 0.1 mm deep" in found.text
    assert found.place_mm == pytest.approx((60.123, 0.3, -20.1), abs=1e-9)
    assert looked(PLATE, [0, 0, 0], [0, 0, -35.0], cutter=point)[0] == ()
    nose = standing_on(MILL, None, [("spindle nose", [(60.0, 80.0, 20.0)])])
    flat_on = (np.sin(1.3), 0.0, np.cos(1.3))
    (found,), _ = looked(PLATE, [30, 0, 5], [30, 0, -6], held=nose, axis=flat_on)
    assert "the spindle nose of milling hits the fixture" in found.text


def test_what_stays_away_is_clear_for_certain_and_takes_no_ray():
    found, look = looked(CLAMP, [-20, 0, 0], [-20, 0, 60], [70, 0, 60])
    assert (found, look.near, look.pitch) == ((), 0, 0.0)
    assert look.rows == 2


def test_a_mounted_and_an_indexed_fixture_are_where_they_are_turned_to():
    up = Rigid(np.diag([1.0, -1.0, -1.0]), np.zeros(3))
    low = [[35, -40, -31], [35, 40, -31]]
    assert looked(CLAMP, *low)[0] == ()
    assert len(looked(CLAMP, *low, frame=up)[0]) == 1
    aside = [[0, 25, 5], [0, 30, 5]]
    assert looked(CLAMP, *aside)[0] == ()
    (found,), _ = looked(CLAMP, *aside, copies=4)
    assert "space 4" in found.text


@pytest.mark.parametrize("solid", [CLAMP, PLATE, Turned(np.array([[0.0, 0.0], [9.0, 0.0], [4.0, 7.0], [0.0, 7.0]]))])
def test_lines_run_just_below_every_face(solid):
    rays, pitch = body_rays(solid, *solid.box)
    ends = [rays.origin + a[:, None] * rays.direction for a in (rays.start, rays.end)]
    off = solid.signed_distance(0.5 * (ends[0] + ends[1]))
    assert off.max() < 0.0
    near = 0.5 * (ends[0] + ends[1])[np.abs(off) < 0.02]
    faces = np.unique(np.round(solid.normals(near), 1)[:, 2])
    assert pitch < 1.3
    assert len(faces) >= 3


def test_a_held_tool_is_looked_at_as_a_whole():
    held = holder(30.0, [(30.0, 30.0, 20.0)])
    high = Block(np.array([12.0, -5.0, 35.0]), np.array([14.0, 5.0, 40.0]))
    (found,), _ = looked(high, [0, -60, 0], [0, 60, 0], held=held)
    assert "the holder of milling" in found.text
