"""Every cutter of the catalogue against its own construction, written here as a point set (r, z)."""

from math import cos, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from gearsim.cutters import catalogue
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
from gearsim.errors import InputError


def below(z, height):
    return (z >= 0.0) & (z <= height)


def rounded(r, z, centre, radius, first, last):
    """Whether points are not in a corner beyond its arc; normals from ``first`` to ``last`` [rad], rising."""
    dr, dz = r - centre[0], z - centre[1]
    middle, half = 0.5 * (first + last), 0.5 * (last - first)
    in_corner = dr * cos(middle) + dz * sin(middle) > np.hypot(dr, dz) * cos(half)
    return ~in_corner | (np.hypot(dr, dz) <= radius)


def cylinder(r, z, diameter, height, c=0.0):
    return (r <= diameter / 2) & below(z, height) & rounded(r, z, (diameter / 2 - c, c), c, -pi / 2, 0.0)


def cone(r, z, tip, taper, height):
    return (r <= tip + z * tan(taper)) & below(z, height)


def in_apt(r, z, d, c, e, f, a, b, h):
    """Tangent corner."""
    lines = (z >= r * tan(a)) & (r <= d / 2 + (z - d / 2 * tan(a)) * tan(b)) & (z <= h)
    return lines & rounded(r, z, (e, f), c, a - pi / 2, -b)


def in_zhou(r, z, h, e, c, b, a):
    f = e * tan(a) + c / cos(a)
    lines = (z >= r * tan(a)) & ((r - e) * cos(b) - (z - f) * sin(b) <= c) & (z <= h)
    return lines & rounded(r, z, (e, f), c, a - pi / 2, -b)


def in_cut_apt(r, z):
    """d 10, r 3, e = f = 2.3: the circle cuts bottom and side, and takes the corner beyond the chord between."""
    floor, wall = 2.3 + sqrt(9.0 - 2.3**2), 2.3 - sqrt(9.0 - 2.7**2)
    beyond = (r - floor) * wall - z * (5.0 - floor) > 0.0
    return (r <= 5.0) & below(z, 20.0) & (~beyond | (np.hypot(r - 2.3, z - 2.3) <= 3.0))


def in_barrel(r, z, d, big, m, h, c):
    axis = d / 2 - big
    x = axis + sqrt((big - c) ** 2 - (m - c) ** 2)
    side = r <= axis + np.sqrt(np.maximum(big**2 - (z - m) ** 2, 0.0))
    return side & below(z, h) & rounded(r, z, (x, c), c, -pi / 2, np.arctan2(c - m, x - axis))


def in_oval(r, z, d, big, b, h):
    return in_barrel(r, z, d, big, b + sqrt((big - b) ** 2 - (big - d / 2) ** 2), h, b)


def in_lollipop(r, z, d, neck, h):
    return (np.hypot(r, z - d / 2) <= d / 2) | ((r <= neck / 2) & (z >= d / 2) & (z <= h))


def in_t_slot(r, z, d, t, neck, h, c):
    disc = cylinder(r, z, d, t, c) & rounded(r, z, (d / 2 - c, t - c), c, 0.0, pi / 2)
    return disc | ((r <= neck / 2) & below(z, h))


def in_dovetail(r, z, d, a, t, neck, h, c):
    e = d / 2 - c * tan(pi / 4 + a / 2)
    head = cone(r, z, d / 2, -a, t) & rounded(r, z, (e, c), c, -pi / 2, a)
    return head | ((r <= neck / 2) & below(z, h))


def in_grinding_cone(r, z, d, a, h, c):
    x = d / 2 - c * tan(pi / 4 + a / 2)
    return (r <= d / 2 - (h - z) * tan(a)) & below(z, h) & rounded(r, z, (x, h - c), c, -a, pi / 2)


def in_wheel(r, z, d, rim, a, depth, c):
    width, x = rim + 2 * depth * tan(a), d / 2 - c
    edge = depth * tan(a) + c * tan(pi / 4 - a / 2)
    flank = (d / 2 - r) * tan(a)
    inside = (r <= d / 2) & (z >= np.maximum(depth * tan(a) - flank, 0.0)) & below(z, width)
    inside &= width - z >= np.maximum(depth * tan(a) - flank, 0.0)
    if rim == 0.0:
        return inside & rounded(r, z, (d / 2 - c / cos(pi / 2 - a), width / 2), c, a - pi / 2, pi / 2 - a)
    return inside & rounded(r, z, (x, edge), c, a - pi / 2, 0.0) & rounded(r, z, (x, width - edge), c, 0.0, pi / 2 - a)


