"""Every cutter of the catalogue against its own construction, its volume, and what is refused of it."""

from math import pi

import numpy as np
import pytest

from gearsim.cutters import catalogue
from gearsim.cutters.catalogue import CUTTERS
from gearsim.errors import InputError
from tests.cutters.constructions import DEG, SAMPLES, cylinder

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
