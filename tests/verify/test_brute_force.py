from itertools import pairwise

import numpy as np
import pytest

from gearsim.cutters.profile import Element, Profile
from gearsim.motion.sources import CLMotion
from gearsim.verify.brute_force import distance_at, gradient_at, least_distance, settled_pose
from tests.verify.forms import BALL, ball


def unit(rows):
    return rows / np.linalg.norm(rows, axis=-1, keepdims=True)


def random_motion(rng, pieces=3, size=6.0):
    axes = unit(np.array([0.0, 0.0, 1.0]) + 0.3 * rng.normal(size=(pieces + 1, 3)))
    return CLMotion(size * rng.normal(size=(pieces + 1, 3)), axes)


def ring():
    """A head of 60 mm mean radius, 2 mm point width, blades at 20 deg, sharp edges."""
    slope = 15.0 * np.tan(np.radians(20.0))
    corners = [(59.0, 0.0), (61.0, 0.0), (61.0 + slope, 15.0), (59.0 - slope, 15.0), (59.0, 0.0)]
    return Profile("head", tuple(Element(a, b) for a, b in pairwise(corners)))


def fine(motion, distance, points, samples=4001):
    """Least distance by sampling every piece finely, and the error sampling can have made."""
    t = np.linspace(0.0, 1.0, samples)
    least, steepest = np.full(len(points), np.inf), 0.0
    for piece in range(motion.pieces):
        pose = motion.pose(np.full(samples, piece), t, 0)
        q = points[:, None] - pose.tip.value
        z = np.sum(q * pose.axis.value, axis=-1)
        r = np.linalg.norm(q - z[..., None] * pose.axis.value, axis=-1)
        f = distance(r, z)
        steepest = max(steepest, np.abs(np.diff(f, axis=1)).max())
        least = np.minimum(least, f.min(axis=1))
    return least, steepest


def test_a_ball_on_a_straight_line_is_a_capsule(rng):
    motion = CLMotion(np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    points = rng.uniform([-8.0, -8.0, -6.0], [18.0, 8.0, BALL], size=(200, 3))  # below the shank
    centre = np.column_stack([np.clip(points[:, 0], 0.0, 10.0), np.zeros(200), np.full(200, BALL)])
    found = least_distance(motion, ball(), points)
    expected = np.linalg.norm(points - centre, axis=1) - BALL
    assert np.all(found.distance >= expected - 1e-13)
    assert np.all(found.bound <= expected)
    assert np.all(found.distance - found.bound <= np.maximum(1.001e-10, 1.001e-6 * np.abs(found.distance)))


@pytest.mark.parametrize("seed", range(4))
def test_no_pose_of_a_fine_sampling_comes_closer(seed):
    rng = np.random.default_rng(seed)
    motion, cutter = random_motion(rng), ball(height=60.0)
    points = motion.tips[rng.integers(0, 4, 40)] + 6.0 * rng.normal(size=(40, 3))
    found = least_distance(motion, cutter, points)
    sampled, steepest = fine(motion, lambda r, z: np.hypot(r, np.maximum(BALL - z, 0.0)) - BALL, points)
    assert np.all(found.bound <= sampled)
    assert np.all(found.distance <= sampled + 1e-10 + 1e-6 * np.abs(sampled))
    assert np.all(found.distance >= sampled - steepest)
    at = distance_at(motion, cutter, points, found.piece, found.t)
    assert np.array_equal(at, found.distance)


@pytest.mark.parametrize("seed", range(3))
def test_a_ring_is_searched_inside_and_outside(seed):
    rng = np.random.default_rng(seed)
    motion, cutter = random_motion(rng, pieces=2, size=25.0), ring()
    angle, radius = rng.uniform(0.0, 2.0 * np.pi, 60), rng.uniform(0.0, 90.0, 60)
    points = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(-20.0, 30.0, 60)])
    found = least_distance(motion, cutter, points)
    sampled, steepest = fine(motion, cutter.signed_distance, points)
    assert np.all(found.bound <= sampled)
    assert np.all(found.distance <= sampled + 1e-10 + 1e-6 * np.abs(sampled))
    assert np.all(found.distance >= sampled - steepest)


def test_both_of_two_touches_are_found(rng):
    """A path that passes a point twice, the second time closer: the first dip must not end the search."""
    tips = np.array([[-30.0, 3.0, 0.0], [30.0, 3.0, 0.0], [30.0, -2.5, 0.0], [-30.0, -2.5, 0.0]])
    motion = CLMotion(tips, np.tile([0.0, 0.0, 1.0], (4, 1)))
    found = least_distance(motion, ball(), np.array([[1.0, 0.0, BALL]]))
    assert found.distance[0] == pytest.approx(0.5, abs=1e-6)
    assert found.piece[0] == 2


def test_a_distance_that_stays_constant_is_told_with_what_is_certain():
    """A cylinder sliding along its own contact line: every pose is the closest one."""
    motion = CLMotion(np.array([[0.0, 0.0, 0.0], [0.0, 0.0, 5.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    found = least_distance(motion, ball(), np.array([[BALL + 1.0, 0.0, 12.0]]))
    assert found.distance[0] == pytest.approx(1.0, abs=1e-12)
    assert 1.0 - 1e-5 < found.bound[0] <= 1.0


def test_the_sharpened_pose_gives_the_normal(rng):
    motion = CLMotion(np.array([[-10.0, 0.0, 0.0], [10.0, 0.0, 0.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    spoke = unit(rng.normal(size=(50, 3)) * [0.0, 1.0, 1.0] - [0.0, 0.0, 2.0])
    spoke[:, 2] = -np.abs(spoke[:, 2])
    points = np.column_stack([rng.uniform(-9.0, 9.0, 50), np.zeros(50), np.full(50, BALL)]) + BALL * spoke
    found = least_distance(motion, ball(), points)
    t = settled_pose(motion, ball(), points, found)
    assert np.allclose(20.0 * t - 10.0, points[:, 0], rtol=0.0, atol=1e-9)
    assert np.allclose(gradient_at(motion, ball(), points, found.piece, t), spoke, rtol=0.0, atol=1e-9)