def in_head(r, z, radius, w, inner, outer, c, h):
    i, o = radius - w / 2, radius + w / 2
    body = (r >= i - z * tan(inner)) & (r <= o + z * tan(outer)) & below(z, h)
    x, y = o - c * tan(pi / 4 - outer / 2), i + c * tan(pi / 4 - inner / 2)
    return body & rounded(r, z, (x, c), c, -pi / 2, -outer) & rounded(r, z, (y, c), c, pi + inner, 1.5 * pi)


DEG = pi / 180
HEAD = (63.5, 2.54, 22 * DEG, 22 * DEG, 1.524, 12.0)
SAMPLES = {
    "flat": [((8.0, 20.0), cylinder)],
    "ball": [((6.0, 20.0), lambda r, z, d, h: cylinder(r, z, d, h, d / 2))],
    "bull": [((10.0, 1.0, 15.0), lambda r, z, d, c, h: cylinder(r, z, d, h, c)), ((10.0, 0.0, 15.0), None)],
    "tapered": [
        ((4.0, 8 * DEG, 20.0), lambda r, z, d, a, h: cone(r, z, d / 2, a, h)),
        ((9.0, -8 * DEG, 20.0), lambda r, z, d, a, h: cone(r, z, d / 2, a, h)),
    ],
    "tapered_ball": [
        ((4.0, a * DEG, 20.0), lambda r, z, d, a, h: in_zhou(r, z, h, 0.0, d / 2, a, 0.0)) for a in (10, -4)
    ],
    "conical": [((1.0, 1.5, 15 * DEG, 25.0), lambda r, z, e, c, a, h: in_zhou(r, z, h, e, c, a, 0.0))],
    "apt": [
        ((20.6, 0.0, 0.0, 0.0, 10 * DEG, 5 * DEG, 30.0), in_apt),
        ((10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0), in_apt),
        ((10.0, 3.0, 2.3, 2.3, 0.0, 0.0, 20.0), lambda r, z, *_: in_cut_apt(r, z)),
    ],
    "zhou_apt": [
        ((45.0, 10.0, 3.0, 10 * DEG, 10 * DEG), in_zhou),
        ((35.0, 15.0, 0.0, 0.0, 0.0), in_zhou),
        ((30.0, 5.0, 2.0, -6 * DEG, 20 * DEG), in_zhou),
    ],
    "barrel": [
        ((10.0, 50.0, 12.0, 24.0, 2.0), in_barrel),
        ((10.0, 50.0, 12.0, 24.0), lambda r, z, *p: in_barrel(r, z, *p, 0.0)),
        ((30.0, 80.0, 40.0, 25.0, 1.0), in_barrel),
        ((12.0, 5.5, 3.0, 6.0, 1.0), in_barrel),
    ],
    "oval": [((12.0, 85.0, 2.0, 30.0), in_oval)],
    "lollipop": [((8.0, 4.0, 20.0), in_lollipop)],
    "t_slot": [((16.0, 4.0, 6.0, 20.0, 0.8), in_t_slot), ((16.0, 4.0, 6.0, 20.0, 0.0), in_t_slot)],
    "dovetail": [
        ((16.0, 30 * DEG, 5.0, 8.0, 20.0, 0.4), in_dovetail),
        ((16.0, 30 * DEG, 5.0, 16.0 - 10.0 * tan(30 * DEG), 20.0, 0.0), in_dovetail),
    ],
    "grinding_cone": [
        ((203.2, 30 * DEG, 30.0, 1.0), in_grinding_cone),
        ((40.0, 30 * DEG, 20.0 / tan(30 * DEG), 0.0), in_grinding_cone),
    ],
    "grinding_wheel": [
        ((100.0, 3.0, 20 * DEG, 8.0, 0.5), in_wheel),
        ((100.0, 0.0, 15 * DEG, 10.0, 0.7), in_wheel),
        ((100.0, 5.0, 0.0, 10.0, 0.5), in_wheel),
    ],
    "face_mill_head": [(HEAD, in_head), ((30.0, 2.0, 10 * DEG, 25 * DEG, 0.0, 8.0), in_head)],
}
EVERY = [pytest.param(k, p, inside, id=f"{k} {i}") for k, v in SAMPLES.items() for i, (p, inside) in enumerate(v)]


def test_every_cutter_of_the_catalogue_is_tried_here_and_has_a_parameter_table():
    assert set(SAMPLES) == set(CUTTERS)
    for name, make in CUTTERS.items():
        assert getattr(catalogue, name) is make
        parameters = make.__code__.co_varnames[: make.__code__.co_argcount]
        assert all(f"| {p} |" in make.__doc__ for p in parameters if p != "name")


