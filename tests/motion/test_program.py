import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, head_head_cb, table_table_bc
from gearsim.motion.axes import AxisMotion, tip_control
from gearsim.motion.program import ProgramMotion, cutting
from gearsim.motion.segments import compile_motion
from gearsim.programs.blocks import Blocks
from tests.helpers import observed_order


def block_table(machine, values, **columns):
    """Blocks between rows of axis values, feeds without arcs unless ``columns`` say otherwise."""
    n = len(values) - 1
    columns = {
        "rapid": np.zeros(n, bool), "tip_control": np.zeros(n, bool), "seconds": np.ones(n),
        "line": np.arange(1, n + 1), "tool": np.ones(n, int), "operation": np.zeros(n, int),
        "sweep": np.zeros(n), "centre": np.zeros((n, 3)), "normal": np.full(n, 2),
    } | {name: np.asarray(column) for name, column in columns.items()}  # fmt: skip
    return Blocks(machine, np.asarray(values[0], float), np.asarray(values[1:], float), **columns)


def some_values(machine, rng, n):
    scale = np.array([0.6 if joint.is_rotary else 40.0 for joint in machine.joints])
    return scale * rng.normal(size=(n, len(scale)))


def sampled(source, t, order=0):
    """Poses of all pieces at every t."""
    piece = np.repeat(np.arange(source.pieces), len(t))
    return source.frame(piece, np.tile(t, source.pieces), order)


@given(st.sampled_from(sorted(MACHINES)), st.integers(0, 10_000), st.integers(0, 2))
@settings(max_examples=40, deadline=None)
def test_blocks_of_one_kind_are_the_motion_of_that_kind(name, seed, order):
    rng = np.random.default_rng(seed)
    machine = MACHINES[name]()
    values, t = some_values(machine, rng, 5), np.array([0.0, 0.3, 1.0])
    for held, twin in ((False, AxisMotion(machine, values)), (True, tip_control(machine, values))):
        source = ProgramMotion(block_table(machine, values, tip_control=np.full(4, held)))
        for ours, theirs in zip(sampled(source, t, order), sampled(twin, t, order), strict=True):
            assert np.allclose(ours.c, theirs.c, rtol=0.0, atol=1e-11)


def test_kinds_may_change_from_block_to_block(rng):
    machine = head_head_cb()
    values, t = some_values(machine, rng, 7), np.array([0.2, 0.9])
    held = np.array([True, False, False, True, True, False])
    source = ProgramMotion(block_table(machine, values, tip_control=held))
    mixed = sampled(source, t).tip.value.reshape(6, 2, 3)
    free, straight = (
        sampled(twin, t).tip.value.reshape(6, 2, 3)
        for twin in (AxisMotion(machine, values), tip_control(machine, values))
    )
    assert np.allclose(mixed, np.where(held[:, None, None], straight, free), atol=1e-11)


@pytest.mark.parametrize("normal", [0, 1, 2])
@pytest.mark.parametrize("sweep", [0.7, -2.5, 2.0 * np.pi, -9.0])
def test_an_arc_is_a_helix_about_its_centre(normal, sweep):
    """With all rotary axes at rest at zero the tip is where the linear axes are."""
    u, v = (normal + 1) % 3, (normal + 2) % 3
    centre, radius, begin, rise = np.array([3.0, -4.0, 5.0]), 6.0, 0.4, 1.5

    def helix(t):
        point = np.tile(centre, (len(t), 1))
        point[:, u] += radius * np.cos(begin + sweep * t)
        point[:, v] += radius * np.sin(begin + sweep * t)
        point[:, normal] += 2.0 + rise * t
        return point

    machine = table_table_bc()
    values = np.hstack([helix(np.array([0.0, 1.0])), np.zeros((2, 2))])
    source = ProgramMotion(block_table(machine, values, sweep=[sweep], centre=[centre], normal=[normal]))
    t = np.linspace(0.0, 1.0, 7)
    tip = sampled(source, t, 1).tip
    assert np.allclose(tip.value, helix(t), atol=1e-12)
    speed = np.hypot(radius * sweep, rise)
    assert np.allclose(np.linalg.norm(tip.c[1], axis=1), speed, rtol=1e-12)


def test_an_arc_ends_where_it_is_programmed_and_turns_the_table_meanwhile():
    machine = table_table_bc()
    values = np.array([[10.0, 0, 0, 0, 0], [0.003, 10.004, 1.0, 0.1, 3.0]])
    arc = block_table(machine, values, sweep=[np.pi / 2], normal=[2])
    source, t = ProgramMotion(arc), np.array([0.0, 0.5, 1.0])
    tip = sampled(source, t).tip.value
    assert np.allclose(tip[[0, 2]], machine.forward(values)[0], atol=1e-12)
    last = np.hypot(0.003, 10.004)
    middle = 0.5 * (10.0 + last) / np.sqrt(2)
    half = np.array([[middle + 0.0015, middle + 0.5 * (10.004 - last), 0.5, 0.05, 1.5]])
    assert np.allclose(tip[1], machine.forward(half)[0], atol=1e-12)


