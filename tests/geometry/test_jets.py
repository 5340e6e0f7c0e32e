import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.geometry.jets import (
    Curvature,
    SurfaceJet,
    fundamental_curvature,
    rodrigues_curvature,
    weingarten_curvature,
)


def torus(u, v, big=5.0, small=2.0):
    """Torus with its normal outward; v runs round the tube."""
    cu, su, cv, sv = np.cos(u), np.sin(u), np.cos(v), np.sin(v)
    ring, nil = big + small * cv, np.zeros_like(u)
    stack = lambda *c: np.stack(c, axis=-1)
    return SurfaceJet(
        stack(ring * cu, ring * su, small * sv),
        stack(-ring * su, ring * cu, nil),
        stack(-small * sv * cu, -small * sv * su, small * cv),
        stack(-ring * cu, -ring * su, nil),
        stack(small * sv * su, -small * sv * cu, nil),
        stack(-small * cv * cu, -small * cv * su, -small * sv),
    )


def test_torus_curvatures_have_their_closed_form(rng):
    u, v = rng.uniform(-3, 3, (2, 200))
    curvature = torus(u, v).curvature()
    tube, ring = np.full_like(v, -1.0 / 2.0), -np.cos(v) / (5.0 + 2.0 * np.cos(v))
    assert np.allclose(curvature.k1, np.maximum(tube, ring))
    assert np.allclose(curvature.k2, np.minimum(tube, ring))
    assert np.allclose(curvature.gaussian, tube * ring)
    assert np.allclose(curvature.mean, 0.5 * (tube + ring))


def test_principal_directions_are_unit_tangent_and_orthogonal(rng):
    jet = torus(*rng.uniform(-3, 3, (2, 50)))
    c = jet.curvature()
    for d in (c.direction1, c.direction2):
        assert np.allclose(np.linalg.norm(d, axis=1), 1.0)
        assert np.allclose(np.sum(d * jet.normal, axis=1), 0.0, atol=1e-12)
    assert np.allclose(np.sum(c.direction1 * c.direction2, axis=1), 0.0, atol=1e-12)


def test_curvature_does_not_depend_on_the_parameters(rng):
    """A linear change of parameters, however skew, changes no curvature."""
    jet = torus(*rng.uniform(-3, 3, (2, 50)))
    a, b, c, d = 1.0, 0.8, -0.3, 0.5
    n = jet.normal
    second = [np.sum(n * x, axis=1) for x in (jet.ruu, jet.ruv, jet.rvv)]
    skew = fundamental_curvature(
        a * jet.ru + b * jet.rv,
        c * jet.ru + d * jet.rv,
        a * a * second[0] + 2 * a * b * second[1] + b * b * second[2],
        a * c * second[0] + (a * d + b * c) * second[1] + b * d * second[2],
        c * c * second[0] + 2 * c * d * second[1] + d * d * second[2],
    )
    assert np.allclose(skew.k1, jet.curvature().k1)
    assert np.allclose(skew.k2, jet.curvature().k2)


def test_weingarten_and_fundamental_forms_agree_on_a_ball():
    r = 3.0
    u, v = np.array([0.3]), np.array([0.5])
    normal = np.array([[np.cos(u[0]) * np.cos(v[0]), np.sin(u[0]) * np.cos(v[0]), np.sin(v[0])]])
    nu = np.array([[-np.sin(u[0]) * np.cos(v[0]), np.cos(u[0]) * np.cos(v[0]), 0.0]])
    nv = np.array([[-np.cos(u[0]) * np.sin(v[0]), -np.sin(u[0]) * np.sin(v[0]), np.cos(v[0])]])
    curvature = weingarten_curvature(r * nu, r * nv, nu, nv)
    assert np.allclose([curvature.k1[0], curvature.k2[0]], -1.0 / r)
    assert np.allclose(np.sum(normal * nu), 0.0)


# Second differences of points alone, of eighth order, on a surface bent differently in every direction.

FIRST = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
SECOND = np.array([-1 / 560, 8 / 315, -1 / 5, 8 / 5, -205 / 72, 8 / 5, -1 / 5, 8 / 315, -1 / 560])
STEPS = 0.02 * np.arange(-4, 5)


def wavy_point(u, v):
    """A skew, twisted sheet; no parameter line is a principal one."""
    return np.stack(
        [u + 0.3 * v, 1.2 * v - 0.1 * u * u, 0.4 * np.sin(u + 0.5 * v) + 0.25 * u * v + 0.1 * v**3], axis=-1
    )


def wavy(u, v, orientation=1.0):
    s, c, one, nil = np.sin(u + 0.5 * v), np.cos(u + 0.5 * v), np.ones_like(u), np.zeros_like(u)
    stack = lambda *x: np.stack(x, axis=-1)
    return SurfaceJet(
        wavy_point(u, v),
        stack(one, -0.2 * u, 0.4 * c + 0.25 * v),
        stack(0.3 * one, 1.2 * one, 0.2 * c + 0.25 * u + 0.3 * v * v),
        stack(nil, -0.2 * one, -0.4 * s),
        stack(nil, nil, -0.2 * s + 0.25),
        stack(nil, nil, -0.1 * s + 0.6 * v),
        orientation,
    )


def differences(function, u, v, du, dv):
    """First and second derivative of a function along (du, dv)."""
    values = [function(u + s * du, v + s * dv) for s in STEPS]
    h = STEPS[5]
    first, second = (sum(w * x for w, x in zip(weights, values, strict=True)) for weights in (FIRST, SECOND))
    return first / h, second / h**2