@pytest.mark.parametrize(("name", "parameters", "inside"), EVERY)
def test_the_boundary_is_that_of_the_construction(name, parameters, inside, rng):
    """From points outside to points inside, the construction's boundary is found by bisection: distance zero there."""
    cutter = CUTTERS[name](*parameters)
    inside = inside or (lambda r, z, d, c, h: cylinder(r, z, d, h))
    low, high, bottom, top = cutter.box
    r = rng.uniform(max(low - 2.0, 0.0), high + 2.0, 4000)
    z = rng.uniform(bottom - 2.0, top + 2.0, 4000)
    state = inside(r, z, *parameters)
    assert 200 < state.sum() < 3900
    near = np.abs(cutter.signed_distance(r, z)) < 1e-6
    assert np.array_equal(cutter.signed_distance(r, z)[~near] < 0.0, state[~near])
    a = np.stack([r[state][:190], z[state][:190]])
    b = np.stack([r[~state][:190], z[~state][:190]])
    a, b = a[:, : b.shape[1]], b[:, : a.shape[1]]
    for _ in range(60):
        middle = 0.5 * (a + b)
        within = inside(*middle, *parameters)
        a, b = np.where(within, middle, a), np.where(within, b, middle)
    assert np.abs(cutter.signed_distance(*(0.5 * (a + b)))).max() < 1e-9


@pytest.mark.parametrize(("name", "parameters", "inside"), EVERY)
def test_every_element_is_an_admissible_family(name, parameters, inside):
    """rho' = -cos(alpha) h' along every element that is no disc (errata's test of a family of effective spheres)."""
    for e in CUTTERS[name](*parameters).elements:
        if e.is_flat:
            continue
        s, d = np.linspace(0.1, 0.9, 9) * e.length, 1e-4 * e.length
        p, ends = e.at(s), [e.at(s + k * d) for k in (-2, -1, 1, 2)]
        rho = [q.r / q.nr for q in ends]
        h = [q.z - q.r / q.nr * q.nz for q in ends]
        rho_s, h_s = ((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * d) for f in (rho, h))
        size = 1.0 + np.abs(rho_s) + np.abs(h_s)
        assert np.abs((rho_s + p.nz * h_s) / size).max() < 1e-7


def volume(cutter):
    """By Pappus: the integral of pi r² dz round the meridian, Gauss points on every element."""
    x, w = np.polynomial.legendre.leggauss(40)
    total = 0.0
    for e in cutter.elements:
        p = e.at(0.5 * e.length * (1.0 + x))
        total += 0.5 * e.length * float(np.sum(w * pi * p.r**2 * p.nr))
    return total


def frustum(a, b, h):
    return pi * h / 3.0 * (a * a + a * b + b * b)


@pytest.mark.parametrize(
    ("name", "parameters", "expected"),
    [
        ("flat", (8.0, 20.0), pi * 16.0 * 20.0),
        ("ball", (6.0, 20.0), 2 * pi / 3 * 27.0 + pi * 9.0 * 17.0),
        ("tapered", (4.0, 45 * DEG, 3.0), frustum(2.0, 5.0, 3.0)),
        ("lollipop", (10.0, 6.0, 20.0), 4 * pi / 3 * 125.0 - pi / 3 * 14.0 + pi * 9.0 * 11.0),
        ("t_slot", (16.0, 4.0, 6.0, 20.0), pi * 64.0 * 4.0 + pi * 9.0 * 16.0),
        ("dovetail", (16.0, 45 * DEG, 4.0, 6.0, 20.0), frustum(8.0, 4.0, 4.0) + pi * 9.0 * 16.0),
        ("grinding_wheel", (100.0, 3.0, 45 * DEG, 8.0), pi * 2500 * 3.0 + 2 * frustum(42.0, 50.0, 8.0)),
        ("face_mill_head", (30.0, 2.0, 45 * DEG, 45 * DEG, 0.0, 5.0), frustum(31, 36, 5) - frustum(29, 24, 5)),
        # a disc's rounded rim: Pappus on the rectangle's corner less the quarter circle
        (
            "bull",
            (10.0, 2.0, 15.0),
            pi * 25 * 15 - 2 * pi * ((4.0 * 4.0) - pi * (3.0 + 8.0 / (3.0 * pi))),
        ),
    ],
)
def test_volumes(name, parameters, expected):
    assert volume(CUTTERS[name](*parameters)) == pytest.approx(expected, rel=1e-12)


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


