import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.motion.sources import CLMotion, CurveMotion, MovedMotion
from tests.conftest import random_rotation
from tests.helpers import observed_order, slerp


def random_cl(rng, n=6, spread=0.3):
    axes = np.array([0.0, 0.0, 1.0]) + spread * rng.normal(size=(n, 3))
    return CLMotion(rng.normal(size=(n, 3)), axes / np.linalg.norm(axes, axis=1, keepdims=True))


def test_cl_motion_is_a_straight_tip_and_a_constant_rate_turn(rng):
    source = random_cl(rng)
    t = np.linspace(0.0, 1.0, 9)
    for i in range(source.pieces):
        pose = source.pose(np.full(9, i), t, 1)
        tip = source.tips[i] + t[:, None] * (source.tips[i + 1] - source.tips[i])
        assert np.allclose(pose.tip.value, tip, atol=1e-14)
        assert np.allclose(pose.axis.value, slerp(source.axes[i], source.axes[i + 1], t), atol=1e-14)
        rate = np.linalg.norm(pose.axis.c[1], axis=1)
        assert np.allclose(rate, np.arccos(source.axes[i] @ source.axes[i + 1]), atol=1e-12)


def test_a_step_without_rotation_keeps_the_axis():
    source = CLMotion(np.array([[0.0, 0, 0], [1.0, 0, 0]]), np.array([[0.0, 0, 1], [0.0, 0, 1]]))
    pose = source.pose(np.zeros(3, dtype=int), np.array([0.0, 0.5, 1.0]), 2)
    assert np.allclose(pose.axis.value, [0, 0, 1])
    assert np.allclose(pose.axis.c[1:], 0.0)


def test_opposite_axes_and_single_points_are_refused():
    with pytest.raises(InputError, match="points 1 and 2 have opposite tool axes"):
        CLMotion(np.zeros((2, 3)), np.array([[0.0, 0, 1], [0.0, 0, -1]]))
    with pytest.raises(InputError, match="at least 2 points, got 1"):
        CLMotion(np.zeros((1, 3)), np.array([[0.0, 0, 1]]))


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_converge_with_second_order(order, rng, tooth, fitting_cutter):
    from gearsim.toolpaths.flank import FlankPath

    steps = np.array([4e-2, 2e-2, 1e-2])
    for source in (random_cl(rng, spread=1.0), FlankPath(tooth, "convex", fitting_cutter, 5.0).motion):
        piece, t = np.zeros(1, dtype=int), np.array([0.4])
        exact = source.pose(piece, t, order)
        for name in ("tip", "axis"):
            errors = []
            for h in steps:
                low, mid, high = (getattr(source.pose(piece, t + d, 0), name).value for d in (-h, 0.0, h))
                difference = (high - low) / (2 * h) if order == 1 else (high - 2 * mid + low) / h**2
                errors.append(np.linalg.norm(difference - getattr(exact, name).derivatives()[order]))
            if max(errors) > 1e-9:
                assert observed_order(errors, steps) == pytest.approx(2.0, abs=0.15)


def test_a_moved_motion_is_the_motion_moved(rng):
    source, rigid = random_cl(rng), Rigid(random_rotation(rng), rng.normal(size=3))
    piece, t = np.array([0, 3]), np.array([0.2, 0.9])
    moved, original = MovedMotion(source, rigid).pose(piece, t, 2), source.pose(piece, t, 2)
    assert np.allclose(moved.tip.value, rigid.point(original.tip.value))
    assert np.allclose(moved.tip.c[1:], rigid.direction(original.tip.c[1:]))
    assert np.allclose(moved.axis.c, rigid.direction(original.axis.c))


def test_a_curve_is_scaled_to_its_range():
    from gearsim.geometry import series
    from gearsim.geometry.pose import PoseSeries
    from gearsim.geometry.series import Series

    def curve(phi, order):
        p = Series.variable(phi, order)
        one = Series(np.zeros_like(p.c)) + 1.0
        return PoseSeries(series.stack([p, p * p, one]), series.stack([one * 0.0, one * 0.0, one]))

    pose = CurveMotion(curve, 2.0, 6.0).pose(np.zeros(1, dtype=int), np.array([0.25]), 2)
    tip = [d[0] for d in pose.tip.derivatives()]
    assert np.allclose(tip, [[3, 9, 1], [4, 24, 0], [0, 32, 0]])


@pytest.mark.parametrize(
    ("tips", "axes", "message"),
    [
        (np.zeros((2, 3)), np.tile([0.0, 0.0, 2.0], (2, 1)), "CL point 1: .* unit axis"),
        (np.zeros((2, 3)), np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]), "CL point 2: .* unit axis"),
        (np.array([[0.0, 0.0, 0.0], [np.inf, 0.0, 0.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)), "CL point 2: .* finite"),
        (np.zeros((2, 2)), np.zeros((2, 2)), r"expected \(n, 3\) both"),
        (np.zeros((3, 3)), np.tile([0.0, 0.0, 1.0], (2, 1)), r"expected \(n, 3\) both"),
    ],
)
def test_points_that_are_none_are_refused_by_number(tips, axes, message):
    with pytest.raises(InputError, match=message):
        CLMotion(tips, axes)
