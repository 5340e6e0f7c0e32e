"""Face-milled teeth from Zerol to 50 degrees, sharp blades, pinions, both hands, other shafts: by brute force."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.motion.sources import CurveMotion
from gearsim.surfaces.patch import SIDES
from gearsim.verify.brute_force import least_distance
from tests.surfaces.bevel_gears import gear
from tests.surfaces.test_face_milled import trace_angle

ANGLES = (0, 5, 10, 15, 20, 25, 27, 30, 45, 50)


def spread(patch, rng, n):
    u, v = patch.locate(
        np.append(rng.uniform(0.0, 1.0, n), [0.0, 1.0]), np.append(rng.uniform(0.0, 1.0, n), [0.0, 1.0])
    )
    return u, v, patch.jet(u, v)


def by_brute_force(tooth, rng, n=6):
    """Largest distance [mm] that the head keeps from, or cuts into, points of every patch over its whole roll."""
    motion, worst = CurveMotion(tooth.poses, *tooth.motion_range), {}
    for patch in tooth.patches:
        jet = spread(patch, rng, n)[2]
        assert jet.exists.all()
        assert not jet.undercut.any()
        worst[patch.name] = np.abs(least_distance(motion, tooth.head, jet.r, 1e-13).distance).max()
    return worst


@pytest.mark.parametrize("spiral", [0, 15, 27, 50])
def test_no_pose_cuts_deeper_than_the_closed_form_says(spiral, rng):
    tooth = gear(spiral) if spiral < 45 else gear(spiral, edge=0.4, width=0.6)
    tooth.check()
    assert max(by_brute_force(tooth, rng).values()) < 1e-12


@pytest.mark.parametrize("spiral", ANGLES)
def test_the_spiral_angle_is_the_one_asked_for_and_the_hands_are_mirror_images(spiral, rng):
    left, right = gear(spiral), gear(spiral, "right")
    angles = [trace_angle(left.flank(side), left.blank.mean) for side in SIDES]
    assert -np.mean(angles) == pytest.approx(spiral, abs=0.5)
    for a, b in zip(left.patches, right.patches, strict=True):
        at = rng.uniform(0.0, 1.0, (2, 5))
        one, other = (p.jet(*p.locate(*at)) for p in (a, b))
        assert np.allclose(one.r * [1.0, -1.0, 1.0], other.r, rtol=0.0, atol=1e-12)
        assert np.allclose(one.normal * [1.0, -1.0, 1.0], other.normal, rtol=0.0, atol=1e-12)
    assert np.allclose(left.motion_range, -np.array(right.motion_range)[::-1], rtol=0.0, atol=1e-12)


def test_at_a_spiral_angle_of_zero_one_cradle_angle_cuts_towards_toe_and_heel_at_once():
    """Along the bottom land the cradle angle turns back in the middle of the face, where the circle runs along it."""
    bottom = gear(0).bottom
    phi = bottom.pose_parameter(*bottom.locate(np.linspace(0.0, 1.0, 41), np.full(41, 0.5)))
    turns = np.flatnonzero(np.diff(np.sign(np.diff(phi))))
    assert len(turns) == 1
    assert 15 < turns[0] < 25


@pytest.mark.parametrize(
    ("spiral", "teeth", "mate", "shaft"),
    [(0, 9, 33, 90.0), (35, 9, 33, 90.0), (35, 11, 41, 60.0), (20, 15, 45, 75.0), (35, 20, 20, 110.0)],
)
def test_pinions_and_other_shaft_angles(spiral, teeth, mate, shaft, rng):
    tooth = gear(spiral, teeth=teeth, mate=mate, shaft_deg=shaft, edge=0.6, width=1.3)
    tooth.check()
    assert max(by_brute_force(tooth, rng, 3).values()) < 1e-12


def test_sharp_blades_leave_the_swept_edge_as_their_fillet(rng):
    """At most 1e-11 mm: the head's own distance is known to 1e-12 mm about a corner."""
    tooth = gear(10, edge=0.0)
    worst = by_brute_force(tooth, rng)
    assert list(worst) == ["concave", "concave fillet", "bottom", "convex fillet", "convex"]
    assert max(worst.values()) < 1e-11
    for side in SIDES:
        flank, fillet, bottom = tooth.flank(side), tooth.fillet(side), tooth.bottom
        u = bottom.locate(np.linspace(0.0, 1.0, 3), np.full(3, 0.5))[0]
        wall = bottom.ends[0 if side == "concave" else 1]
        for a, va, b, vb in ((flank, flank.ends[0], fillet, fillet.ends[1]), (fillet, fillet.ends[0], bottom, wall)):
            assert np.allclose(a.jet(u, va).r, b.jet(u, vb).r, rtol=0.0, atol=1e-11)
            assert np.allclose(a.jet(u, va).normal, b.jet(u, vb).normal, rtol=0.0, atol=1e-12)


def test_a_vanishing_edge_radius_is_a_sharp_blade():
    """Fillets of small edge radii come as near to the sharp edge's as the radius."""
    middle = np.full(3, 0.5), np.array([0.0, 0.5, 1.0])
    sharp = gear(20, edge=0.0).fillet("convex")
    exact, off = sharp.jet(*sharp.locate(*middle)).r, []
    for edge in (1e-2, 1e-3):
        patch = gear(20, edge=edge).fillet("convex")
        off.append(np.linalg.norm(patch.jet(*patch.locate(*middle)).r - exact, axis=1).max() / edge)
    assert max(off) < 3.0


def test_a_sharp_head_at_rest_leaves_no_fillet():
    still = replace(gear(0, edge=0.0), generated=False)
    assert [p.name for p in still.patches] == ["concave", "bottom", "convex"]
    with pytest.raises(InputError, match="a sharp head at rest leaves no fillet"):
        still.fillet("convex").locate([0.5], [0.5])


def test_slots_that_leave_no_tooth_are_refused_with_the_number():
    with pytest.raises(
        InputError, match=r"slots overlap at the tooth's tip: .* mm of tooth; wanted is a slot narrower by more than"
    ):
        gear(30, width=8.0).check()
    gear(30, width=3.0).check()


@pytest.mark.parametrize(
    ("base", "message"),
    [
        (-12.0, r"cuts the blank through: at cone distance \d+\.\d+ mm its bottom is 1\d\.\d+ mm .* the rim is 8 mm"),
        (11.0, r"bottom lies outside the blank: at cone distance .* mm it is \d\.\d+ mm over the face cone"),
    ],
)
def test_slots_beside_the_blank_are_refused(base, message):
    tooth = gear(30, blade=30.0)
    moved = replace(tooth, generator=replace(tooth.generator, sliding_base=base))
    with pytest.raises(InputError, match=message):
        moved.check()