@pytest.mark.parametrize(
    ("name", "parameters", "relation"),
    [
        ("flat", (-6.0, 20.0), "diameter = -6 mm must be positive"),
        ("ball", (6.0, 3.0), "height = 3 mm must exceed the corner radius, 3 mm"),
        ("bull", (6.0, 3.5, 20.0), "corner_radius = 3.5 mm must not exceed half the diameter, 3 mm"),
        ("bull", (6.0, float("nan"), 20.0), "corner_radius"),
        ("tapered", (6.0, -0.4, 20.0), "meets the axis below the top"),
        ("tapered", (6.0, 1.6, 20.0), "taper = 91.6732 deg must lie in -90 to 90 deg"),
        ("tapered_ball", (6.0, 0.1, 2.0), "height h = 2 mm must exceed the corner's end"),
        ("apt", (-6.0, 1.0, 2.0, 1.0, 0.0, 0.0, 20.0), "diameter d"),
        ("apt", (6.0, -1.0, 2.0, 1.0, 0.0, 0.0, 20.0), "corner radius r"),
        ("apt", (6.0, 1.0, 2.0, 1.0, 0.0, 0.0, 0.5), "height h"),
        ("apt", (6.0, 1.0, 2.0, 1.4, 0.0, 0.0, 20.0), "does not reach the lower line: f = 1.4 mm, 1 mm would be"),
        ("apt", (7.0, 1.0, 2.0, 1.0, 0.0, 0.0, 20.0), "does not reach the upper line: d = 7 mm, 6 mm would be"),
        ("apt", (6.0, 1.0, 3.2, 1.0, 0.0, 0.0, 20.0), "centre lies 0.2 mm outside the upper line"),
        ("apt", (6.0, 1.0, 2.0, 1.0, 0.3 * pi, 0.3 * pi, 20.0), "alpha \\+ beta"),
        ("apt", (6.0, 0.0, 0.0, 0.0, 0.0, -0.4, 20.0), "meets the axis"),
        ("apt", (10.0, 3.0, 3.0, 2.0, 0.0, 0.0, 20.0), "cuts the upper line at z = -0.236068 mm, below the lower"),
        ("apt", (6.0, 5.0, 0.0, 3.0, 0.0, 0.0, 20.0), "the corner cuts the upper line at z = -1 mm"),
        ("zhou_apt", (45.0, 10.0, -3.0, 0.1, 0.1), "corner radius r = -3 mm must not be negative"),
        ("barrel", (10.0, 50.0, 12.0, 65.0), "height = 65 mm must be below middle \\+ barrel_radius = 62 mm"),
        ("barrel", (10.0, 50.0, 40.0, 45.0), "the bottom is too narrow"),
        ("barrel", (10.0, 50.0, 12.0, 45.0), "the top is too narrow"),
        ("barrel", (10.0, 8.0, 12.0, 15.0, 1.0), "the corner lies below the arc"),
        ("oval", (12.0, 85.0, 6.5, 30.0), "ball_radius = 6.5 mm must be below half the diameter, 6 mm"),
        ("oval", (12.0, 5.0, 2.0, 30.0), "barrel_radius = 5 mm must exceed half the diameter, 6 mm"),
        ("lollipop", (8.0, 9.0, 20.0), "neck_diameter = 9 mm must be below ball_diameter = 8 mm"),
        ("lollipop", (8.0, 4.0, 7.0), "height = 7 mm must exceed 7.4641 mm"),
        ("t_slot", (16.0, 4.0, 6.0, 20.0, 2.5), "2 edge_radius = 5 mm must not exceed thickness = 4 mm"),
        ("t_slot", (16.0, 4.0, 6.0, 3.0), "height = 3 mm must exceed thickness = 4 mm"),
        ("dovetail", (16.0, 0.8, 6.0, 6.0, 20.0), "neck_diameter = 6 mm must not exceed .* = 3.64434 mm"),
        ("grinding_cone", (40.0, 30 * DEG, 40.0), "height = 40 mm must not exceed the whole cone's, 34.641 mm"),
        ("grinding_wheel", (100.0, 0.5, 0.2, 8.0, 0.5), "rim_width = 0.5 mm must be at least 0.81"),
        ("grinding_wheel", (100.0, 0.0, 0.0, 8.0), "must not both be 0"),
        ("grinding_wheel", (10.0, 1.0, 0.2, 8.0), "depth = 8 mm must be below half the diameter, 5 mm"),
        ("grinding_wheel", (100.0, 3.0, 1.2, 0.1, 3.0), "the roundings at the ends of the side .* smaller radii"),
        ("face_mill_head", (63.5, 2.0, 0.384, 0.384, 1.524, 12.0), "point_width = 2 mm must exceed .* = 2.05"),
        ("face_mill_head", (5.0, 2.0, 0.5, 0.5, 0.2, 12.0), "radius = 5 mm must exceed 7.55"),
        ("face_mill_head", (63.5, 2.0, -0.2, 0.0, 0.2, 12.0), "the flanks meet below the top"),
        ("face_mill_head", (63.5, 4.0, 0.0, 0.0, 1.9, 1.0), "the roundings at the ends of the side"),
    ],
)
def test_impossible_parameters_name_the_relation_that_fails(name, parameters, relation):
    with pytest.raises(InputError, match=relation):
        CUTTERS[name](*parameters)
