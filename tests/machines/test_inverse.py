from dataclasses import replace
from math import asin, atan2, pi, radians

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, cradle, head_b_table_c, head_head_cb, phoenix, star, table_table_bc
from gearsim.machines.chain import Machine, rotary, slide
from gearsim.machines.inverse import inverse_frame, inverse_pose, reach_tip, wrap
from tests.machines.matrices import litvin_settings, turn

INVERTIBLE = sorted(set(MACHINES) - {"cradle"})
SIX_AXIS = ("phoenix", "star")
XYZ = (slide("X", (1.0, 0, 0)), slide("Y", (0, 1.0, 0)), slide("Z", (0, 0, 1.0)))
S_P = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
S_T = np.diag([1.0, -1, -1])


def tilted_machine(rng):
    """Slides and rotary axes in any direction through any point, one rotary on each side."""
    w1, w2 = rng.normal(size=(2, 3))
    joints = [
        rotary(name, tuple(w / np.linalg.norm(w)), tuple(50.0 * rng.normal(size=3)))
        for name, w in (("C", w1), ("B", w2))
    ]
    return Machine("tilted", (*XYZ, joints[1]), (joints[0],))


def random_values(machine, rng, n):
    scale = np.array([pi if joint.is_rotary else 300.0 for joint in machine.joints])
    return rng.uniform(-1.0, 1.0, (n, len(scale))) * scale


def distance(machine, a, b):
    """Difference of axis values, rotary ones modulo a turn."""
    rotary_axis = [joint.is_rotary for joint in machine.joints]
    return np.abs(np.where(rotary_axis, wrap(a - b), a - b)).max(axis=-1)


@given(st.sampled_from([*INVERTIBLE, "tilted"]), st.integers(0, 100_000))
@settings(max_examples=150, deadline=None)
def test_both_branches_reach_the_pose_and_one_is_where_it_came_from(name, seed):
    rng = np.random.default_rng(seed)
    machine = tilted_machine(rng) if name == "tilted" else MACHINES[name]()
    values = random_values(machine, rng, 20)
    values = values[np.abs(np.linalg.det(machine.slide_directions(values))) > 0.01]
    rotation, origin = machine.forward_frame(values)
    six = name in SIX_AXIS
    found = inverse_frame(machine, rotation, origin) if six else inverse_pose(machine, origin, rotation[..., 2])
    for branch in found.values:
        again, tip = machine.forward_frame(branch)
        assert np.allclose(tip, origin, atol=1e-10)
        assert np.allclose(again if six else again[..., 2], rotation if six else rotation[..., 2], atol=1e-10)
    away = distance(machine, found.values, values)
    apart = np.abs(wrap(found.values[0] - found.values[1]))[:, 3:].max(axis=-1)
    assert (away.min(axis=0) < 1e-10)[apart > 0.3].all()  # where branches meet, angles are ill-conditioned


@pytest.mark.parametrize("name", SIX_AXIS)
def test_a_six_axis_machine_takes_tip_and_axis_with_any_spin(name, rng):
    machine = MACHINES[name]()
    tip, axis = machine.forward(random_values(machine, rng, 30))
    spin = rng.normal(size=30)
    for branch in inverse_pose(machine, tip, axis, spin).values:
        again = machine.forward(branch)
        assert np.allclose(again[0], tip, atol=1e-10)
        assert np.allclose(again[1], axis, atol=1e-12)
        assert np.allclose(branch[:, -1], spin)


def test_phoenix_follows_litvins_three_steps():
    """(16) with the smaller phi, (17), (18), then (6) = (15) for the slides, all in his frames."""
    rotation, origin = litvin_settings(0.31, -0.54, 1.1, 0.4, -0.08, 71.0, 33.0, 14.0, -1.2)
    phi = asin(rotation[0, 2])
    psi = atan2(rotation[1, 2], rotation[2, 2])
    mu = atan2(-rotation[0, 1], rotation[0, 0])
    l_pm = np.array(
        [
            [np.cos(phi), 0, np.sin(phi)],
            [-np.sin(phi) * np.sin(psi), np.cos(psi), np.cos(phi) * np.sin(psi)],
            [-np.sin(phi) * np.cos(psi), -np.sin(psi), np.cos(phi) * np.cos(psi)],
        ]
    )
    x, y, z = np.linalg.solve(l_pm, np.add(origin, [120.0, 0.0, 0.0]))
    machine = phoenix(120.0)
    found = inverse_frame(machine, (S_P.T @ rotation @ S_T)[None], (S_P.T @ origin)[None]).values[:, 0]
    expected = machine.values(X=x, Y=y, Z=z, A=-psi, B=phi, C=mu)
    assert distance(machine, found, expected).min() < 1e-12
    other = found[np.argmax(distance(machine, found, expected))]
    assert wrap(other[4] + phi) == pytest.approx(pi, abs=1e-12) or wrap(other[4] + phi) == pytest.approx(-pi, abs=1e-12)


