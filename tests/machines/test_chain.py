from math import cos, pi, radians, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.geometry.series import Series
from gearsim.machines.catalogue import (
    MACHINES,
    cradle,
    head_b_table_a,
    head_head_cb,
    phoenix,
    star,
    table_table_ac,
    table_table_bc,
)
from gearsim.machines.chain import Joint, Machine, rotary, slide
from gearsim.machines.generator import CradleGenerator
from tests.machines.matrices import about, litvin_settings, shift, turn

# Litvin's S_p from the gear's frame (his x_p is its z, his z_p its -x), his S_t from the tool's.
S_P = np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
S_T = np.diag([1.0, -1, -1])
STAR_TOOL = np.array([[0.0, 0, 1], [1, 0, 0], [0, 1, 0]])


def frame_of(machine, **values):
    rotation, origin = machine.forward_frame(machine.values(**values))
    return rotation[0], origin[0]


def test_table_table_bc_is_groovers_chain_of_matrices():
    """Part to machine (3.40 to 3.47), with rotations only for directions (errata, 3.47c,d)."""
    b, c, lx, lz = 0.4, -1.1, 7.0, -120.0
    h1 = np.array([[cos(c), sin(c), 0, 0], [-sin(c), cos(c), 0, 0], [0, 0, 1, 0], [0, 0, 0, 1.0]])
    h2 = shift(-lx, 0, -lz)
    h3 = np.array([[cos(b), 0, -sin(b), 0], [0, 1, 0, 0], [sin(b), 0, cos(b), 0], [0, 0, 0, 1.0]])
    part_to_machine = shift(lx, 0, lz) @ h3 @ h2 @ h1
    point = np.array([31.0, -12.0, 55.0])
    x, y, z, _ = part_to_machine @ [*point, 1.0]
    machine = table_table_bc(pivot=(lx, 0.0, lz))
    tip, axis = machine.forward(machine.values(X=x, Y=y, Z=z, B=b, C=c))
    assert np.allclose(tip[0], point, atol=1e-12)
    assert np.allclose((part_to_machine @ [*axis[0], 0.0])[:3], [0, 0, 1], atol=1e-14)


def test_a_turned_table_moves_the_other_way():
    """ISO 841: C+ turns the table clockwise seen from above, and +90 deg brings its +x side to -y."""
    machine = table_table_bc()
    tip, _ = machine.forward(machine.values(X=0.0, Y=-30.0, C=pi / 2))
    assert np.allclose(tip, [[30.0, 0.0, 0.0]], atol=1e-13)


@pytest.mark.parametrize(
    ("machine", "first", "second"),
    [
        (table_table_bc((3.0, 1.0, -90.0), (5.0, -2.0, 0.0)), ("z", "C", (5, -2, 0)), ("y", "B", (3, 1, -90))),
        (table_table_ac((3.0, 1.0, -90.0), (5.0, -2.0, 0.0)), ("z", "C", (5, -2, 0)), ("x", "A", (3, 1, -90))),
    ],
)
def test_tilting_tables_turn_about_their_centres(machine, first, second):
    angles = {first[1]: 0.7, second[1]: -0.3}
    m = about(first[0], angles[first[1]], first[2]) @ about(second[0], angles[second[1]], second[2]) @ shift(10, 20, 30)
    rotation, origin = frame_of(machine, X=10, Y=20, Z=30, **angles)
    assert np.allclose(rotation, m[:3, :3], atol=1e-14)
    assert np.allclose(origin, m[:3, 3], atol=1e-12)


def test_head_head_cb_points_as_zhou_says_about_its_pivot():
    b, c, length = 0.6, -2.0, 150.0
    tip, axis = head_head_cb(length).forward(head_head_cb(length).values(X=1, Y=2, Z=3, B=b, C=c))
    expected = np.array([sin(b) * cos(c), sin(b) * sin(c), cos(b)])  # Zhou 4.14
    assert np.allclose(axis, expected, atol=1e-15)
    assert np.allclose(tip, np.array([1, 2, 3 + length]) - length * expected, atol=1e-12)


