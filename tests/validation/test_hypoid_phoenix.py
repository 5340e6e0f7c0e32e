"""Litvin and Chen 1994, sections 1 to 3: hypoid pinion settings carried to the Phoenix and the Star.

Their matrices and equations (1)-(19) are written out here from the report and held against the cradle generator,
the catalogue's machines and finite differences. Their pinion axis x_p is the gear's z here, their z_p its -x;
their z_t points from the head into the pinion, the tool's axis away from it. The report prints no settings:
the pinion of tests/surfaces/test_hypoid.py is an assumption.
"""

from __future__ import annotations

import numpy as np
import pytest

from gearsim.cutters.catalogue import conical
from gearsim.envelope.machined import machined_along
from gearsim.machines.catalogue import head_b_table_c, phoenix, star
from gearsim.metrology.deviation import measure
from gearsim.metrology.samples import sample_grid
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CurveMotion
from gearsim.simulation.removal import cut as remove
from gearsim.toolpaths.roll import roll_axes, roll_motion
from tests.helpers import observed_order
from tests.surfaces.test_hypoid import SETTINGS, least_distance, make_generator, make_pinion, rolled

GEAR_TO_REPORT = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
X_E = 120.0
PHI_P = np.radians(np.linspace(-65.0, 65.0, 27))
ALPHA = {"concave": SETTINGS["outer_angle"], "convex": -SETTINGS["inner_angle"]}
R_C = {
    "concave": SETTINGS["head_radius"] + 0.5 * SETTINGS["point_width"],
    "convex": SETTINGS["head_radius"] - 0.5 * SETTINGS["point_width"],
}
TILT, SWIVEL, GAMMA = (SETTINGS[k] for k in ("tilt", "swivel", "machine_root_angle"))
LEAST_AND_MOST_MOVED = {"concave": (26.87, 31.85), "convex": (8.04, 19.27)}
M_CP = 1.0 / SETTINGS["ratio"]
E_M, DELTA_B, DELTA_A, S_R = (SETTINGS[k] for k in ("offset", "sliding_base", "centre_to_back", "radial"))


def rx(a):
    return stack([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])


def ry(a):
    return stack([[np.cos(a), 0, np.sin(a)], [0, 1, 0], [-np.sin(a), 0, np.cos(a)]])


def rz(a):
    return stack([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])


def stack(rows):
    """Matrices (n, 3, 3) from rows of scalars and arrays (n,)."""
    entries = np.broadcast_arrays(*(np.asarray(entry, dtype=float) for row in rows for entry in row))
    return np.stack(entries, axis=-1).reshape(*entries[0].shape, 3, 3)


def homogeneous(rotation, translation):
    m = np.zeros((*rotation.shape[:-2], 4, 4))
    m[..., :3, :3], m[..., :3, 3], m[..., 3, 3] = rotation, translation, 1.0
    return m


def cradle(phi_p):
    return SETTINGS["cradle"] + M_CP * np.asarray(phi_p)


def m_ot(phi_p):
    """M_oc M_cb M_bt of (9)."""
    q, nil = cradle(phi_p), 0.0 * np.asarray(phi_p)
    m_cb = homogeneous(rz(SWIVEL + 0.5 * np.pi + nil), np.array([S_R, 0.0, 0.0]))
    return homogeneous(rz(-q), 0.0) @ m_cb @ homogeneous(ry(TILT + nil), 0.0)


def m_pt(phi_p):
    """The whole chain of (9)."""
    nil = 0.0 * np.asarray(phi_p)
    m_no = homogeneous(rx(nil), np.array([0.0, E_M, -DELTA_B]))
    m_qn = homogeneous(ry(GAMMA + nil), np.array([-DELTA_A, 0.0, 0.0]))
    return homogeneous(rx(np.asarray(phi_p)), 0.0) @ m_qn @ m_no @ m_ot(phi_p)


