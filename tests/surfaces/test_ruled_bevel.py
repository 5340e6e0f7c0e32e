from math import atan2, cos, degrees, pi, radians, sin, tan

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.surfaces.ruled_bevel import STRAIGHT
from tests.conftest import make_tooth
from tests.helpers import observed_order


def build_point(phi, y, z, hand=1.0):
    """A point of the slot straight from Zhou's construction, step by step, with no series and no jets."""
    module, pitch = 4.8338, atan2(33.0, 9.0)
    outer = module * 33 / (2 * sin(pitch))
    mean, radius = outer - 13.75, 63.5
    turn = hand * radians(58.0)
    crown = np.array([mean, 0.0]) - radius * np.array([cos(turn), sin(turn)])
    crown = crown + radius * np.array([cos(turn + phi), sin(turn + phi)])
    cone = np.hypot(*crown)
    theta = atan2(crown[1], crown[0]) / sin(pitch)
    generator = np.array([sin(pitch) * cos(theta), sin(pitch) * sin(theta), cos(pitch)])
    normal = np.array([cos(pitch) * cos(theta), cos(pitch) * sin(theta), -sin(pitch)])
    depth = 7.67 - (outer - cone) * tan(pitch - radians(69.5833))
    return cone * generator + (z - depth) * normal + y * np.cross(normal, generator)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_points_follow_the_construction(hand, rng):
    tooth = make_tooth(hand)
    sign = 1.0 if hand == "left" else -1.0
    for patch in tooth.patches:
        for phi in rng.uniform(-0.25, 0.24, 5):
            v = patch.start + 0.4
            side = tooth.side_sign(patch.side)
            y, z = {
                "flank": (side * (1.0 + 1.5 * cos(radians(22)) + (v - patch.start) * tan(radians(22))), v),
                "fillet": (side * (1.0 + 1.5 * sin(v)), 1.5 * (1.0 - cos(v))),
                "bottom": (side * v, 0.0),
            }[patch.part]
            assert np.allclose(patch.jet(phi, v).r, build_point(phi, y, z, sign), atol=1e-11)


