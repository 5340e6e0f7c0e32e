import re
from dataclasses import replace
from math import cos, radians, sin

import numpy as np
import pytest
from scipy.optimize import fsolve

from gearsim.cutters.catalogue import conical
from gearsim.errors import InputError
from gearsim.surfaces.patch import SIDES
from gearsim.toolpaths.face_milled import GeneratedFlankPath
from tests.surfaces.test_face_milled import ANGLE, EDGE, ROLL, SETTINGS, make_face_milled

CONE = np.linspace(50.0, 88.0, 7)
START = EDGE * (1.0 - sin(ANGLE))


def make_path(side, cutter, generated=True, roll=()):
    tooth = make_face_milled(replace(SETTINGS, modified_roll=roll), generated)
    return GeneratedFlankPath(tooth.flank(side), cutter, START, 8.0)


@pytest.fixture(params=[(s, g) for s in SIDES for g in ("generated", "modified roll", "formate")], ids="-".join)
def path(request, published_cutter):
    side, kind = request.param
    return make_path(side, published_cutter, kind != "formate", ROLL if kind == "modified roll" else ())


def profile_frames(path):
    """Middle of the slot on the pitch cone at CONE, the generator through it, the pitch cone's normal there."""
    blank = path.patch.blank
    walls = [wall.jet(*wall.meet(CONE, 0.0 * CONE)).r for wall in map(path.patch.tooth.flank, SIDES)]
    middle = sum(r[:, :2] / np.linalg.norm(r[:, :2], axis=1)[:, None] for r in walls)
    middle /= np.linalg.norm(middle, axis=1)[:, None]
    generator = np.column_stack([middle * sin(blank.pitch), np.full(len(CONE), cos(blank.pitch))])
    up = np.column_stack([middle * cos(blank.pitch), np.full(len(CONE), -sin(blank.pitch))])
    return generator * CONE[:, None], generator, up


def touched(path):
    """The flank at mid working depth over the root, in the profile planes: MINPACK, which knows no series."""
    origin, generator, up = profile_frames(path)
    blank = path.patch.blank
    mid = 0.5 * (blank.whole_depth_at(CONE) + blank.clearance) - blank.dedendum_at(CONE)

    def misses(at):
        off = path.patch.jet(*at.reshape(2, -1)).r - origin
        return np.concatenate([dot(off, generator), dot(off, up) - mid])

    start = np.concatenate(path.patch.meet(CONE, mid))
    return path.patch.jet(*fsolve(misses, start, xtol=1e-13).reshape(2, -1))


def dot(a, b):
    return np.sum(a * b, axis=1)


def test_the_cutter_touches_the_tooth_at_mid_working_depth(path):
    """Point and normal coincide; the axis leans by the taper, in the profile plane of the lengthwise curve's point."""
    pose, (_, generator, up) = path.poses(CONE, 0), profile_frames(path)
    jet = touched(path)
    q = jet.r - pose.tip.value
    z = dot(q, pose.axis.value)
    w = q - z[:, None] * pose.axis.value
    r = np.linalg.norm(w, axis=1)
    distance, nr, nz = path.cutter.distance_gradient(r, z)
    assert np.allclose(distance, 0.0, atol=1e-10)
    assert np.allclose(nr[:, None] * w / r[:, None] + nz[:, None] * pose.axis.value, -jet.normal, atol=1e-10)
    assert np.allclose(dot(pose.axis.value, jet.normal), sin(radians(15.0)), atol=1e-10)
    rule = pose.axis.value - dot(pose.axis.value, jet.normal)[:, None] * jet.normal
    rule /= np.linalg.norm(rule, axis=1)[:, None]
    assert np.allclose(dot(rule, generator), 0.0, atol=1e-10)
    assert np.all(dot(rule, up) > 0.8)
    below = jet.r - rule * ((path.contact_height(CONE) - START) / dot(rule, up))[:, None]
    q = below - pose.tip.value
    assert np.allclose(dot(q, pose.axis.value), path.cutter.elements[path.cutter.flank].start[1], atol=1e-10)


def test_all_derivatives_are_those_of_the_path(path):
    """The Taylor series of order 6 reaches the poses 0.2 mm of cone distance on."""
    here, there = path.poses(CONE, 6), path.poses(CONE + 0.2, 0)
    for a, b in zip(here, there, strict=True):
        assert np.allclose(np.einsum("k,kij->ij", 0.2 ** np.arange(7), a.c), b.value, atol=1e-10)


def test_cl_points_lie_on_the_path_with_equal_steps(published_cutter):
    path = make_path("convex", published_cutter)
    blank, cl = path.patch.blank, path.cl_motion(17)
    on_face = path.poses(np.linspace(blank.toe, blank.cone_distance, 17), 0)
    first = int(np.argmin(np.linalg.norm(cl.tips - on_face.tip.value[0], axis=1)))
    assert first >= 4
    assert len(cl.tips) >= first + 21
    assert np.allclose(cl.tips[first : first + 17], on_face.tip.value, atol=1e-12)
    with pytest.raises(InputError, match="at least 2 points over the face, got 1"):
        path.cl_motion(1)


def test_a_cutter_wider_than_the_mouth_is_refused(path):
    """The mouth the message names is the distance of the toe's tip edge from the other one, across the slot."""
    path.check_passage()
    wide = replace(path, cutter=conical(2.5, 1.5, radians(15.0), 25.0))
    with pytest.raises(InputError, match=r"between the tip edges: at cone distance 55\.17 mm it is \d+") as error:
        wide.check_passage()
    mouth = float(re.search(r"mouth of ([\d.]+) mm", str(error.value))[1])
    length = np.linspace(0.0, 0.4, 801)
    walls = [path.patch.tooth.flank(side) for side in SIDES]
    convex, concave = (w.jet(*w.locate(length, np.ones(801))).r for w in walls)
    across = min(np.linalg.norm(a[0] - b, axis=1).min() for a, b in ((convex, concave), (concave, convex)))
    assert mouth == pytest.approx(across, rel=0.05)


def test_the_path_ends_where_the_prolonged_flank_does(published_cutter):
    """Beyond there are no poses; a run-in that would need them is refused, one that does not is unharmed."""
    path = make_path("convex", published_cutter)
    pose = path.poses(np.array([-5.0, 60.0]), 1)
    assert np.isnan(pose.tip.c[:, 0]).all()
    assert np.allclose(pose.tip.c[:, 1], path.poses(np.array([60.0]), 1).tip.c[:, 0], atol=1e-12)
    with pytest.raises(InputError, match="the generated convex does not reach cone distance"):
        _ = replace(path, run=60.0).motion