def coefficients(phi_p):
    """a_kl of (14), shape (n, 3, 3)."""
    d, p = cradle(phi_p) - SWIVEL, np.asarray(phi_p)
    s, c, si, ci, sg, cg, sp, cp = (
        np.sin(d), np.cos(d), np.sin(TILT), np.cos(TILT), np.sin(GAMMA), np.cos(GAMMA), np.sin(p), np.cos(p)
    )  # fmt: skip
    return stack(
        [
            [ci * cg * s - si * sg, -c * cg, si * cg * s + ci * sg],
            [
                ci * sg * sp * s + ci * c * cp + si * cg * sp,
                -c * sg * sp + s * cp,
                si * sg * sp * s + si * c * cp - ci * cg * sp,
            ],
            [
                -ci * sg * cp * s + ci * c * sp - si * cg * cp,
                sg * cp * c + s * sp,
                -si * sg * s * cp + si * c * sp + ci * cg * cp,
            ],
        ]
    )


def head_centre(phi_p):
    """a_14, a_24, a_34 of (15), without the 1 that the print puts inside the minus sign."""
    q, p = cradle(phi_p), np.asarray(phi_p)
    sg, cg, sp, cp = np.sin(GAMMA), np.cos(GAMMA), np.sin(p), np.cos(p)
    return np.stack(
        [
            S_R * np.cos(q) * cg - DELTA_B * sg - DELTA_A,
            -S_R * (np.sin(q) * cp - np.cos(q) * sg * sp) + E_M * cp + DELTA_B * cg * sp,
            -S_R * (np.sin(q) * sp + np.cos(q) * sg * cp) + E_M * sp - DELTA_B * cg * cp,
        ],
        -1,
    )


def cone_point(side, s, theta):
    """(7): points of the blade's cone in S_t, shape (n, 4)."""
    alpha, r = ALPHA[side], R_C[side] + s * np.sin(ALPHA[side])
    return np.stack([r * np.cos(theta), r * np.sin(theta), -s * np.cos(alpha), np.ones_like(r)], -1)


def cone_normal(side, theta):
    """(8): unit normals in S_t, shape (n, 3)."""
    a = ALPHA[side]
    return np.stack([-np.cos(a) * np.cos(theta), -np.cos(a) * np.sin(theta), np.full_like(theta, -np.sin(a))], -1)


def meshing(side, s, theta, phi_p, sign=-1.0, gamma=GAMMA):
    """f of (10); ``sign`` -1 as derived, +1 as printed; the print writes gamma for gamma_m."""
    m = m_ot(phi_p)
    normal = np.einsum("nij,nj->ni", m[:, :3, :3], cone_normal(side, theta))
    r = np.einsum("nij,nj->ni", m, cone_point(side, s, theta))[:, :3]
    omega_p, omega_c = -np.array([np.cos(gamma), 0.0, np.sin(gamma)]), -np.array([0.0, 0.0, M_CP])
    velocity = np.cross(omega_c - omega_p, r) + sign * np.cross([0.0, -E_M, DELTA_B], omega_p)
    return np.einsum("ni,ni->n", normal, velocity)


def on_the_blade(side):
    """s, theta and phi_p of a grid of points on the pinion's closed-form flank."""
    patch = make_pinion().flank(side)
    u, v = (a.ravel() for a in patch.locate(*np.meshgrid(np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 5))))
    phi_p = -patch.pose_parameter(u, v) / M_CP
    m, point = m_pt(phi_p), patch.jet(u, v).r @ GEAR_TO_REPORT.T
    x, y, z = np.einsum("nji,nj->ni", m[:, :3, :3], point - m[:, :3, 3]).T
    return -z / np.cos(ALPHA[side]), np.arctan2(y, x), phi_p


def solved_s(side, theta, phi_p, **print_choices):
    """s from (10), which is linear in it."""
    zero, one = (meshing(side, np.full_like(theta, s), theta, phi_p, **print_choices) for s in (0.0, 1.0))
    return zero / (zero - one)


def phoenix_angles(a):
    """(16)-(18): phi, psi, mu from the coefficients; of the two phi the one within 90 degrees."""
    phi = np.arcsin(a[:, 0, 2])
    return phi, np.arctan2(a[:, 1, 2], a[:, 2, 2]), np.arctan2(-a[:, 0, 1], a[:, 0, 0])


