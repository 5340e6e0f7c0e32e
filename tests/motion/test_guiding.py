import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.series import Series
from gearsim.motion.guiding import guided, line
from tests.helpers import observed_order


def helix(radius, rise, turns):
    def curve(values, order):
        p = Series.variable(values, order)
        turn = series.exp(p * (2j * np.pi * turns))
        return series.stack([turn.real * radius, turn.imag * radius, p * rise + radius])

    return curve


ZERO = np.zeros(1, dtype=int)


def test_the_tip_follows_one_curve_and_the_axis_points_to_the_other():
    tip, top = helix(20.0, 5.0, 0.3), helix(34.0, 9.0, 0.35)
    motion = guided(tip, top, 0.2, 0.9)
    t = np.linspace(0.0, 1.0, 5)
    pose = motion.pose(np.zeros(5, dtype=int), t, 0)
    at = 0.2 + 0.7 * t
    a, b = tip(at, 0).value, top(at, 0).value
    assert np.allclose(pose.tip.value, a)
    assert np.allclose(pose.axis.value, (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True))


@pytest.mark.parametrize("order", [1, 2])
def test_a_point_up_the_axis_moves_as_the_normalised_axis_says(order):
    """Erratum 4.5, by central differences of the point itself."""
    motion, h = guided(helix(20.0, 5.0, 0.3), helix(34.0, 9.0, 0.35)), 17.0
    exact = motion.pose(ZERO, np.array([0.4]), order)
    ours = (exact.tip.derivatives()[order] + h * exact.axis.derivatives()[order])[0]

    def point(t):
        pose = motion.pose(ZERO, np.array([t]), 0)
        return (pose.tip.value + h * pose.axis.value)[0]

    steps, errors = np.array([4e-2, 2e-2, 1e-2]), []
    for d in steps:
        low, mid, high = point(0.4 - d), point(0.4), point(0.4 + d)
        difference = (high - low) / (2 * d) if order == 1 else (high - 2 * mid + low) / d**2
        errors.append(np.linalg.norm(difference - ours))
    assert observed_order(errors, steps) == pytest.approx(2.0, abs=0.1)


def test_the_printed_velocity_holds_only_between_curves_of_constant_distance():
    """Erratum 4.5: with h as a fraction of the distance; a distance that grows adds a velocity along the axis."""
    tip = line([0.0, 0.0, 0.0], [10.0, 0.0, 0.0])
    for end, holds in (([10.0, 0.0, 40.0], True), ([10.0, 0.0, 60.0], False)):
        top = line([0.0, 0.0, 40.0], end)
        pose = guided(tip, top).pose(ZERO, np.zeros(1), 1)
        ours = pose.tip.c[1] + 20.0 * pose.axis.c[1]
        printed = 0.5 * tip(np.zeros(1), 1).c[1] + 0.5 * top(np.zeros(1), 1).c[1]
        assert np.allclose(ours, printed) == holds


def test_a_line_runs_from_end_to_end():
    ends = line([1.0, 2.0, 3.0], [4.0, 6.0, 3.0])(np.array([0.0, 0.5, 1.0]), 2)
    assert np.allclose(ends.value, [[1, 2, 3], [2.5, 4, 3], [4, 6, 3]])
    assert np.allclose(ends.c[1], [3, 4, 0])
    assert np.allclose(ends.c[2], 0.0)


def test_curves_that_meet_are_refused():
    motion = guided(line([0.0, 0, 0], [10.0, 0, 0]), line([10.0, 0, 0], [0.0, 0, 0]))
    with pytest.raises(InputError, match=r"the guiding curves meet at parameter 0\.5"):
        motion.pose(np.zeros(3, dtype=int), np.array([0.0, 0.5, 1.0]), 1)
