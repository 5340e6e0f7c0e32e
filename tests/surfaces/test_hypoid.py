"""The hypoid pinion: an assumed but realistic one, its slot, and brute force that knows no envelope."""

from dataclasses import replace
from math import cos, degrees, radians, sin, tan

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.generator import CradleGenerator
from gearsim.metrology.samples import sample_grid
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from tests.cutters.shapes import ring
from tests.helpers import observed_order

# How these were chosen: a pair of 11 and 41 teeth, shafts at 90 deg, offset 25 mm, gear mean radius 85 mm,
# pinion spiral angle 45 deg at the pitch point. Zero velocity along the common normal there gives the pinion's
# pitch angle 17.33 deg, mean radius 28.25 mm and an offset angle of 16.15 deg. The cradle's axis crosses that
# normal like the axis of an imaginary gear of 70 deg pitch angle and 86 mm radius (so tilt and machine root
# angle are not zero), the head's axis is normal to the pinion's root plane, its circle of 114.3 mm tangent to
# the tooth in the slot's middle. Rounded to 0.01 mm and 0.01 deg. Blade angles 14 and 26 deg: the limit
# pressure angle is about -6 deg.
SETTINGS = {
    "radial": 105.81, "cradle": radians(86.51), "machine_root_angle": radians(-1.93), "ratio": 3.7712,
    "tilt": radians(18.56), "swivel": radians(-20.21), "sliding_base": 11.90, "offset": 25.54,
    "centre_to_back": -6.61, "head_radius": 114.3, "point_width": 2.3, "outer_angle": radians(14.0),
    "inner_angle": radians(26.0), "edge_radius": 0.8, "blade_height": 14.0,
}  # fmt: skip
MODIFIED_ROLL = (0.02, -0.03)


def make_blank():
    """Mean addendum 5.8 and dedendum 2.3 mm, face and root cone 3 and 1.5 deg off the pitch cone."""
    pitch, face, root = radians(17.33), radians(3.0), radians(1.5)
    return BevelBlank(
        11, pitch, 109.82, 30.0, 5.8 + 15.0 * tan(face), 2.3 + 15.0 * tan(root), pitch + face, pitch - root, 0.9, 8.0
    )


def make_generator(modified_roll=(), **changes):
    s = {**SETTINGS, **changes}
    return CradleGenerator(
        s["radial"], -s["cradle"], s["machine_root_angle"], s["ratio"], s["tilt"], s["swivel"], s["sliding_base"],
        s["offset"], s["centre_to_back"], modified_roll,
    )  # fmt: skip


def make_head(**changes):
    s = {**SETTINGS, **changes}
    inner, outer = (degrees(s[k]) for k in ("inner_angle", "outer_angle"))
    return ring(s["head_radius"], s["point_width"], s["edge_radius"], s["blade_height"], inner, outer)


def make_cut(modified_roll=(), **changes):
    return FaceMilledTooth(make_blank(), make_head(**changes), make_generator(modified_roll, **changes))


def make_pinion(modified_roll=(), **changes):
    cut = make_cut(modified_roll, **changes)
    return HypoidPinion(cut, cut)


def head_distance(r, z, **changes):
    """Signed distance to the head's section near its blades: a core of half planes, grown by the edge radius."""
    s = {**SETTINGS, **changes}
    e, middle, half = s["edge_radius"], s["head_radius"], 0.5 * s["point_width"]
    planes, corners = [e - z], []
    for sign, angle in ((1.0, s["outer_angle"]), (-1.0, s["inner_angle"])):
        planes.append((sign * (r - middle) - half) * cos(angle) - z * sin(angle) + e)
        edge = middle + sign * (half - e * (1.0 - sin(angle)) / cos(angle))
        outside, beyond = sign * (r - edge), z - e
        in_sector = (outside > 0.0) & (outside * sin(angle) + beyond * cos(angle) < 0.0)
        corners.append(np.where(in_sector, np.hypot(outside, beyond), -np.inf))
    return np.max(planes + corners, axis=0) - e


def least_distance(poses, span, points, **changes):
    """Least distance [mm] of points (n, 3) over a whole motion, and the parameter where, by repeated scans.

    ``poses``: parameters (m,) to tips and axes (m, 3).
    """

    def distance(points, phi):
        tip, axis = (a.reshape(*phi.shape, 3) for a in poses(phi.ravel()))
        d = points[:, None] - tip
        z = (d * axis).sum(-1)
        return head_distance(np.linalg.norm(d - z[..., None] * axis, axis=-1), z, **changes)

    phi = np.linspace(*span, 800)[None]
    step, row = phi[0, 1] - phi[0, 0], np.arange(len(points))
    best = phi[0, distance(points, phi).argmin(1)]
    for _ in range(6):
        scan = best[:, None] + step * np.linspace(-1.0, 1.0, 21)
        scan = np.clip(scan, *span)
        d = distance(points, scan)
        best, step = scan[row, d.argmin(1)], 0.1 * step
    return d.min(1), best


def rolled(cut):
    """Exact poses of a cut as values."""
    return lambda phi: [s.value for s in cut.poses(phi, 0)]


@pytest.fixture(scope="module", params=[(), MODIFIED_ROLL], ids=["plain roll", "modified roll"])
def pinion(request):
    return make_pinion(request.param)


@pytest.fixture(params=["concave", "convex"])
def side(request):
    return request.param


