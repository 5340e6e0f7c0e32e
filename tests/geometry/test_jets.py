import numpy as np

from gearsim.geometry.jets import SurfaceJet, fundamental_curvature, weingarten_curvature


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