@pytest.mark.parametrize("b", [0.0, 1e-15, 1e-11, 1e-9, 1e-7, 1e-4])
@pytest.mark.parametrize("make", [head_head_cb, table_table_bc])
def test_the_pose_stays_exact_where_the_branches_meet(make, b):
    machine = make()
    values = machine.values(X=10, Y=20, Z=30, B=b, C=2.0)
    tip, axis = machine.forward(values)
    found = inverse_pose(machine, tip, axis)
    assert found.free[0] == (b < 1e-12)
    for branch in found.values:
        again = machine.forward(branch)
        assert np.abs(again[0] - tip).max() < 1e-11
        assert np.abs(again[1] - axis).max() < 1e-14 or b < 1e-12
        assert np.abs(again[1] - axis).max() < 1e-12


@given(st.floats(0.2, 1.3), st.floats(0.2, 1.3), st.floats(-3.0, 3.0))
@settings(max_examples=50, deadline=None)
def test_a_nutating_head_reaches_its_rim_but_nothing_beyond(nutation, tilt, c):
    """w2 leans by ``nutation`` against w1, the tool by ``tilt`` against w2: reach is their difference to sum."""
    assume(abs(nutation - tilt) > 0.05)
    w2 = (np.sin(nutation), 0.0, np.cos(nutation))
    base = Machine("nutating", (*XYZ, rotary("C", (0.0, 0.0, 1.0)), rotary("B", w2, (0.0, 0.0, 100.0))), ())
    tool = turn("y", nutation - tilt)[:3, :3]
    machine = replace(base, tool_mount=type(base.tool_mount)(tool, np.zeros(3)))

    def axis_at(angle):
        return np.array([[np.sin(angle) * np.cos(c), np.sin(angle) * np.sin(c), np.cos(angle)]])

    for rim in (nutation + tilt, abs(nutation - tilt)):
        found = inverse_pose(machine, np.zeros((1, 3)), axis_at(rim))
        assert np.allclose(machine.forward(found.values[0])[1], axis_at(rim), atol=1e-10)
        assert np.abs(wrap(found.values[0] - found.values[1])).max() < 1e-4
    for beyond in (nutation + tilt + 1e-3, abs(nutation - tilt) - 1e-3):
        with pytest.raises(InputError, match="out of reach; C and B reach"):
            inverse_pose(machine, np.zeros((1, 3)), axis_at(beyond))


def test_slides_are_set_for_given_rotary_axes(rng):
    machine = table_table_bc()
    values, tip = random_values(machine, rng, 5), rng.normal(size=(5, 3))
    found = reach_tip(machine, values, tip)
    assert np.allclose(found[:, 3:], values[:, 3:])
    assert np.allclose(machine.forward(found)[0], tip, atol=1e-11)


UP = np.array([[0.0, 0.0, 1.0]])
HERE = np.zeros((1, 3))


def parallel():
    return Machine("m", (*XYZ, rotary("B", (0.0, 1.0, 0.0)), rotary("D", (0.0, 1.0, 0.0))), ())


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: inverse_pose(cradle(), HERE, UP),
            "machine cradle has 4 slides and 5 rotary axes; to set a tip and a tool axis it needs 3 slides and 2",
        ),
        (
            lambda: inverse_frame(head_head_cb(), np.eye(3)[None], HERE),
            "head-head-cb has 3 slides and 2 rotary axes; to set a full tool frame it needs 3 slides and 3 rotary",
        ),
        (lambda: inverse_pose(parallel(), HERE, UP), "rotary axes B and D cannot tilt the tool any way"),
        (
            lambda: inverse_pose(
                Machine("m", (*XYZ, rotary("B", (0.0, 1.0, 0.0)), rotary("C", (0.0, 0.0, 1.0))), ()), HERE, UP
            ),
            "rotary axes B and C cannot tilt",
        ),
        (
            lambda: inverse_pose(
                replace(star(), tool_mount=replace(star().tool_mount, translation=np.ones(3))), HERE, UP
            ),
            "rotary axis D is not the tool's own axis",
        ),
        (lambda: inverse_pose(head_b_table_c(), HERE, 2.0 * UP), "point 1: the tool axis must have length 1, not 2"),
        (lambda: inverse_pose(head_b_table_c(), HERE, np.nan * UP), "must have length 1, not nan"),
        (
            lambda: inverse_pose(star(), np.zeros((2, 3)), star().forward(star().values(B=[0.3, radians(90.0)]))[1]),
            "point 2: its rotary axes turn the slides into one plane",
        ),
    ],
)
def test_what_a_machine_cannot_do_is_said(call, message):
    with pytest.raises(InputError, match=message):
        call()