@pytest.mark.parametrize("orientation", [1.0, -1.0])
def test_normal_curvature_agrees_with_second_differences_of_points(rng, orientation):
    """Along any direction: the deviation from the tangent plane over the square of the way."""
    u, v = rng.uniform(-1, 1, (2, 100))
    du, dv = rng.normal(size=(2, 100))
    jet = wavy(u, v, orientation)
    c = jet.curvature()
    tangent, bend = differences(wavy_point, u, v, du, dv)
    by_u, by_v = differences(wavy_point, u, v, 1, 0)[0], differences(wavy_point, u, v, 0, 1)[0]
    n = orientation * np.cross(by_u, by_v)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    expected = np.sum(n * bend, axis=1) / np.sum(tangent**2, axis=1)
    scale = np.maximum(np.abs(c.k1), np.abs(c.k2))
    assert np.max(np.abs(c.normal_curvature(tangent) - expected) / scale) < 1e-8


def test_normal_rates_agree_with_differences_of_normals(rng):
    u, v = rng.uniform(-1, 1, (2, 100))
    for orientation in (1.0, -1.0):
        normal = lambda a, b, o=orientation: wavy(a, b, o).normal
        nu, nv = wavy(u, v, orientation).normal_rates()
        assert np.allclose(nu, differences(normal, u, v, 1, 0)[0], atol=1e-9)
        assert np.allclose(nv, differences(normal, u, v, 0, 1)[0], atol=1e-9)


def test_forms_give_gaussian_and_mean_curvature(rng):
    """K = (LN - M²)/(EG - F²), H = (LG - 2MF + NE)/(2(EG - F²)) (Zhou 2.52; 2.51 exchanges the two)."""
    jet = wavy(*rng.uniform(-1, 1, (2, 100)))
    (E, F, G), (L, M, N), c = jet.first_form(), jet.second_form(), jet.curvature()
    area = E * G - F * F
    assert np.allclose(c.gaussian, (L * N - M * M) / area)
    assert np.allclose(c.mean, (L * G - 2 * M * F + N * E) / (2 * area))
    assert np.allclose([c.k1 + c.k2, c.k1 * c.k2], [2 * c.mean, c.gaussian])


@pytest.mark.parametrize("orientation", [1.0, -1.0])
def test_rodrigues_and_fundamental_forms_agree(rng, orientation):
    jet = wavy(*rng.uniform(-1, 1, (2, 200)), orientation)
    a, b = jet.curvature(), rodrigues_curvature(jet.ru, jet.rv, *jet.normal_rates(), jet.normal)
    for name in ("gaussian", "mean", "k1", "k2"):
        assert np.allclose(getattr(a, name), getattr(b, name), rtol=1e-11, atol=1e-13), name
    for name in ("direction1", "direction2"):
        miss = np.cross(getattr(a, name), getattr(b, name))
        assert np.allclose(miss, 0.0, atol=1e-11), name


def test_the_normal_turns_against_principal_directions_alone(rng):
    """Rodrigues: dn = -k dr along them (differences of normals, no second form)."""
    u, v = rng.uniform(-1, 1, (2, 100))
    jet = wavy(u, v)
    c = jet.curvature()
    normal = lambda a, b: wavy(a, b).normal
    for k, d in ((c.k1, c.direction1), (c.k2, c.direction2)):
        du, dv = tangent_parameters(jet, d)
        turn = differences(normal, u, v, du, dv)[0]
        assert np.allclose(turn, -k[:, None] * d, atol=1e-9)


def tangent_parameters(jet, d):
    """(du, dv) of unit tangents, by least squares on r_u du + r_v dv = d."""
    columns = np.stack([jet.ru, jet.rv], axis=-1)
    return np.linalg.solve(np.swapaxes(columns, 1, 2) @ columns, np.einsum("nij,ni->nj", columns, d)[..., None])[
        ..., 0
    ].T


def test_rodrigues_at_an_umbilic_gives_some_orthonormal_pair():
    normal = np.array([[0.6, 0.0, 0.8]])
    ru, rv = np.array([[0.0, 2.0, 0.0]]), np.array([[0.8, 1.0, -0.6]])
    c = rodrigues_curvature(ru, rv, ru / 3.0, rv / 3.0, normal)
    assert np.allclose([c.k1, c.k2], -1.0 / 3.0)
    frame = np.concatenate([c.direction1, c.direction2, normal])
    assert np.allclose(frame @ frame.T, np.eye(3))


@given(st.floats(-3.0, 3.0), st.floats(0.1, 3.0), st.floats(0.01, 10.0))
def test_all_directions_lie_on_mohrs_circle(mean, spread, length):
    """(kn, tg) round (H, 0) at twice the direction's angle, whatever the sense of directions and normal."""
    x, y, z = np.eye(3)
    c = Curvature(
        *(np.array([k]) for k in (mean**2 - spread**2, mean, mean + spread, mean - spread)), x[None], -y[None]
    )
    q = np.linspace(0.0, np.pi, 7)[:, None]
    d = length * (np.cos(q) * x + np.sin(q) * y)
    kn = c.normal_curvature(d)
    tg = c.geodesic_torsion(d, z[None])
    assert np.allclose((kn - mean) ** 2 + tg**2, c.spread**2)
    assert np.allclose(kn, mean + spread * np.cos(2 * q[:, 0]))
    assert np.allclose(tg, -spread * np.sin(2 * q[:, 0]))
    turned = Curvature(c.gaussian, -c.mean, -c.k2, -c.k1, c.direction2, c.direction1)
    assert np.allclose(turned.geodesic_torsion(d, -z[None]), tg)
