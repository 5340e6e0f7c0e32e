"""The report's matrices and equations held against the cradle generator, the closed form and finite differences.

Litvin and Chen 1994, as written out in hypoid_report.py.
"""

from __future__ import annotations

import numpy as np
import pytest

from tests.surfaces.test_hypoid import make_generator, make_pinion
from tests.validation.hypoid_report import (
    GAMMA,
    GEAR_TO_REPORT,
    LEAST_AND_MOST_MOVED,
    M_CP,
    PHI_P,
    coefficients,
    cone_normal,
    cone_point,
    head_centre,
    m_ot,
    m_pt,
    meshing,
    on_the_blade,
    phoenix_angles,
    rx,
    ry,
    rz,
    solved_s,
    stack,
)


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
