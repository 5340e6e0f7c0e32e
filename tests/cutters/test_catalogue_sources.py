"""Cutters of the catalogue against the formulas of their sources, and against each other."""

from math import cos, pi, radians, sin, tan

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gearsim.cutters.catalogue import (
    CUTTERS,
    apt,
    ball,
    bull,
    conical,
    face_mill_head,
    flat,
    grinding_cone,
    tapered_ball,
    zhou_apt,
)
from tests.cutters.constructions import DEG, HEAD


def effective(p):
    """Effective radius, height of the effective centre, cosine of the effective angle."""
    rho = p.r / p.nr
    return rho, p.z - rho * p.nz, p.nz


def test_zhous_apt_cutter_follows_his_formulas_as_corrected():
    """4.1, 4.2 with its errata, 4.3; the printed radius of 4.2 is millimetres off, its range of phi a single point."""
    height, R_l, R_t, psi_u, psi_l = 45.0, 10.0, 3.0, 10 * DEG, 12 * DEG
    lower, corner, upper, _ = zhou_apt(height, R_l, R_t, psi_u, psi_l).elements
    rho, h, cosine = effective(lower.at(np.linspace(0.1, 1.0, 9) * lower.length))
    assert np.allclose(rho, h * cos(psi_l), atol=1e-12)
    assert np.allclose(cosine, cos(pi - psi_l), atol=1e-12)
    assert h[-1] == pytest.approx((R_l + R_t * sin(psi_l)) / cos(psi_l) / sin(psi_l), abs=1e-12)
    H2 = R_l * (tan(psi_l) + tan(psi_u)) + R_t / cos(psi_l)
    rho, h, cosine = effective(corner.at(np.linspace(0.0, 1.0, 9) * corner.length))
    phi = pi - np.arccos(cosine)
    assert (phi[0], phi[-1]) == pytest.approx((psi_l, 0.5 * pi - psi_u), abs=1e-12)
    assert np.allclose(rho, R_l / np.sin(phi) + R_t, atol=1e-11)
    assert np.allclose(h, H2 + R_l * (1.0 / np.tan(phi) - tan(psi_u)), atol=1e-11)
    assert np.abs(rho - (R_l + R_t / np.sin(phi))).max() > 7.0
    rho, h, cosine = effective(upper.at(np.linspace(0.0, 1.0, 9) * upper.length))
    assert np.allclose(rho, (R_l + R_t * cos(psi_u)) / cos(psi_u) + (h - H2) * sin(psi_u), atol=1e-11)
    assert np.allclose(cosine, cos(0.5 * pi + psi_u), atol=1e-12)
    rest = height - R_t * (1 / cos(psi_l) - sin(psi_u)) - R_l * tan(psi_l)
    H3 = height + (R_l + R_t * cos(psi_u) + rest * tan(psi_u)) * tan(psi_u)
    assert (h[0], h[-1]) == pytest.approx((H2, H3), abs=1e-11)


def test_conical_cutter_has_the_heights_and_radii_of_the_source():
    """Zhou 4.19 at table 4.1: h of the flank's first effective centre and its effective radius.

    |o_c q_f| = R1 tan a + R2 and rho = R1 sec a + R2 (the general machinery knows neither).
    """
    r1, r2, a = 1.0, 1.5, radians(15.0)
    cutter = conical(r1, r2, a, 25.0)
    rho, h, _ = effective(cutter.elements[cutter.flank].at(np.array(0.0)))
    assert rho == pytest.approx(r1 / cos(a) + r2, abs=1e-12)
    assert h == pytest.approx(r1 * tan(a) + r2, abs=1e-12)


def test_the_corner_of_the_source_follows_the_repaired_formula():
    """Zhou 4.21 with its erratum: h(b) = R1 cot b + R2, rho(b) = R1 csc b + R2, b the normal's angle to -l."""
    r1, r2, a = 1.0, 1.5, radians(15.0)
    corner = conical(r1, r2, a, 25.0).elements[1]
    rho, h, cosine = effective(corner.at(np.linspace(0.05, corner.length, 9)))
    b = np.arccos(-cosine)
    assert np.allclose(rho, r1 / np.sin(b) + r2, atol=1e-12)
    assert np.allclose(h, r1 / np.tan(b) + r2, atol=1e-12)
    printed = r1 / np.tan(b) + r2 * (1.0 - sin(a) + np.cos(b))
    assert np.abs(h - printed).max() > 0.9


