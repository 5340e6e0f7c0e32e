"""Zhou's roughing strategies I and II: their poses (4.28 as corrected, 4.29), and where they begin to interfere."""

from dataclasses import replace
from math import cos, radians, sin

import numpy as np
import pytest

from gearsim.cutters.catalogue import bull, conical, flat
from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.series import Series
from gearsim.metrology.deviation import Crossing, measure
from gearsim.motion.sources import CLMotion
from gearsim.scene import load_scene
from gearsim.simulation.operation import operation
from gearsim.simulation.workshop import Workshop
from gearsim.surfaces.patch import SIDES
from gearsim.toolpaths.flank import FlankPath
from gearsim.toolpaths.interference import critical_depth, rough_paths
from gearsim.toolpaths.roughing import RoughPath, root_depth, rough_pose
from gearsim.toolpaths.slot_clearance import SlotClearance
from tests.conftest import make_tooth

STRATEGIES = ("I", "II")
MILL = bull(4.4, 1.5, 25.0)
"""A fillet end mill a little wider than the bottom land, as in Zhou's figure 4.12."""


TOOTH = make_tooth()


@pytest.fixture(scope="module")
def line():
    return FlankPath(TOOTH, "convex", MILL, 8.0).line


@pytest.fixture(scope="module")
def slot():
    return SlotClearance(TOOTH.patches)


def generated():
    """The face-milled tooth's lengthwise line and slot."""
    scene, _ = load_scene("spiral-bevel-flank-conventional")
    return scene.planners()["convex"].line, scene.tooth()


@pytest.fixture(scope="module", params=["ruled", "generated"])
def any_line(request, line):
    return line if request.param == "ruled" else generated()[0]


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_the_tip_stands_at_its_depth_under_the_pitch_cone(any_line, strategy):
    """|o_c - q_s| = H with q_s on the pitch cone; the axis in the axial plane, d off the pitch cone's normal."""
    blank, parameter = any_line.blank, np.linspace(*any_line.ends, 7)
    spine = any_line.frames(parameter, 0)
    depth = np.linspace(-1.0, 6.0, 7)
    tip, axis = (s.value for s in rough_pose(any_line, strategy, spine, Series(depth[None])))
    q = tip + depth[:, None] * axis
    cone, height = blank.cone_height(q)
    assert np.allclose(cone, spine.cone.value, atol=1e-12)
    assert np.allclose(height, 0.0, atol=1e-12)
    lean = blank.pitch - blank.root_angle if strategy == "I" else 0.0
    assert np.allclose(np.sum(axis * spine.z.value, axis=1), cos(lean))
    assert np.allclose(np.sum(axis * spine.x.value, axis=1), sin(lean))
    assert np.allclose(np.sum(axis * spine.y.value, axis=1), 0.0)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_passes_run_from_the_face_cone_to_the_root_cone(any_line, strategy):
    """Share 0 begins straight at the face cone's height over q_s, share 1 without lift ends on the root cone, to which
    strategy I's axis is normal; depths between lie on the way."""
    blank, parameter = any_line.blank, np.linspace(*any_line.ends, 7)
    spine = any_line.frames(parameter, 0)
    depths = [RoughPath(any_line, strategy, share, 0.0).depth(spine).value for share in (0.0, 0.25, 1.0)]
    assert np.allclose(depths[0], -np.asarray(blank.addendum_at(spine.cone.value)))
    assert np.allclose(depths[1], 0.75 * depths[0] + 0.25 * depths[2])
    pose = RoughPath(any_line, strategy, 1.0, 0.0).poses(parameter, 0)
    cone, height = blank.cone_height(pose.tip.value)
    assert np.allclose(height, -np.asarray(blank.dedendum_at(cone)), atol=1e-12)
    lifted = RoughPath(any_line, strategy, 1.0, 0.3).poses(parameter, 0)
    assert np.allclose(lifted.tip.value, pose.tip.value + 0.3 * pose.axis.value)
    if strategy == "I":
        generator, normal = blank.cone_directions(pose.tip.value)
        lean = blank.pitch - blank.root_angle
        along_root = cos(lean) * generator - sin(lean) * normal
        assert np.allclose(np.sum(along_root * pose.axis.value, axis=1), 0.0, atol=1e-12)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_the_poses_derivatives_come_right_at_their_order(any_line, strategy):
    path, parameter = RoughPath(any_line, strategy, 0.6, 0.2), np.linspace(*any_line.face, 5)
    pose, step = path.poses(parameter, 2), 1e-4 * (any_line.face[1] - any_line.face[0])
    low, high = (path.poses(parameter + s, 0) for s in (-step, step))
    for k in range(2):
        first, second = (pose[k].derivatives()[i] for i in (1, 2))
        assert np.allclose(
            (high[k].value - low[k].value) / (2.0 * step), first, rtol=1e-6, atol=1e-6 * abs(first).max()
        )
        bend = (high[k].value - 2.0 * pose[k].value + low[k].value) / step**2
        assert np.allclose(bend, second, rtol=1e-3, atol=1e-3 * abs(second).max())


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_both_walls_of_a_profile_are_equally_far(line, strategy):
    """The axis lies in the profile's plane of symmetry, though strategy I leaves the profile plane itself."""
    parameter = np.linspace(*line.face, 5)
    pose = RoughPath(line, strategy, 0.7, 0.0).poses(parameter, 0)
    height = np.linspace(TOOTH.fillet_height, 6.0, 5)
    walls = [TOOTH.flank(side).jet(parameter, height).r - pose.tip.value for side in SIDES]
    along = [np.sum(w * pose.axis.value, axis=1) for w in walls]
    aside = [np.linalg.norm(w - z[:, None] * pose.axis.value, axis=1) for w, z in zip(walls, along, strict=True)]
    one, other = (MILL.signed_distance(r, z) for r, z in zip(aside, along, strict=True))
    assert np.allclose(one, other, atol=1e-12)


