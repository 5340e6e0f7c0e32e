"""Litvin and Chen 1994, sections 1 to 3: hypoid pinion settings carried to the Phoenix and the Star.

Their matrices and equations (1)-(19), written out from the report. Their pinion axis x_p is the gear's z here, their
z_p its -x; their z_t points from the head into the pinion, the tool's axis away from it. The report prints no settings:
the pinion of tests/surfaces/test_hypoid.py is an assumption.
"""

from __future__ import annotations

import numpy as np

from tests.machines.matrices import litvin_settings
from tests.surfaces.test_hypoid import SETTINGS, make_pinion

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


def _typed_out(phi_p):
    """(14) and (15): a_kl, shape (3, 3, n), and a_14, a_24, a_34, without the 1 that the print puts in their minus."""
    return litvin_settings(TILT, SWIVEL, cradle(phi_p), np.asarray(phi_p), GAMMA, S_R, E_M, DELTA_B, DELTA_A)


def coefficients(phi_p):
    """a_kl of (14), shape (n, 3, 3)."""
    return np.moveaxis(_typed_out(phi_p)[0], (0, 1), (-2, -1))


def head_centre(phi_p):
    """a_14, a_24, a_34 of (15), shape (n, 3)."""
    return np.moveaxis(_typed_out(phi_p)[1], 0, -1)


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