def test_the_face_mill_head_follows_zhous_blade_formulas_as_corrected():
    """3.5, 3.6 with their errata: alpha = 90 deg +- a, rho = +-R(h) sin(alpha), R the flank's radius at height h."""
    radius, width, inner, outer, _, height = HEAD
    head = face_mill_head(*HEAD)
    assert head.is_ring
    kinds = ["arc" if e.is_arc else "flat" if e.is_flat else "line" for e in head.elements]
    assert kinds == ["flat", "arc", "line", "flat", "line", "arc"]
    for k, side, angle in ((2, 1.0, outer), (4, -1.0, inner)):
        e = head.elements[k]
        p = e.at(np.linspace(0.0, 1.0, 7) * e.length)
        rho, h, cosine = effective(p)
        blade = radius + side * (0.5 * width + h * tan(angle))
        assert np.allclose(cosine, -sin(angle), atol=1e-12)
        assert np.allclose(rho, side * blade * cos(angle), atol=1e-11)
        assert np.all(side * p.nr > 0.0)
        assert (p.z.max(), p.z.min()) == pytest.approx((height, 1.524 * (1.0 - sin(angle))), abs=1e-12)
    land = head.elements[0]
    assert land.length == pytest.approx(width - 2 * 1.524 * tan(radians(34.0)), abs=1e-12)
    assert land.start[0] < land.end[0]
    assert land.start[1] == land.end[1] == 0.0


def test_the_grinding_cone_is_litvins():
    """32, 33: r_t = u (sin g, 0, cos g) from the apex, n_t = (cos g, 0, -sin g)."""
    g, d, height = radians(30.0), 203.2, 30.0
    e = grinding_cone(d, g, height).elements[1]
    p = e.at(np.linspace(0.0, e.length, 5))
    u = p.r / sin(g)
    apex = height - 0.5 * d / tan(g)
    assert np.allclose(p.z - apex, u * cos(g), atol=1e-12)
    assert np.allclose([p.nr, p.nz], np.array([[cos(g)], [-sin(g)]]), atol=1e-12)


def test_one_tool_made_two_ways_is_the_same(rng):
    r, z = rng.uniform(0.0, 8.0, 500), rng.uniform(-2.0, 22.0, 500)
    for a, b in (
        (ball(6.0, 20.0), apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0)),
        (ball(6.0, 20.0), bull(6.0, 3.0, 20.0)),
        (flat(6.0, 20.0), bull(6.0, 0.0, 20.0)),
        (flat(30.0, 35.0), zhou_apt(35.0, 15.0, 0.0, 0.0, 0.0)),
        (tapered_ball(6.0, 0.1, 20.0), conical(0.0, 3.0, 0.1, 20.0)),
        (conical(1.0, 1.5, 0.2, 20.0), zhou_apt(20.0, 1.0, 1.5, 0.2, 0.0)),
        (CUTTERS["grinding_cone"](12.0, 0.3, 15.0), CUTTERS["tapered"](12.0 - 30.0 * tan(0.3), 0.3, 15.0)),
    ):
        assert np.allclose(a.signed_distance(r, z), b.signed_distance(r, z), atol=1e-12)


@given(st.floats(0.1, 20.0), st.floats(0.0, 5.0), st.floats(-0.6, 0.6), st.floats(0.0, 0.8))
def test_any_tangent_apt_cutter_is_convex_and_has_no_sharp_corner_but_tip_and_top(e, c, psi_u, psi_l):
    """A tangent corner leaves an edge only where there is no radius, at the top, and at the tip of the lower cone."""
    assume(c == 0.0 or c > 0.01)
    height = 60.0
    f = e * tan(psi_l) + c / cos(psi_l)
    assume(e + c * cos(psi_u) + (height - f + c * sin(psi_u)) * tan(psi_u) > 0.1)
    cutter = zhou_apt(height, e, c, psi_u, psi_l)
    assert cutter.is_convex
    assert len(cutter.edges) == (1 if c > 0.0 else 2)