def test_head_over_table_turns_each_about_its_own_centre():
    a, b, length, centre = 0.8, -0.5, 180.0, (0.0, 4.0, -60.0)
    machine = head_b_table_a(length, centre)
    m = about("x", a, centre) @ shift(10, 20, 30) @ about("y", b, (0, 0, length))
    rotation, origin = frame_of(machine, X=10, Y=20, Z=30, A=a, B=b)
    assert np.allclose(rotation, m[:3, :3], atol=1e-14)
    assert np.allclose(origin, m[:3, 3], atol=1e-12)


def test_phoenix_is_litvins_matrix_and_position():
    """(3) and (6), typed out."""
    mu, phi, psi, x, y, z, x_e = 0.3, -0.7, 1.9, 40.0, -25.0, 310.0, 120.0
    cm, sm, cf, sf, cs, ss = cos(mu), sin(mu), cos(phi), sin(phi), cos(psi), sin(psi)
    l_pt = [
        [cm * cf, -sm * cf, sf],
        [-cm * sf * ss + sm * cs, sm * sf * ss + cm * cs, cf * ss],
        [-cm * sf * cs - sm * ss, sm * sf * cs - cm * ss, cf * cs],
    ]
    o_t_o_p = [
        x_e - x * cf - z * sf,
        x * sf * ss - y * cs - z * cf * ss,
        x * sf * cs + y * ss - z * cf * cs,
    ]
    rotation, origin = frame_of(phoenix(x_e), X=x, Y=y, Z=z, A=-psi, B=phi, C=mu)
    assert np.allclose(S_P @ rotation @ S_T, l_pt, atol=1e-14)
    assert np.allclose(S_P @ origin, -np.array(o_t_o_p), atol=1e-12)


def test_star_is_the_errata_matrix_and_position():
    mu, phi, psi, x, y, z = 0.3, -0.7, 1.9, 40.0, -25.0, 310.0
    l_pt = (turn("x", -psi) @ turn("y", phi) @ turn("x", mu))[:3, :3]
    place = turn("x", -psi)[:3, :3] @ (np.array([x, 0, 0]) + turn("y", phi)[:3, :3] @ [0, y, z])
    rotation, origin = frame_of(star(), X=x, Y=y, Z=z, A=-psi, B=phi, D=mu)
    assert np.allclose(S_P @ rotation @ S_T @ STAR_TOOL.T, l_pt, atol=1e-14)
    assert np.allclose(S_P @ origin, place, atol=1e-12)


SETTINGS = {"swivel": radians(-31.0), "tilt": radians(18.0), "sliding_base": 14.0, "blank_offset": 33.0}


def test_cradle_is_the_generator():
    g = CradleGenerator(71.0, 1.06, -0.05, 3.2, machine_centre_to_back=-1.2, modified_roll=(0.03, -0.02), **SETTINGS)
    phi = np.linspace(-0.4, 0.3, 5)
    machine = cradle()
    values = machine.values(
        radial_distance=71.0, machine_root_angle=-0.05, machine_centre_to_back=-1.2, cradle_angle=1.06 + phi,
        work_angle=g.work_angle(Series.variable(phi, 0)).value, **SETTINGS,
    )  # fmt: skip
    ours = machine.frame_series(machine.constant(values))
    for a, b in zip(ours, g.frames(phi, 0), strict=True):
        assert np.allclose(a.value, b.value, atol=1e-12)


def test_cradle_is_litvins_generator():
    """(14) and (15) typed out; his cradle and pinion turn the other way (theta_c = -cradle angle)."""
    i, j, q, phi_p, gamma = 0.3, -0.5, 0.9, 0.4, -0.1
    rotation, origin = litvin_settings(i, j, q, phi_p, gamma, 71.0, 33.0, 14.0, -1.2)
    ours = frame_of(
        cradle(), radial_distance=71.0, sliding_base=14.0, blank_offset=33.0, machine_centre_to_back=-1.2,
        cradle_angle=-q, swivel=j, tilt=i, machine_root_angle=gamma, work_angle=-phi_p,
    )  # fmt: skip
    assert np.allclose(S_P @ ours[0] @ S_T, rotation, atol=1e-14)
    assert np.allclose(S_P @ ours[1], origin, atol=1e-12)


