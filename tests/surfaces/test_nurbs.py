"""NURBS surfaces: quadrics in closed form, changes that change nothing, poles, and refused input."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gearsim.errors import InputError
from gearsim.geometry.nurbs import clamped_knots, surface_derivatives
from gearsim.surfaces.nurbs import NurbsSurface, shape_tensor
from tests.surfaces.nurbs_shapes import cylinder, raised, rebuilt, sphere, torus, wavy, with_knot

FIELDS = ("r", "ru", "rv", "ruu", "ruv", "rvv", "normal")


def sample(surface, n=200, seed=0):
    rng = np.random.default_rng(seed)
    return surface.locate(*rng.uniform(size=(2, n)))


def tensor_3d(jet):
    """The curvature tensor as a symmetric 3 x 3 matrix, free of any tangent basis."""
    c = jet.curvature()
    return sum(
        k[:, None, None] * d[:, :, None] * d[:, None, :] for k, d in ((c.k1, c.direction1), (c.k2, c.direction2))
    )


@pytest.mark.parametrize("flip", [False, True])
def test_a_cylinder(flip):
    surface = cylinder(20.0, 50.0, flip)
    jet = surface.jet(*sample(surface))
    out = np.stack([jet.r[:, 0], jet.r[:, 1], 0.0 * jet.r[:, 2]], axis=1) / 20.0
    sign = -1.0 if flip else 1.0
    np.testing.assert_allclose(np.hypot(jet.r[:, 0], jet.r[:, 1]), 20.0, rtol=1e-14)
    np.testing.assert_allclose(jet.normal, sign * out, atol=1e-12)
    along, around = np.array([0.0, 0.0, 1.0]), np.cross([0.0, 0.0, 1.0], out)
    for e1, wanted in ((around, (-sign / 20.0, 0, 0)), (along, (0, 0, -sign / 20.0))):
        for k, w in zip(shape_tensor(jet, e1), wanted, strict=True):
            np.testing.assert_allclose(k, w, atol=1e-13)


def test_a_bowl_is_concave_as_seen_from_its_normal():
    bowl = sphere(8.0, flip=True)
    jet = bowl.jet(*sample(bowl))
    np.testing.assert_allclose(jet.normal, -jet.r / 8.0, atol=1e-13)
    k11, k12, k22 = shape_tensor(jet, np.cross(jet.normal, [0.3, 0.2, 0.1]))
    np.testing.assert_allclose([k11, k22], 1.0 / 8.0, rtol=1e-12)
    np.testing.assert_allclose(k12, 0.0, atol=1e-13)
    assert np.isfinite(jet.curvature().direction1).all()


def test_a_torus():
    surface = torus(10.0, 3.0)
    jet = surface.jet(*sample(surface))
    rho = np.hypot(jet.r[:, 0], jet.r[:, 1])
    np.testing.assert_allclose(np.hypot(rho - 10.0, jet.r[:, 2]), 3.0, rtol=1e-13)
    around = np.stack([-jet.r[:, 1], jet.r[:, 0], 0.0 * rho], axis=1)
    k11, k12, k22 = shape_tensor(jet, around)
    np.testing.assert_allclose(k11, -(rho - 10.0) / 3.0 / rho, atol=1e-13)
    np.testing.assert_allclose(k12, 0.0, atol=1e-13)
    np.testing.assert_allclose(k22, -1.0 / 3.0, rtol=1e-12)


def test_the_tensor_turns_with_its_basis():
    surface = wavy(np.random.default_rng(3))
    jet = surface.jet(*sample(surface))
    a, b, c = shape_tensor(jet, jet.ru)
    e1 = jet.ru / np.linalg.norm(jet.ru, axis=1, keepdims=True)
    np.testing.assert_allclose(a, jet.second_form()[0] / np.einsum("ni,ni->n", jet.ru, jet.ru), rtol=1e-11)
    for angle in (0.4, 2.0, 4.0):
        k11, k12, k22 = shape_tensor(jet, 7.0 * (np.cos(angle) * e1 + np.sin(angle) * np.cross(jet.normal, e1)))
        x, y = np.cos(angle), np.sin(angle)
        np.testing.assert_allclose(k11, a * x * x + 2 * b * x * y + c * y * y, atol=1e-12)
        np.testing.assert_allclose(k12, (c - a) * x * y + b * (x * x - y * y), atol=1e-12)
        np.testing.assert_allclose(k11 + k22, a + c, atol=1e-12)


def test_derivatives_are_those_of_complex_steps_and_differences():
    surface = wavy(np.random.default_rng(4))
    u, v = sample(surface)
    d = surface_derivatives(*surface.along, surface.net, u, v)
    by_u = surface_derivatives(*surface.along, surface.net, u + 1e-30j, v)
    by_v = surface_derivatives(*surface.along, surface.net, u, v + 1e-30j)
    for got, stepped in (
        (d.ru, by_u.r), (d.rv, by_v.r), (d.ruu, by_u.ru), (d.ruv, by_v.ru), (d.ruv, by_u.rv), (d.rvv, by_v.rv)
    ):  # fmt: skip
        np.testing.assert_allclose(got, stepped.imag / 1e-30, rtol=1e-12, atol=1e-12 * np.abs(got).max())
    h = 1e-6
    inner = (u > 0.01) & (u < 0.99)
    ahead, back = (surface.jet(np.where(inner, u + s, u), v).r for s in (h, -h))
    np.testing.assert_allclose(((ahead - back) / (2 * h))[inner], d.ru[inner], atol=1e-6)


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_moves_knots_and_degrees_change_nothing(seed):
    rng = np.random.default_rng(seed)
    degree = int(rng.integers(1, 5))
    surface = wavy(rng, degree, int(rng.integers(1, 4)), (degree + 1, 5))
    u, v = sample(surface, 30, seed)
    before = surface.jet(u, v)
    for same in (with_knot(surface, 0.3), with_knot(with_knot(surface, 0.6), 0.6) if degree > 1 else surface,
                 raised(surface)):  # fmt: skip
        after = same.jet(u, v)
        for name in FIELDS:
            was = getattr(before, name)
            np.testing.assert_allclose(getattr(after, name), was, atol=1e-12 * max(1.0, np.abs(was).max()))
    turn, shift = Rotation.random(rng=rng).as_matrix(), rng.uniform(-50, 50, 3)
    moved = rebuilt(surface, surface.points @ turn.T + shift).jet(u, v)
    np.testing.assert_allclose(moved.r, before.r @ turn.T + shift, atol=1e-12)
    wanted = turn @ tensor_3d(before) @ turn.T
    np.testing.assert_allclose(tensor_3d(moved), wanted, atol=1e-10 * max(1.0, np.abs(wanted).max()))


@given(st.integers(0, 2**32 - 1))
@settings(max_examples=20, deadline=None)
def test_points_lie_in_the_hull_of_the_net(seed):
    rng = np.random.default_rng(seed)
    net = rng.normal(size=(5, 4, 3))
    surface = NurbsSurface(3, 2, clamped_knots(5, 3), clamped_knots(4, 2), net, rng.uniform(0.1, 10.0, (5, 4)))
    r, ways = surface.jet(*sample(surface)).r, rng.normal(size=(50, 3))
    assert np.all((r @ ways.T).max(axis=0) <= (net.reshape(-1, 3) @ ways.T).max(axis=0) + 1e-13)


def test_corners_are_control_points_and_outside_is_nothing():
    surface = wavy(np.random.default_rng(5))
    np.testing.assert_allclose(
        surface.jet([0, 1, 0, 1], [0, 0, 1, 1]).r, surface.points[[0, -1, 0, -1], [0, 0, -1, -1]]
    )
    outside = surface.jet(np.array([-0.01, 0.5, np.nan, 1.0 + 1e-14]), np.array([0.5, 1.01, 0.5, 0.5]))
    np.testing.assert_array_equal(np.isnan(outside.r[:, 0]), [True, True, True, False])
    np.testing.assert_array_equal(np.isnan(outside.curvature().k1), [True, True, True, False])
    np.testing.assert_array_equal(surface.windows(np.zeros(2), np.zeros(2))[0], [0.1 * surface.size] * 2)


@pytest.mark.parametrize("flip", [False, True])
def test_poles_of_an_ellipsoid(flip):
    """At its end on z an ellipsoid has the normal curvatures c/a² and c/b², and closer to it nothing is lost."""
    a, b, c = 6.0, 4.0, 3.0
    ball = sphere(1.0, flip)
    surface = rebuilt(ball, ball.points * [a, b, c])
    for v, tip in ((0.0, -1.0), (2.0, 1.0)):
        u = np.linspace(0.0, 4.0, 13)
        jet = surface.jet(u, np.full(13, v))
        sign = -1.0 if flip else 1.0
        np.testing.assert_allclose(jet.normal, [[0, 0, sign * tip]] * 13, atol=1e-13)
        k11, k12, k22 = shape_tensor(jet, np.array([1.0, 0.0, 0.0]))
        np.testing.assert_allclose(k11, -sign * c / a**2, rtol=1e-12)
        np.testing.assert_allclose(k22, -sign * c / b**2, rtol=1e-12)
        np.testing.assert_allclose(k12, 0.0, atol=1e-13)
    distance = 10.0 ** -np.arange(1.0, 16.0, 0.25)
    jet = surface.jet(np.full(len(distance), 0.3), distance)
    normal = jet.r / np.array([a, b, c]) ** 2
    support = np.linalg.norm(normal, axis=1)
    gaussian = 1.0 / (a * b * c * support**2) ** 2
    np.testing.assert_allclose(jet.normal, (-1.0 if flip else 1.0) * normal / support[:, None], atol=1e-12)
    np.testing.assert_allclose(jet.curvature().gaussian, gaussian, rtol=1e-7)
    np.testing.assert_allclose(jet.curvature().gaussian[distance > 1e-6], gaussian[distance > 1e-6], rtol=1e-9)


def test_a_pole_at_an_end_of_u_is_like_one_of_v():
    ball = sphere(5.0)
    turned = NurbsSurface(
        2, 2, ball.knots_v, ball.knots_u, np.swapaxes(ball.points, 0, 1), ball.weights.T, flip=True
    )  # fmt: skip
    jet = turned.jet(np.array([0.0, 2.0]), np.array([0.7, 3.1]))
    np.testing.assert_allclose(jet.normal, jet.r / 5.0, atol=1e-14)
    np.testing.assert_allclose([jet.curvature().k1, jet.curvature().k2], -0.2, rtol=1e-12)


def test_the_apex_of_a_cone_has_normals_but_no_curvature():
    points = [[[0.0, 0.0, 5.0], [5.0 * x, 5.0 * y, 0.0]] for x, y in ((1, 0), (1, 1), (0, 1))]
    cone = NurbsSurface(2, 1, [0, 0, 0, 1, 1, 1], [0, 0, 1, 1], points, np.outer([1, np.sqrt(0.5), 1], [1, 1]))
    jet = cone.jet(np.array([0.0, 0.5, 1.0]), np.zeros(3))
    assert np.isnan(jet.curvature().k1).all()
    np.testing.assert_allclose(jet.normal, cone.jet(np.array([0.0, 0.5, 1.0]), np.full(3, 0.5)).normal, atol=1e-14)


def test_the_corner_of_table_9_2_as_printed():
    """(0, 0, 50) stands twice in its first row: r_v = 0 at (0, 1), an erratum; there is still a normal."""
    points = [[[20, 0, z], [0, 0, z], [0, 20, z]] for z in (50.0, 37.5, 25.0, 12.5, 0.0)]
    points[0][2] = [0, 0, 50]
    surface = NurbsSurface(1, 2, [0, 0, 1, 2, 3, 4, 4], [0, 0, 0, 1, 1, 1], points)
    jet = surface.jet(np.array([0.0, 0.0]), np.array([1.0, 0.5]))
    np.testing.assert_array_equal(jet.rv[0], 0.0)
    np.testing.assert_allclose(np.linalg.norm(jet.normal, axis=1), 1.0)
    np.testing.assert_array_equal(np.isnan(jet.curvature().k1), [True, False])


def test_a_plane_has_no_curvature():
    x, y = np.meshgrid([0.0, 1.0, 3.0], [0.0, 2.0, 5.0], indexing="ij")
    plane = NurbsSurface(2, 2, [0, 0, 0, 1, 1, 1], [0, 0, 0, 1, 1, 1], np.stack([x, y, 0 * x], axis=-1))
    jet = plane.jet(*sample(plane))
    np.testing.assert_array_equal(shape_tensor(jet, np.array([1.0, 1.0, 0.0])), 0.0)
    np.testing.assert_allclose(jet.normal, [[0.0, 0.0, 1.0]] * 200, atol=1e-15)


NET = np.stack([*np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0], indexing="ij"), np.zeros((3, 2))], axis=-1)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"knots_u": [0, 0, 1, 1]}, "too few for degree 2"),
        ({"knots_u": [0, 0, 0, 1, 2, 2, 2]}, "7 knots in u and degree 2 make 4 rows .* got 3: 6 knots would be right"),
        ({"knots_v": [0, 1, 0, 1]}, "must not fall"),
        ({"weights": np.ones((2, 3))}, r"weights must be one for each control point, \(3, 2\); got \(2, 3\)"),
        ({"weights": [[1, 1], [1, -2], [1, 1]]}, "positive, got -2 in row 2, column 2"),
        ({"points": np.full((3, 2, 3), np.nan)}, "control points must be finite"),
        ({"points": np.zeros((3, 2))}, "control points"),
        ({"points": np.zeros((3, 2, 3))}, "span no surface"),
        ({"points": NET * [1, 0, 0]}, "span no surface"),
        ({"points": NET[:, :1]}, "at least 2"),
        ({"points": [[[1, 2, 3]], [[1, 2]]]}, "rows of equal length"),
    ],
)
def test_impossible_surfaces_are_refused(changes, said):
    good = {"degree_u": 2, "degree_v": 1, "knots_u": [0, 0, 0, 1, 1, 1], "knots_v": [0, 0, 1, 1], "points": NET}
    NurbsSurface(**good)
    with pytest.raises(InputError, match=said):
        NurbsSurface(**{**good, **changes})


def test_points_alone_are_those_of_the_jet_to_the_bit(rng):
    surface = torus(10.0, 3.0)
    (u0, u1), (v0, v1) = surface.domain
    u, v = rng.uniform(u0 - 0.1, u1, 9000), rng.uniform(v0, v1, 9000)
    assert np.array_equal(surface.at(u, v), surface.jet(u, v).r, equal_nan=True)
    assert np.isnan(surface.at(u, v)).any()
