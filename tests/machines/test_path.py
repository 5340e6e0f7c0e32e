from math import pi, radians

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, head_head_cb, phoenix, star, table_table_bc
from gearsim.machines.inverse import inverse_pose, wrap
from gearsim.machines.path import axis_values, axis_values_of_frames

FIVE_AXIS = sorted(set(MACHINES) - {"cradle", "phoenix", "star"})


def run(machine, **values):
    """Tips and axes of given axis values."""
    return machine.forward(machine.values(**values))


def greedy(machine, tip, axis, begin):
    """The branch of least rotary motion, one point after the other."""
    both = inverse_pose(machine, tip, axis).values
    turns = [i for i, joint in enumerate(machine.joints) if joint.is_rotary]
    branch = [begin]
    for i in range(1, len(tip)):
        last = both[branch[-1], i - 1, turns]
        branch.append(int(np.argmin([np.abs(wrap(b[i, turns] - last)).sum() for b in both])))
    return branch


@given(st.sampled_from(FIVE_AXIS), st.integers(0, 100_000))
@settings(max_examples=40, deadline=None)
def test_the_path_follows_least_motion_and_reaches_every_pose(name, seed):
    rng = np.random.default_rng(seed)
    machine = MACHINES[name]()
    steps = rng.normal(size=(37, len(machine.axes))) * [20, 20, 20, 0.5, 0.5]
    tip, axis = machine.forward(np.cumsum(steps, axis=0))
    start = inverse_pose(machine, tip, axis).values[1, 0]
    path = axis_values(machine, tip, axis, near=start)
    again = machine.forward(path.values)
    assert np.allclose(again[0], tip, atol=1e-10)
    assert np.allclose(again[1], axis, atol=1e-11)
    assert np.array_equal(path.branch, greedy(machine, tip, axis, 1))
    assert np.abs(np.diff(path.values[:, 3:], axis=0)).max() <= pi + 1e-9


@pytest.mark.parametrize("machine", [phoenix(), star()])
def test_a_smooth_path_of_frames_comes_back_as_it_was(machine):
    t = np.linspace(0.0, 1.0, 60)
    rest = {"phoenix": {"B": 0.3 * t, "C": 2.0 - 9.0 * t}, "star": {"B": 0.9 + 0.3 * t, "D": 2.0 - 9.0 * t}}
    values = machine.values(X=100 * t, Y=-50 * t * t, Z=300 + 20 * t, A=0.2 + 12.0 * t, **rest[machine.name])
    path = axis_values_of_frames(machine, *machine.forward_frame(values), near=values[0])
    assert np.allclose(path.values, values, atol=1e-10)
    assert path.messages() == []


@pytest.mark.parametrize("steps", [20, 21])
def test_through_the_singular_position_the_table_does_not_turn(steps):
    """B runs from +20 to -20 deg at a fixed C; with 21 points one of them stands exactly upright."""
    machine = table_table_bc()
    b = np.radians(np.linspace(20.0, -20.0, steps))
    path = axis_values(
        machine, *run(machine, X=np.linspace(0, 30, steps), B=b, C=0.7), near=machine.values(C=0.7, B=0.3)[0]
    )
    assert np.allclose(path.values[:, 3], b, atol=1e-12)
    assert np.allclose(path.values[:, 4], 0.7, atol=1e-9)
    assert path.free.sum() == steps % 2
    assert path.swings == ()


def test_a_free_start_takes_the_given_or_the_next_position():
    """Zhou's first example: B = C = 0 to B = C = 18 deg."""
    machine = head_head_cb()
    pose = run(machine, B=np.radians([0.0, 18.0]), C=np.radians([0.0, 18.0]))
    assert np.allclose(np.degrees(axis_values(machine, *pose).values[:, 3:]), [[0, 18], [18, 18]])
    near = axis_values(machine, *pose, near=np.zeros(5))
    assert np.allclose(np.degrees(near.values[:, 3:]), [[0, 0], [18, 18]])
    assert "C is parallel to the tool's direction at 1 points, first at point 1" in near.messages()[-1]


def test_a_path_that_is_free_everywhere_stands_still():
    machine = head_head_cb()
    pose = run(machine, X=[0.0, 5.0, 9.0])
    assert np.allclose(axis_values(machine, *pose).values[:, 3:], 0.0)
    assert np.allclose(axis_values(machine, *pose, near=machine.values(C=1.2)[0]).values[:, 4], 1.2)