@pytest.mark.parametrize("name", MACHINES)
def test_series_are_the_motions_taylor_expansion(name, rng):
    """Quadratic axis motions: the series of order 10, summed 0.1 further on, is the pose there."""
    machine = MACHINES[name]()
    scale = np.array([1.0 if joint.is_rotary else 50.0 for joint in machine.joints])
    a, b, c = (scale * rng.normal(size=len(scale)) for _ in range(3))
    t, step = np.array([-0.3, 0.2]), 0.05
    time = Series.variable(t, 10)
    here = machine.frame_series([time * time * c[k] + time * b[k] + a[k] for k in range(len(scale))])
    later = t[:, None] + step
    there = machine.frame_series(machine.constant(a + b * later + c * later**2))
    for series, value in zip(here, there, strict=True):
        summed = np.einsum("k,kij->ij", step ** np.arange(11), series.c)
        assert np.allclose(summed, value.value, atol=1e-9)


@given(st.sampled_from(sorted(MACHINES)), st.integers(0, 10_000))
@settings(max_examples=60, deadline=None)
def test_every_joint_moves_rigidly_along_its_own_line(name, seed):
    """A step of one axis is a screw of that size: its trace and its fixed line say so."""
    machine, rng = MACHINES[name](), np.random.default_rng(seed)
    values = rng.normal(size=(1, len(machine.axes)))
    k = int(rng.integers(len(machine.axes)))
    moved = values.copy()
    moved[0, k] += 0.3
    (r1, o1), (r2, o2) = machine.forward_frame(values), machine.forward_frame(moved)
    step = r2[0] @ r1[0].T
    assert np.allclose(r1[0].T @ r1[0], np.eye(3), atol=1e-13)
    assert np.linalg.det(r1[0]) == pytest.approx(1.0, abs=1e-12)
    if machine.joints[k].is_rotary:
        assert (np.trace(step) - 1.0) / 2.0 == pytest.approx(cos(0.3), abs=1e-12)
    else:
        assert np.allclose(step, np.eye(3), atol=1e-13)
        assert np.linalg.norm(o2 - o1) == pytest.approx(0.3, abs=1e-10)


def test_slide_directions_are_what_a_slide_moves_the_tip_by(rng):
    for machine in (star(), table_table_ac(), phoenix()):
        values = rng.normal(size=(4, len(machine.axes)))
        directions = machine.slide_directions(values)
        for i in range(3):
            moved = values.copy()
            moved[:, i] += 10.0
            difference = (machine.forward(moved)[0] - machine.forward(values)[0]) / 10.0
            assert np.allclose(directions[:, :, i], difference, atol=1e-12)


def test_axes_stand_in_one_order_and_values_go_by_name():
    machine = head_head_cb()
    assert machine.axes == ("X", "Y", "Z", "B", "C")
    values = machine.values(C=[0.1, 0.2], X=5.0)
    assert np.allclose(values, [[5, 0, 0, 0, 0.1], [5, 0, 0, 0, 0.2]])
    limited = machine.limited(B=(-0.5, 1.5))
    assert [j.lower for j in limited.joints if j.name == "B"] == [-0.5]
    assert [j.name for j in limited.tool] == [j.name for j in machine.tool]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: slide("X", (1.0, 1.0, 0.0)), "axis X: its direction must have length 1, not 1.41421"),
        (lambda: Joint("B", "revolute", (0.0, 1.0, 0.0), lower=1.0, upper=1.0), "axis B: lower limit 1 must be below"),
        (
            lambda: Machine("m", (slide("X", (1.0, 0.0, 0.0)), rotary("X", (0.0, 0.0, 1.0))), ()),
            "axis names must differ",
        ),
        (lambda: head_head_cb().values(A=1.0), "machine head-head-cb has no axis A; it has X, Y, Z, B, C"),
        (lambda: head_head_cb().limited(Q=(0.0, 1.0)), "has no axis Q"),
        (lambda: head_head_cb().forward(np.zeros((3, 6))), r"shape \(n, 5\) for X, Y, Z, B, C, got shape \(3, 6\)"),
        (lambda: head_head_cb().forward(np.zeros(5)), r"got shape \(5,\)"),
    ],
)
def test_mistakes_are_named(make, message):
    with pytest.raises(InputError, match=message):
        make()