def phoenix_slides(centre, phi, psi):
    """x, y, z of (19): three linear equations, with (6) for the Phoenix and (15) for the generator."""
    c, s, cp, sp, nil = np.cos(phi), np.sin(phi), np.cos(psi), np.sin(psi), 0.0 * phi
    matrix = stack([[c, nil, s], [-s * sp, cp, c * sp], [-s * cp, -sp, c * cp]])
    return np.linalg.solve(matrix, (centre + np.array([X_E, 0.0, 0.0]))[..., None])[..., 0]


def points(rng, side, n=200):
    """Random points of a blade's cone at random rolls."""
    return rng.uniform(0.0, 9.0, n), rng.uniform(0.5, 1.3, n), rng.uniform(-1.0, 1.0, n)


def test_the_cradle_generator_is_the_report_s_9():
    """S_c turns -q about z_o and S_p turns -phi_p: cradle angle -theta_c, cradle and work rotation negative."""
    m = m_pt(PHI_P)
    frames = make_generator().frames(-M_CP * PHI_P, 0)
    into_pinion, x = -frames.axis.value, frames.radial.value
    found = np.stack([x, np.cross(into_pinion, x), into_pinion], -1)
    assert np.allclose(GEAR_TO_REPORT @ found, m[:, :3, :3], atol=1e-14)
    assert np.allclose(frames.tip.value @ GEAR_TO_REPORT.T, m[:, :3, 3], atol=1e-12)


def test_14_and_15_are_the_product_of_9():
    m = m_pt(PHI_P)
    assert np.allclose(coefficients(PHI_P), m[:, :3, :3], atol=1e-14)
    assert np.allclose(head_centre(PHI_P), m[:, :3, 3], atol=1e-12)


@pytest.mark.parametrize("side", ["concave", "convex"])
def test_8_points_to_the_cutter_axis_for_either_sign_of_alpha(rng, side):
    s, theta, _ = points(rng, side)
    h = 1e-5
    along = (cone_point(side, s + h, theta) - cone_point(side, s - h, theta))[:, :3]
    around = (cone_point(side, s, theta + h) - cone_point(side, s, theta - h))[:, :3]
    normal = cone_normal(side, theta)
    assert np.abs(np.einsum("ni,ni->n", normal, along)).max() < 1e-9
    assert np.abs(np.einsum("ni,ni->n", normal, around)).max() < 1e-9
    assert np.all(normal[:, 0] * np.cos(theta) + normal[:, 1] * np.sin(theta) < 0.0)


@pytest.mark.parametrize("side", ["concave", "convex"])
def test_10_is_the_relative_velocity_only_with_the_sign_turned(rng, side):
    """n . dr_p/dphi_p at a fixed tool point by central differences, in the pinion frame."""
    s, theta, phi = points(rng, side)
    h = 1e-5
    moved = [np.einsum("nij,nj->ni", m_pt(phi + k * h), cone_point(side, s, theta))[:, :3] for k in (1, -1)]
    normal = np.einsum("nij,nj->ni", m_pt(phi)[:, :3, :3], cone_normal(side, theta))
    rate = np.einsum("ni,ni->n", normal, moved[0] - moved[1]) / (2.0 * h)
    assert np.abs(meshing(side, s, theta, phi) - rate).max() < 1e-6
    assert np.abs(meshing(side, s, theta, phi, sign=1.0) - rate).max() > 10.0


@pytest.mark.parametrize("side", ["concave", "convex"])
def test_9_and_10_give_the_flank_of_the_closed_form(side):
    """The flank's points, seen by the head, lie at the s that (10) says.

    The printed sign moves s by 26.9 to 31.8 mm (concave) and 8.0 to 19.3 mm (convex) on this pinion; its
    gamma, unless it is gamma_m, by 20 mm or more.
    """
    s, theta, phi = on_the_blade(side)
    assert np.abs(solved_s(side, theta, phi) - s).max() < 1e-10
    least, most = LEAST_AND_MOST_MOVED[side]
    moved = np.abs(solved_s(side, theta, phi, sign=1.0) - s)
    assert np.isclose(moved.min(), least, atol=0.05)
    assert np.isclose(moved.max(), most, atol=0.05)
    moved = np.abs(solved_s(side, theta, phi, gamma=make_pinion().blank.pitch) - s)
    assert moved.min() > 20.0