@pytest.mark.parametrize("part", ["flank", "fillet"])
def test_no_pose_cuts_deeper_than_the_closed_form_says(pinion, side, part):
    """Brute force over the roll: the least distance is zero, and it is reached at the claimed pose."""
    patch = getattr(pinion, part)(side)
    u, v = (a.ravel() for a in patch.locate(*np.meshgrid(np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 5))))
    jet, cut = patch.jet(u, v), pinion.cut(side)
    least, where = least_distance(rolled(cut), cut.motion_range, jet.r)
    assert np.abs(least).max() < 1e-9
    assert np.abs(where - patch.pose_parameter(u, v)).max() < 1e-4
    off = 1e-3 * jet.normal
    outside, inside = (least_distance(rolled(cut), cut.motion_range, jet.r + k * off)[0] for k in (1.0, -1.0))
    assert np.allclose(outside, -1e-3, atol=1e-5)
    assert np.allclose(inside, 1e-3, atol=1e-5)


def test_normals_are_those_of_the_points(pinion, side):
    """Second differences of points, order two, no formula of the envelope."""
    patch = pinion.flank(side)
    u, v = patch.locate(np.array([0.2, 0.5, 0.9]), np.array([0.1, 0.5, 0.95]))
    normal, errors, steps = patch.jet(u, v).normal, [], np.array([4e-3, 2e-3, 1e-3])
    for h in steps:
        ru = patch.jet(u + 0.01 * h, v).r - patch.jet(u - 0.01 * h, v).r
        rv = patch.jet(u, v + h).r - patch.jet(u, v - h).r
        n = np.cross(ru, rv)
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        errors.append(np.linalg.norm(np.cross(n, normal), axis=1).max())
    assert errors[-1] < 1e-6
    assert observed_order(errors, steps) > 1.8 or errors[0] < 1e-9


def test_the_slot_is_a_hypoid_pinion_s():
    """Left hand, about 47 deg of spiral at the middle, full depth, top land left, nothing undercut."""
    pinion = make_pinion()
    blank = pinion.blank
    assert pinion.concave.hand == "left"
    grids = {side: sample_grid(pinion.flank(side), 5, 7) for side in ("concave", "convex")}
    for side, grid in grids.items():
        jet = pinion.flank(side).jet(grid.u.ravel(), grid.v.ravel())
        assert jet.exists.all()
        assert not jet.undercut.any()
        at = grid.point[2, 3]
        around = np.array([at[0], at[1], 0.0]) / np.hypot(at[0], at[1])
        generator = sin(blank.pitch) * around + cos(blank.pitch) * np.array([0.0, 0.0, 1.0])
        normal = grid.normal[2, 3]
        spiral = np.arctan2(abs(normal @ generator), abs(normal @ np.cross([0.0, 0.0, 1.0], around)))
        assert 45.0 < np.degrees(spiral) < 49.0, side
    u, v = pinion.concave.bottom.locate(np.linspace(0.0, 1.0, 9), np.full(9, 0.5))
    cone, height = blank.cone_height(pinion.concave.bottom.jet(u, v).r)
    assert np.abs(height + blank.dedendum_at(cone)).max() < 0.2
    top = [2.0 * grids[s].inward[-1] for s in grids]
    assert min(t.min() for t in top) > 1.2


def test_two_cuts_make_a_slot_of_another_width():
    """Turning the convex flank's cut by the cradle angle widens the slot by the turned arc (stock division)."""
    turn = radians(0.3)
    one, wider = make_cut(), make_cut(cradle=SETTINGS["cradle"] + turn)
    both, apart = HypoidPinion(one, one), HypoidPinion(one, wider)
    middle = np.full(1, 0.5)
    for side, moved in (("concave", 0.0), ("convex", -SETTINGS["ratio"] * turn)):
        at = [p.flank(side).jet(*p.flank(side).locate(middle, middle)).r[0] for p in (both, apart)]
        angle = np.arctan2(at[1][1], at[1][0]) - np.arctan2(at[0][1], at[0][0])
        assert np.isclose(np.arctan2(sin(angle), cos(angle)), moved, atol=1e-9)
    assert [p.name for p in apart.patches] == ["concave", "concave fillet", "convex fillet", "convex"]


def test_a_blade_angle_near_the_limit_undercuts_and_says_so():
    """Inside blades of 16 instead of 26 deg: near the toe other poses cut the convex flank's root away."""
    angle = {"inner_angle": radians(16.0)}
    cut = make_cut(**angle)
    patch = HypoidPinion(cut, cut).flank("convex")
    jet = patch.jet(*patch.locate(np.linspace(0.0, 1.0, 41), np.zeros(41)))
    least, _ = least_distance(rolled(cut), (-0.7, 0.7), jet.r, **angle)
    assert np.array_equal(jet.undercut, least < -1e-9)
    assert 5 < jet.undercut.sum() < 20
    assert least.min() < -0.04


def test_a_flank_that_the_motion_never_makes_is_refused():
    cut = make_cut(sliding_base=60.0)
    with pytest.raises(InputError, match="never cuts"):
        HypoidPinion(cut, cut).flank("concave").locate(np.full(1, 0.5), np.full(1, 0.5))


def test_cuts_that_do_not_belong_together_are_refused():
    cut = make_cut()
    with pytest.raises(InputError, match="different blanks"):
        HypoidPinion(cut, replace(cut, blank=replace(cut.blank, rim=5.0)))
    with pytest.raises(InputError, match="generated = True"):
        HypoidPinion(cut, replace(cut, generated=False))
    with pytest.raises(InputError, match="-hand"):
        HypoidPinion(cut, replace(cut, generator=cut.generator.other_hand()))
