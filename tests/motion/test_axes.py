import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, head_head_cb, phoenix, table_table_bc
from gearsim.machines.path import axis_values, axis_values_of_frames
from gearsim.motion.axes import AxisMotion, TipMotion, tip_control
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion
from tests.helpers import observed_order


def blocks(machine, rng, n=4):
    scale = np.array([0.6 if joint.is_rotary else 40.0 for joint in machine.joints])
    return scale * rng.normal(size=(n, len(scale)))


def at(source, piece, t, order=0):
    return source.pose(np.full(np.size(t), piece), np.atleast_1d(np.asarray(t, dtype=float)), order)


def test_zhous_interpolation_on_the_c_b_head():
    """(4.15) to (4.17), typed out: tip, axis and the velocity of the point h up the axis."""
    machine, h = head_head_cb(150.0), 27.0
    tips = np.array([[0.0, 0, 0], [50.0, 50, 10]])
    rotary = np.array([[0.1, -0.2], [0.4, 0.9]])
    db, dc = rotary[1] - rotary[0]
    for t in (0.0, 0.3, 1.0):
        b, c = rotary[0] + t * (rotary[1] - rotary[0])
        pose = at(TipMotion(machine, tips, rotary), 0, t, 1)
        assert np.allclose(pose.tip.value[0], t * tips[1], atol=1e-13)
        assert np.allclose(pose.axis.value[0], [np.sin(b) * np.cos(c), np.sin(b) * np.sin(c), np.cos(b)], atol=1e-14)
        turning = [
            db * np.cos(b) * np.cos(c) - dc * np.sin(b) * np.sin(c),
            db * np.cos(b) * np.sin(c) + dc * np.sin(b) * np.cos(c),
            -db * np.sin(b),
        ]
        velocity = (pose.tip.c[1] + h * pose.axis.c[1])[0]
        assert np.allclose(velocity, tips[1] - tips[0] + h * np.array(turning), atol=1e-12)