def test_derivatives_converge_with_second_order(tooth):
    steps = np.array([4e-3, 2e-3, 1e-3])
    for patch in tooth.patches:
        u, v = 0.07, patch.start + 0.4
        exact = patch.jet(u, v)
        errors = {k: [] for k in ("ru", "rv", "ruu", "ruv", "rvv")}
        for h in steps:
            at = lambda a, b, h=h, p=patch: p.jet(u + a * h, v + b * h).r
            difference = {
                "ru": (at(1, 0) - at(-1, 0)) / (2 * h),
                "rv": (at(0, 1) - at(0, -1)) / (2 * h),
                "ruu": (at(1, 0) - 2 * at(0, 0) + at(-1, 0)) / h**2,
                "rvv": (at(0, 1) - 2 * at(0, 0) + at(0, -1)) / h**2,
                "ruv": (at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / (4 * h**2),
            }
            for k, d in difference.items():
                errors[k].append(np.linalg.norm(d - getattr(exact, k)))
        for k, e in errors.items():
            if max(e) > 1e-7:
                assert observed_order(e, steps) == pytest.approx(2.0, abs=0.1), (patch.name, k)


def test_normals_point_out_of_the_material_into_the_slot(tooth):
    """Towards the slot's middle on the walls, up on the root."""
    for patch in tooth.patches:
        phi, v = patch.locate(np.linspace(0, 1, 5), np.full(5, 0.5))
        jet, spine = patch.jet(phi, v), tooth.spine(phi, 0)
        up = np.sum(jet.normal * spine.z.value, axis=1)
        across = np.sum(jet.normal * spine.y.value, axis=1) * tooth.side_sign(patch.side)
        assert np.all(up > 0.2)
        assert patch.part == "bottom" or np.all(across < -0.2)


def test_convex_flank_is_convex_and_concave_concave_along_the_face(tooth):
    """Lengthwise normal curvature, about 1/63.5, negative where the surface bulges out of the material."""
    for side, sign in (("convex", -1.0), ("concave", 1.0)):
        jet = tooth.flank(side).jet(np.zeros(1), np.full(1, 4.0))
        kappa = np.sum(jet.normal * jet.ruu) / np.sum(jet.ru * jet.ru)
        assert sign * kappa == pytest.approx(1.0 / 63.5, rel=0.3)


def test_the_working_flank_is_ruled_but_not_developable(tooth):
    """r_vv = 0, and the normal turns along a rule (Zhou section 3.3.2)."""
    for side in ("convex", "concave"):
        patch = tooth.flank(side)
        jet = patch.jet(np.full(2, 0.1), np.array([1.0, 7.0]))
        assert np.allclose(jet.rvv, 0.0)
        assert np.linalg.norm(jet.normal[0] - jet.normal[1]) > 1e-3
        assert np.all(jet.curvature().gaussian < 0.0)


def test_patches_join_with_common_tangent_planes(tooth):
    ends = {
        "convex": (tooth.fillet("convex"), pi / 2 - radians(22), tooth.flank("convex"), tooth.fillet_height),
        "bottom": (tooth.fillet("convex"), 0.0, tooth.bottom, 1.0),
    }
    for a, va, b, vb in ends.values():
        phi = np.array([-0.1, 0.1])
        first, second = a.jet(phi, np.full(2, va)), b.jet(phi, np.full(2, vb))
        assert np.allclose(first.r, second.r, atol=1e-12)
        assert np.allclose(first.normal, second.normal, atol=1e-12)


def test_mirror_swaps_the_hand_and_nothing_else():
    """x, y, z -> x, -y, z with phi -> -phi maps a left-hand slot on the right-hand one, side by side."""
    left, right = make_tooth("left"), make_tooth("right")
    flip = np.array([1.0, -1.0, 1.0])
    for a, b in zip(left.patches, right.patches, strict=True):
        phi, v = np.array([-0.2, 0.05, 0.2]), np.full(3, a.start + 0.3)
        one, other = a.jet(phi, v), b.jet(-phi, v)
        assert np.allclose(one.r * flip, other.r, atol=1e-12)
        assert np.allclose(one.normal * flip, other.normal, atol=1e-12)
        assert np.allclose(one.curvature().k1, other.curvature().k1)


def test_the_gear_of_this_pinion_hand_is_left_handed(tooth):
    """Seen from the apex, the outer half of the tooth leans counter-clockwise (ISO 23509)."""
    inner, outer = (tooth.spine(tooth.phi_at(np.array([c])), 0).origin.value[0] for c in (60.0, 78.0))
    turn = atan2(outer[1], outer[0]) - atan2(inner[1], inner[0])
    assert turn < 0.0  # looking along +z with x up, +y is to the right: outward goes to the left
    spine = tooth.spine(np.zeros(1), 1)
    on_the_pitch_cone = (spine.x * spine.cone.column).derivative().value[0]
    lean = degrees(np.arccos(abs(on_the_pitch_cone @ spine.x.value[0]) / np.linalg.norm(on_the_pitch_cone)))
    assert lean == pytest.approx(32.0, abs=1e-9)


def test_locate_meets_the_blank(tooth):
    blank = tooth.blank
    for patch in tooth.patches:
        length, height = (g.ravel() for g in np.meshgrid([0.0, 0.3, 1.0], [0.0, 0.6, 1.0]))
        phi, v = patch.locate(length, height)
        cone, above = blank.cone_height(patch.jet(phi, v).r)
        assert np.allclose(cone, blank.toe + length * blank.face_width, atol=1e-11)
        if patch.part == "flank":
            tip = height == 1.0
            assert np.allclose(above[tip], blank.addendum_at(cone[tip]), atol=1e-11)


def test_a_circle_that_cannot_reach_the_face_is_refused():
    with pytest.raises(InputError, match="lengthwise circle of radius 8 mm stays between"):
        make_tooth(lengthwise_radius=8.0).phi_at(82.0)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"pressure_angle": 0.0}, "pressure angle"),
        ({"fillet_radius": -1.0}, "must not be negative"),
        ({"fillet_radius": 20.0}, "working flank would be empty"),
    ],
)
def test_impossible_teeth_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        make_tooth(**changes)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_a_straight_bevel_has_flanks_in_planes_through_the_apex(hand):
    """Spiral angle 0, a straight lengthwise line, a slot in proportion to the cone distance."""
    tooth = make_tooth(hand, spiral_angle=0.0, lengthwise_radius=STRAIGHT, tapered=True)
    tooth.check()
    length, height = (g.ravel() for g in np.meshgrid(np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 4)))
    for side in ("convex", "concave"):
        jet = tooth.flank(side).jet(*tooth.flank(side).locate(length, height))
        assert np.abs(np.sum(jet.r * jet.normal, axis=1)).max() < 1e-12
        assert np.allclose(jet.normal, jet.normal[0], rtol=0.0, atol=1e-13)
    cone = np.array([tooth.blank.toe, tooth.blank.cone_distance])
    spine = tooth.spine(tooth.phi_at(cone), 0)
    width = tooth.half_width(tooth.blank.dedendum_at(cone)) + tooth.shift(spine).value
    assert width[0] / width[1] == pytest.approx(cone[0] / cone[1], rel=1e-12)


@pytest.mark.parametrize("spiral", [0.0, 25.0])
def test_a_straight_line_is_the_limit_of_large_circles(spiral):
    """Differences fall as one over the radius."""
    straight, off = make_tooth(spiral_angle=radians(spiral), lengthwise_radius=STRAIGHT).flank("convex"), []
    at = np.array([0.0, 0.4, 1.0]), np.array([0.1, 0.5, 0.9])
    for radius in (1e5, 1e6):
        near = make_tooth(spiral_angle=radians(spiral), lengthwise_radius=radius).flank("convex")
        off.append(np.abs(near.jet(*near.locate(*at)).r - straight.jet(*straight.locate(*at)).r).max())
    assert off[0] < 1e-2
    assert off[0] / off[1] == pytest.approx(10.0, rel=0.05)


def test_straight_lines_and_tapers_that_cannot_be_are_refused():
    with pytest.raises(InputError, match=r"line stays beyond cone distance 59\.69 mm; 55\.17 mm is"):
        make_tooth(spiral_angle=radians(60.0), lengthwise_radius=STRAIGHT).phi_at(np.array([55.17]))
    with pytest.raises(InputError, match=r"bottom half width 0\.1 mm at the mean .* must be at least 0\.\d+"):
        make_tooth(bottom_half_width=0.1, tapered=True, spiral_angle=0.0, lengthwise_radius=STRAIGHT)
    with pytest.raises(InputError, match="lengthwise radius -1 mm must be positive"):
        make_tooth(lengthwise_radius=-1.0)