def test_strategy_one_stands_beside_the_slots_middle(line):
    """Its tip is H sin d nearer to the toe than its profile, where the spiral has led the slot aside; strategy II's
    tip is on its profile."""
    parameter = np.array([float(line.parameter_at(np.array([line.blank.mean]))[0])])
    aside = {}
    for strategy in STRATEGIES:
        tip = RoughPath(line, strategy, 1.0, 0.0).poses(parameter, 0).tip.value
        cone = line.blank.cone_height(tip)[0]
        spine = line.frames(line.parameter_at(cone), 0)
        aside[strategy] = abs(float(np.sum((tip - spine.origin.value) * spine.y.value)))
    h = float(root_depth(line, "I", line.frames(parameter, 0)).value[0])
    lean = line.blank.pitch - line.blank.root_angle
    assert aside["II"] < 0.05
    assert aside["I"] - aside["II"] == pytest.approx(h * sin(lean) * np.tan(radians(32.0)), rel=0.1)


@pytest.mark.parametrize("strategy", STRATEGIES)
def test_interference_begins_at_the_critical_depth(line, slot, strategy):
    """Zhou's figure 4.12: the end mill's corner touches. Against all points of a dense net, at many depths."""
    parameter = line.parameter_at(np.array([74.0, 80.0]))
    found = critical_depth(line, slot, MILL, strategy, parameter)
    dense = _dense(TOOTH, 301, 41)
    spine = line.frames(parameter, 0)
    assert np.allclose(found.lift, root_depth(line, strategy, spine).value - found.depth)
    for change in (-1.0, 0.0, 0.3):
        tip, axis = (s.value for s in rough_pose(line, strategy, spine, Series((found.depth + change)[None])))
        least = [_least(MILL, dense, t, a) for t, a in zip(tip, axis, strict=True)]
        exact = slot.closest(MILL, tip, axis).distance
        assert np.all(exact <= np.array(least) + 1e-9)
        assert np.allclose(exact, least, atol=5e-3)
        assert (exact > -1e-8).all() if change <= 0.0 else (exact < 0.0).all()
    assert np.abs(found.met.distance).max() < 1e-8
    assert {TOOTH.patches[k].part for k in found.met.patch} <= {"fillet", "flank"}