def test_16_to_18_give_the_whole_orientation_3():
    a = coefficients(PHI_P)
    phi, psi, mu = phoenix_angles(a)
    assert np.allclose(rx(-psi) @ ry(phi) @ rz(mu), a, atol=1e-14)
    nil = 0.0 * phi
    printed = stack(
        [
            [np.cos(mu) * np.cos(phi), -np.sin(mu) * np.cos(phi), np.sin(phi)],
            [
                -np.cos(mu) * np.sin(phi) * np.sin(psi) + np.sin(mu) * np.cos(psi),
                np.sin(mu) * np.sin(phi) * np.sin(psi) + np.cos(mu) * np.cos(psi),
                np.cos(phi) * np.sin(psi),
            ],
            [
                -np.cos(mu) * np.sin(phi) * np.cos(psi) - np.sin(mu) * np.sin(psi),
                np.sin(mu) * np.sin(phi) * np.cos(psi) - np.cos(mu) * np.sin(psi),
                np.cos(phi) * np.cos(psi) + nil,
            ],
        ]
    )
    assert np.allclose(rx(-psi) @ ry(phi) @ rz(mu), printed, atol=1e-14)


def test_14_turns_as_fast_as_the_velocities_of_10_say():
    """dL_pt/dphi_p L_pt^T, by central differences, is the relative angular velocity's matrix in S_p."""
    h = 1e-5
    rate = (coefficients(PHI_P + h) - coefficients(PHI_P - h)) / (2.0 * h)
    spin = rate @ coefficients(PHI_P).swapaxes(-1, -2)
    omega = np.array([np.cos(GAMMA), 0.0, np.sin(GAMMA) - M_CP])
    into_pinion = m_pt(PHI_P)[:, :3, :3] @ m_ot(PHI_P)[:, :3, :3].swapaxes(-1, -2)
    w = into_pinion @ omega
    found = np.stack([spin[:, 2, 1], spin[:, 0, 2], spin[:, 1, 0]], -1)
    assert np.abs(found - w).max() < 1e-9


def report_path(machine_name):
    """Axis values by the report's formulas: Phoenix (16)-(19); for the Star the signs chosen in the errata."""
    a, centre = coefficients(PHI_P), head_centre(PHI_P)
    if machine_name == "phoenix":
        phi, psi, mu = (np.unwrap(x) for x in phoenix_angles(a))
        return np.column_stack([phoenix_slides(centre, phi, psi), -psi, phi, mu])
    star_tool = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    l_pt = a @ star_tool.T
    phi = np.arccos(l_pt[:, 0, 0])
    psi = np.unwrap(np.arctan2(-l_pt[:, 1, 0], -l_pt[:, 2, 0]))
    turned = rx(psi) @ l_pt
    mu = np.unwrap(np.arctan2(-turned[:, 1, 2], turned[:, 1, 1]))
    x, y, z = np.einsum("nij,nj->ni", rx(psi), centre).T
    z = z / np.cos(phi)
    return np.column_stack([x - z * np.sin(phi), y, z, -psi, phi, mu])


MACHINES = {"phoenix": phoenix(X_E), "star": star()}


def table(name, rows, start, end, **options):
    near = None if not options.get("with_turn", True) else report_path(name)[np.argmin(np.abs(PHI_P + start / M_CP))]
    return roll_axes(MACHINES[name], make_generator().frames, start, end, rows, near=near, **options)


@pytest.mark.parametrize("name", ["phoenix", "star"])
def test_the_table_is_the_report_s_and_brings_the_head_to_its_frame(name):
    """Equations (16)-(19) against the machine's chain and inverse; mu is carried."""
    start, end = -M_CP * PHI_P[[0, -1]]
    path = table(name, len(PHI_P), start, end)
    assert not path.messages()
    assert np.allclose(path.values, report_path(name), atol=1e-10)
    frames = make_generator().frames(-M_CP * PHI_P, 0)
    for made, wanted in zip(MACHINES[name].frame_series(MACHINES[name].constant(path.values)), frames, strict=True):
        assert np.abs(made.value - wanted.value).max() < 1e-10