@pytest.mark.parametrize("normal", [0, 1, 2])
@pytest.mark.parametrize("sweep", [0.3, -2.0, 2.0 * np.pi, -6.0 * np.pi])
def test_ends_off_the_circle_make_a_spiral(normal, sweep):
    """Radius and angle go evenly (Archimedes), as LinuxCNC's trajectory planner moves; 2 mm off 1000 mm are allowed."""
    u, v = (normal + 1) % 3, (normal + 2) % 3
    centre, t = np.array([3.0, -4.0, 5.0]), np.linspace(0.0, 1.0, 5)
    point = np.tile(centre, (len(t), 1))
    point[:, u] += (1000.0 + 2.0 * t) * np.cos(0.4 + sweep * t)
    point[:, v] += (1000.0 + 2.0 * t) * np.sin(0.4 + sweep * t)
    values = np.hstack([point[[0, -1]], np.zeros((2, 2))])
    arc = block_table(table_table_bc(), values, sweep=[sweep], centre=[centre], normal=[normal])
    assert np.allclose(sampled(ProgramMotion(arc), t).tip.value, point, atol=1e-10)


@pytest.mark.parametrize("order", [1, 2, 3])
def test_derivatives_converge_with_second_order(order, rng):
    stencil = {1: [-0.5, 0, 0.5], 2: [1, -2, 1], 3: [-0.5, 1, 0, -1, 0.5]}[order]
    machine = head_head_cb()
    values = some_values(machine, rng, 4)
    source = ProgramMotion(block_table(machine, values, tip_control=[False, True, False], sweep=[1.2, 0.0, 0.0]))
    steps = np.array([4e-2, 2e-2, 1e-2])
    for piece in range(3):
        exact = source.frame(np.array([piece]), np.array([0.4]), order)
        for k, part in enumerate(exact):
            errors = []
            for h in steps:
                t = 0.4 + h * (np.arange(len(stencil)) - len(stencil) // 2)
                near = source.frame(np.full(len(t), piece), t, 0)[k].value
                errors.append(np.linalg.norm(stencil @ near / h**order - part.derivatives()[order][0]))
            assert max(errors) < 1e-8 or observed_order(errors, steps) == pytest.approx(2.0, abs=0.2)


def test_blocks_that_move_nothing_are_dropped_and_feeds_are_picked_out():
    machine = table_table_bc()
    values = np.array([[0.0, 0, 0, 0, 0], [5, 0, 0, 0, 0], [5, 0, 0, 0, 0], [5, 3, 0, 0, 0], [5, 3, -2, 0, 1]])
    blocks = block_table(machine, values, rapid=np.array([True, False, False, False]))
    whole = ProgramMotion(blocks)
    assert list(whole.rows) == [0, 2, 3]
    feeds = cutting(blocks)
    assert list(feeds.rows) == [2, 3]
    assert np.allclose(feeds.pose(np.array([0]), np.array([0.0]), 0).tip.value, [[5.0, 0, 0]])
    assert list(whole.select(np.array([False, False, False, True])).rows) == [3]


def test_turns_of_the_table_compile_to_a_table_that_follows_them():
    machine = table_table_bc()
    values = np.array([[30.0, 0, 0, -0.3, 0], [31, 2, -1, -0.3, np.radians(380)], [35, 2, -1, -0.3, np.radians(380)]])
    source = ProgramMotion(block_table(machine, values))
    table = compile_motion(source, 20.0, 1e-7)
    x = np.array([-1.0, 0.3, 1.0])
    tip = np.einsum("xk,nkc->nxc", np.vander(x, 6, increasing=True), table.tip)
    t = table.start[:, None] + 0.5 * (table.end - table.start)[:, None] * (1.0 + x)
    exact = source.pose(np.repeat(table.piece, 3), t.ravel(), 0).tip.value
    assert np.abs(tip.reshape(-1, 3) - exact).max() < 2e-7
    assert len(table) > 200


def test_what_cannot_run_is_refused():
    machine = table_table_bc()
    values = np.array([[1.0, 0, 0, 0, 0], [1.0, 0, 0, 0, 0]])
    with pytest.raises(InputError, match="none of the chosen blocks moves"):
        ProgramMotion(block_table(machine, values))
    with pytest.raises(InputError, match=r"block 1 \(line 1\).*arc under tip control"):
        ProgramMotion(block_table(machine, values, sweep=[1.0], tip_control=[True]))