def test_the_removal_road_cuts_the_tooth_from_the_critical_depth_on(line, slot, device):
    """Strategy II at one place: 1 um higher nothing is cut, 20 um lower as deep as the exact distance says."""
    parameter = line.parameter_at(np.array([78.0]))
    found = critical_depth(line, slot, MILL, "II", parameter)
    spine = line.frames(parameter, 0)
    patch = TOOTH.patches[found.met.patch[0]]
    length, height = (g.ravel() for g in np.meshgrid(np.linspace(0.7, 0.95, 101), np.linspace(0.0, 1.0, 61)))
    jet = patch.jet(*patch.locate(length, height))
    rays = RayBundle(jet.r, jet.normal, np.full(len(jet.r), -0.5), np.full(len(jet.r), 0.0))
    for change, wanted in ((-1e-3, None), (0.02, True)):
        tip, axis = (s.value[0] for s in rough_pose(line, "II", spine, Series((found.depth + change)[None])))
        moves = operation("plunge", MILL, [CLMotion(np.array([tip + axis, tip]), np.array([axis, axis]))], 1e-9)
        value = measure(rays, Workshop(device).cut([(rays, [moves])])[0])
        if wanted is None:
            assert not (value.crossing == Crossing.MEASURED).any()
        else:
            depth = slot.closest(MILL, tip[None], axis[None]).distance[0]
            assert np.nanmin(value.value) == pytest.approx(depth, rel=0.1)


def _dense(tooth, lengths, heights):
    at = [g.ravel() for g in np.meshgrid(np.linspace(0.0, 1.0, lengths), np.linspace(0.0, 1.0, heights))]
    return np.concatenate([p.jet(*p.locate(*at)).r for p in tooth.patches])


def _least(cutter, points, tip, axis):
    off = points - tip
    z = off @ axis
    return cutter.signed_distance(np.linalg.norm(off - z[:, None] * axis, axis=1), z).min()


def test_passes_keep_their_allowance_and_their_depth(line, slot):
    cutter = conical(0.5, 0.5, radians(18.0), 25.0)
    paths = rough_paths(line, slot, cutter, "II", 2.5, 0.25)
    assert [p.share for p in paths] == [0.25, 0.5, 0.75, 1.0]
    parameter = np.linspace(*line.face, 41)
    spine = line.frames(parameter, 0)
    depths = np.array([p.depth(spine).value for p in paths])
    steps = np.diff(depths, axis=0, prepend=-np.asarray(line.blank.addendum_at(spine.cone.value))[None])
    assert 1.8 < steps.max() <= 2.5
    pose = paths[-1].poses(parameter, 0)
    room = slot.closest(cutter, pose.tip.value, pose.axis.value).distance
    assert 0.25 - 1e-5 < room.min() < 0.251
    assert len(paths[0].cl_motion(9).tips) > 9


def test_a_generated_slot_is_roughed_by_the_same_rule():
    line, tooth = generated()
    slot, cutter = SlotClearance(tooth.patches), conical(0.5, 0.5, radians(15.0), 25.0)
    parameter = np.linspace(*line.face, 3)
    found = critical_depth(line, slot, cutter, "II", parameter, 0.2)
    assert np.allclose(found.met.distance, 0.2, atol=1e-8)
    assert (found.depth > 4.0).all()


def test_what_cannot_be_roughed_is_refused(line, slot):
    parameter = np.linspace(*line.face, 3)
    with pytest.raises(InputError, match="does not enter the slot: with its tip on the face cone at cone distance"):
        critical_depth(line, slot, flat(14.0, 25.0), "II", parameter)
    with pytest.raises(InputError, match=r"takes \d+ passes; expected 1 to 200"):
        rough_paths(line, slot, MILL, "II", 0.01, 0.2)


@pytest.mark.parametrize("side", SIDES)
def test_a_flank_pass_with_an_allowance_stands_that_much_off(side):
    """The same pass, shifted along the normal of the contact; 0 is the pass itself to the bit."""
    path = FlankPath(TOOTH, side, conical(0.7, 0.8, radians(15.0), 25.0), 8.0)
    phi = np.linspace(-0.1, 0.1, 5)
    plain, off = path.poses(phi, 2), replace(path, allowance=0.2).poses(phi, 2)
    assert np.array_equal(plain.tip.c, replace(path, allowance=0.0).poses(phi, 2).tip.c)
    assert np.allclose(off.axis.c, plain.axis.c)
    blank, spine = path.tooth.blank, path.tooth.spine(phi, 0)
    jet = path.tooth.flank(side).jet(phi, np.asarray(blank.mid_working_depth_at(spine.cone.value)))
    assert np.allclose(off.tip.value - plain.tip.value, 0.2 * jet.normal)