def test_swings_near_the_singular_position_are_reported_with_their_rate():
    """The axis runs past the pole at 0.1 deg in steps of 1 deg: C must turn by nearly half a turn."""
    machine = head_head_cb()
    x, y = np.radians(np.arange(-5, 6)), radians(0.1)
    axis = np.stack([x, np.full_like(x, y), np.sqrt(1 - x * x - y * y)], axis=1)
    path = axis_values(
        machine, np.zeros((11, 3)), axis, near=inverse_pose(machine, np.zeros((11, 3)), axis).values[0, 0]
    )
    turn = np.arctan2(y, 1e-300) - np.arctan2(y, radians(1.0))
    assert [s.point for s in path.swings] == [4, 5]
    assert abs(path.swings[0].turn) == pytest.approx(turn, rel=1e-9)
    assert path.swings[0].rate == pytest.approx(turn / radians(1.0), rel=1e-3)
    assert "axis C swings by" in path.messages()[0]


def test_unwrapped_turns_add_up_and_start_in_the_asked_turn():
    machine = table_table_bc()
    c = np.linspace(0.0, 20.0, 50)
    pose = run(machine, B=0.5, C=c)
    near = machine.values(B=0.5, C=4 * pi)[0]
    assert np.allclose(axis_values(machine, *pose, near=near).values[:, 4], c + 4 * pi, atol=1e-10)


def test_the_start_is_chosen_so_that_limits_hold():
    machine = table_table_bc().limited(B=(radians(-100), radians(10)), C=(0.0, 4 * pi), X=(-500.0, 500.0))
    c = np.linspace(0.0, 3.0 * pi, 30)
    path = axis_values(machine, *run(machine, B=0.5, C=c))
    assert path.overruns == ()
    assert np.allclose(path.values[:, 3], -0.5)
    assert path.values[:, 4].min() >= 0.0
    assert path.values[:, 4].max() <= 4 * pi


def test_whole_turns_are_added_until_the_limits_hold():
    machine = table_table_bc().limited(C=(0.0, 4 * pi))
    c = np.linspace(-21.0, -15.0, 30)
    path = axis_values(machine.limited(B=(0.0, 1.0)), *run(machine, B=0.5, C=c))
    assert path.overruns == ()
    assert wrap(path.values[:, 4] - c) == pytest.approx(0.0, abs=1e-9)


def test_without_a_wish_the_smaller_positions_are_taken():
    """Litvin and Chen under (16): of phi and 180 deg - phi the smaller one."""
    machine, t = phoenix(), np.linspace(0.0, 1.0, 9)
    values = machine.values(Z=300.0, A=0.3 + t, B=-0.2 - 0.1 * t, C=0.1 * t)
    path = axis_values_of_frames(machine, *machine.forward_frame(values))
    assert np.allclose(path.values, values, atol=1e-10)
    other = machine.values(Z=300.0, A=pi - t, B=pi + 0.2 + 0.1 * t, C=pi + 0.1 * t)
    again = axis_values_of_frames(machine, *machine.forward_frame(other))
    assert np.abs(again.values[:, 4]).max() < pi / 2


@pytest.mark.parametrize(("limits", "low", "high"), [((-10.0, np.inf), -10.0, 1e9), ((-np.inf, -30.0), -1e9, -30.0)])
def test_one_sided_limits_hold_too(limits, low, high):
    machine = table_table_bc().limited(C=limits)
    path = axis_values(machine, *run(machine, B=0.5, C=np.linspace(0.0, -16.0, 40)))
    assert path.overruns == ()
    assert low <= path.values[:, 4].min() <= path.values[:, 4].max() <= high


def test_an_overrun_names_axis_points_and_size():
    machine = head_head_cb().limited(X=(-20.0, 20.0), B=(-0.4, 0.4))
    pose = run(machine, X=[0.0, 15.0, 30.0, 25.0], B=[0.1, 0.2, 0.3, 0.5], C=1.0)
    x, b = axis_values(machine, *pose, near=machine.values(B=0.1, C=1.0)[0]).overruns
    assert (x.joint.name, x.first, x.worst, x.limit) == ("X", 2, 2, 20.0)
    assert x.value == pytest.approx(30.0)
    assert str(x) == "axis X overruns its limit of 20 mm from point 3 on, by 10 mm at point 3"
    assert str(b) == "axis B overruns its limit of 22.9183 deg from point 4 on, by 5.72958 deg at point 4"


def test_start_values_of_another_machine_are_refused():
    with pytest.raises(InputError, match=r"expected start values for X, Y, Z, B, C, got shape \(6,\)"):
        axis_values(head_head_cb(), np.zeros((1, 3)), np.array([[0.0, 0, 1]]), near=np.zeros(6))