@given(st.sampled_from(sorted(MACHINES)), st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_linear_axes_stand_where_their_values_say(name, seed):
    rng = np.random.default_rng(seed)
    machine = MACHINES[name]()
    values = blocks(machine, rng)
    source, t = AxisMotion(machine, values), np.array([0.0, 0.4, 1.0])
    for piece in range(3):
        pose = at(source, piece, t)
        tip, axis = machine.forward(values[piece] + t[:, None] * (values[piece + 1] - values[piece]))
        assert np.allclose(pose.tip.value, tip, atol=1e-11)
        assert np.allclose(pose.axis.value, axis, atol=1e-12)


@given(st.sampled_from(sorted(MACHINES)), st.integers(0, 10_000))
@settings(max_examples=40, deadline=None)
def test_tip_control_keeps_blocks_axis_and_a_straight_tip(name, seed):
    rng = np.random.default_rng(seed)
    machine = MACHINES[name]()
    values = blocks(machine, rng)
    free, controlled, t = AxisMotion(machine, values), tip_control(machine, values), np.array([0.0, 0.35, 1.0])
    for piece in range(3):
        a, b = at(free, piece, t, 2), at(controlled, piece, t, 2)
        assert np.allclose(a.axis.c, b.axis.c, atol=1e-12)
        assert np.allclose(a.tip.value[[0, 2]], b.tip.value[[0, 2]], atol=1e-11)
        straight = a.tip.value[0] + t[:, None] * (a.tip.value[2] - a.tip.value[0])
        assert np.allclose(b.tip.value, straight, atol=1e-11)
        assert np.allclose(b.tip.c[2], 0.0)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_converge_with_second_order(order, rng):
    stencil = {1: [-0.5, 0, 0.5], 2: [1, -2, 1], 3: [-0.5, 1, 0, -1, 0.5]}[order]
    steps = np.array([4e-2, 2e-2, 1e-2])
    machine = phoenix()
    values = blocks(machine, rng)
    for source in (AxisMotion(machine, values), tip_control(machine, values)):
        exact = source.frame(np.zeros(1, dtype=int), np.array([0.4]), order)
        for k, part in enumerate(exact):
            errors = []
            for h in steps:
                t = 0.4 + h * (np.arange(len(stencil)) - len(stencil) // 2)
                values_near = source.frame(np.zeros(len(t), dtype=int), t, 0)[k].value
                errors.append(np.linalg.norm(stencil @ values_near / h**order - part.derivatives()[order][0]))
            if max(errors) > 1e-8:
                assert observed_order(errors, steps) == pytest.approx(2.0, abs=0.2)


def test_the_frames_of_a_six_axis_machine_carry_the_spin(rng):
    machine = phoenix()
    values = blocks(machine, rng)
    t = np.array([0.25, 0.5])
    frame = AxisMotion(machine, values).frame(np.array([1, 1]), t, 0)
    rotation, _ = machine.forward_frame(values[1] + t[:, None] * (values[2] - values[1]))
    assert np.allclose(frame.radial.value, rotation[..., 0], atol=1e-13)
    spun = values.copy()
    spun[:, machine.axes.index("C")] += 0.5
    turned = AxisMotion(machine, spun).frame(np.array([1, 1]), t, 0)
    assert np.allclose(turned.tip.value, frame.tip.value, atol=1e-11)
    assert np.allclose((turned.radial.value * frame.radial.value).sum(axis=1), np.cos(0.5))


def test_tip_control_turns_the_tool_about_its_axis_too(rng):
    machine = phoenix()
    values = blocks(machine, rng, 2)
    piece, t = np.zeros(3, dtype=int), np.array([0.0, 0.4, 1.0])
    free, controlled = (s.frame(piece, t, 1) for s in (AxisMotion(machine, values), tip_control(machine, values)))
    assert np.allclose(controlled.radial.c, free.radial.c, atol=1e-13)


def smooth_path(n):
    """A curve with a turning axis on a B/C table, sampled at n + 1 points."""
    s = np.linspace(0.0, 1.0, n + 1)
    b, c = 0.3 + 0.4 * s, 1.2 * s * s
    axis = np.stack([np.sin(b) * np.cos(c), np.sin(b) * np.sin(c), np.cos(b)], axis=1)
    return np.stack([60 * s, 20 * np.sin(2 * s), 5 * s * s], axis=1), axis


def test_from_cl_points_to_the_machine_the_motions_close_up_with_second_order():
    """CL, tool-centre-point control and linear axes share the CL points; between them they differ as 1 / n^2."""
    machine, counts = table_table_bc(), np.array([10, 20, 40])
    gaps = {"tip": [], "axes": []}
    for n in counts:
        tips, axes = smooth_path(n)
        path = axis_values(machine, tips, axes)
        assert path.messages() == []
        cl, free = CLMotion(tips, axes), AxisMotion(machine, path.values)
        tip_controlled = tip_control(machine, path.values)
        pieces, half = np.arange(n), np.full(n, 0.5)
        a, b, c = (s.pose(pieces, half, 0) for s in (cl, tip_controlled, free))
        assert np.allclose(a.tip.value, b.tip.value, atol=1e-10)
        gaps["tip"].append(np.abs(c.tip.value - a.tip.value).max())
        gaps["axes"].append(np.abs(b.axis.value - a.axis.value).max())
        assert np.allclose(b.axis.value, c.axis.value, atol=1e-13)
    for gap in gaps.values():
        assert observed_order(gap, 1.0 / counts) == pytest.approx(2.0, abs=0.1)


def test_frames_sampled_from_a_motion_return_it_on_the_phoenix(rng):
    machine = phoenix()
    source = AxisMotion(machine, machine.values(X=[100, 140], Z=[300, 310], A=[0.0, 1.0], B=[0.2, 0.4], C=[0.0, 2.0]))
    frame = source.frame(np.zeros(9, dtype=int), np.linspace(0.0, 1.0, 9), 0)
    tip, axis, radial = (part.value for part in frame)
    path = axis_values_of_frames(machine, np.stack([radial, np.cross(axis, radial), axis], axis=-1), tip)
    again = AxisMotion(machine, path.values).pose(np.array([3, 5]), np.array([0.5, 0.5]), 0)
    there = source.pose(np.zeros(2, dtype=int), np.array([3.5, 5.5]) / 8, 0)
    assert np.allclose(again.tip.value, there.tip.value, atol=1e-10)


def test_the_removal_roads_table_takes_such_motions(rng):
    machine = table_table_bc()
    table = compile_motion(AxisMotion(machine, blocks(machine, rng, 2)), reach=20.0)
    assert len(table) > 1


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda m: AxisMotion(m, np.zeros((1, 5))), "at least 2 blocks of axis values, got 1"),
        (lambda m: AxisMotion(m, np.zeros((3, 4))), r"shape \(n, 5\) for X, Y, Z, B, C"),
        (lambda m: TipMotion(m, np.zeros((3, 3)), np.zeros((3, 3))), r"rotary axes B, C of shape \(n, 2\)"),
        (lambda m: TipMotion(m, np.zeros((2, 2)), np.zeros((2, 2))), r"tips of shape \(n, 3\)"),
        (lambda m: TipMotion(m, np.zeros((1, 3)), np.zeros((1, 2))), "at least 2 blocks"),
    ],
)
def test_mistakes_are_named(make, message):
    with pytest.raises(InputError, match=message):
        make(head_head_cb())