def test_a_head_that_is_a_body_of_revolution_needs_no_turn():
    still = table("phoenix", 15, -0.2, 0.2, with_turn=False)
    five = roll_axes(head_b_table_c(), make_generator().frames, -0.2, 0.2, 15, with_turn=False)
    pose = make_generator().poses(np.linspace(-0.2, 0.2, 15), 0)
    assert np.all(still.values[:, MACHINES["phoenix"].axes.index("C")] == 0.0)
    for path in (still, five):
        for made, wanted in zip(path.machine.forward(path.values), pose, strict=True):
            assert np.abs(made - wanted.value).max() < 1e-10


def interpolated(name, values, start, end):
    """Poses of a table run linearly, by the report's matrices alone, as a function of the cradle angle."""
    roll = np.linspace(start, end, len(values))

    def poses(phi):
        x, y, z, a, b, _ = (np.interp(phi, roll, column) for column in values.T)
        if name == "phoenix":
            l_pm = rx(a) @ ry(b)
            tip, into = np.einsum("nij,nj->ni", l_pm, np.stack([x, y, z], -1)) - [X_E, 0.0, 0.0], l_pm[..., 2]
        else:
            lifted = np.einsum("nij,nj->ni", ry(b), np.stack([0.0 * x, y, z], -1)) + np.stack([x, 0.0 * x, 0.0 * x], -1)
            tip, into = np.einsum("nij,nj->ni", rx(a), lifted), (rx(a) @ ry(b))[..., 0]
        return tip @ GEAR_TO_REPORT, -into @ GEAR_TO_REPORT

    return poses


@pytest.mark.parametrize("name", ["phoenix", "star"])
@pytest.mark.parametrize("side", ["concave", "convex"])
def test_what_linear_axes_between_rows_cost(name, side):
    """Brute force: deviation of the flank cut from N rows; it falls by the second order of the step.

    The concave flank is overcut, the convex one is left standing: 33 rows for 33 deg of cradle cost 0.9 to
    3.5 um and 0 to 2.6 um on the Phoenix, 0.9 to 3.5 um and 0 to 2.8 um on the Star.
    """
    pinion = make_pinion()
    start, end = pinion.cut(side).motion_range
    grid = sample_grid(pinion.flank(side), 5, 7)
    errors, rows = [], np.array([9, 17, 33, 65, 129])
    for n in rows:
        values = table(name, n, start, end).values
        deviation, _ = least_distance(interpolated(name, values, start, end), (start, end), grid.point.reshape(-1, 3))
        errors.append(np.abs(deviation).max())
        assert np.all((deviation < 0.0) if side == "concave" else (deviation > -1e-9))
    assert 1.9 < observed_order(errors, 1.0 / (rows - 1)) < 2.1
    assert 2e-3 < errors[2] < 4e-3


def outside_blades():
    """A solid of the head's outside: it cuts the concave flank as the ring does."""
    angle, e = SETTINGS["outer_angle"], SETTINGS["edge_radius"]
    return conical(R_C["concave"] - e * (1.0 - np.sin(angle)) / np.cos(angle), e, angle, SETTINGS["blade_height"])


@pytest.mark.parametrize("side", ["concave", "convex"])
def test_both_roads_and_brute_force_see_one_surface(side):
    """The exact motion leaves the closed form to the nanometre; of 33 rows all see the same deviations.

    The removal road cuts the concave flank with a solid of the outside blades.
    """
    pinion = make_pinion()
    cut = pinion.cut(side)
    start, end = cut.motion_range
    rays = sample_grid(pinion.flank(side), 5, 7, margin=0.01).rays()
    path = table("phoenix", 33, start, end)
    linear = roll_motion(path), interpolated("phoenix", path.values, start, end)
    for exact, (source, poses) in ((True, (CurveMotion(cut.poses, start, end), rolled(cut))), (False, linear)):
        found = machined_along(rays, [source], cut.head).deviation
        machined = rays.origin + found[:, None] * rays.direction
        assert np.abs(least_distance(poses, (start, end), machined)[0]).max() < 2e-9
        assert (np.abs(found).max() < 1e-9) == exact
        if side == "concave":
            tool = outside_blades()
            removed = remove(rays, compile_motion(source, tool.reach), tool).require_trust().removed
            assert np.abs(measure(rays, removed).value - found).max() < 1e-9
