import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.geometry.curves import darboux, frenet, principal_from_sections, second_torsion, surface_curve
from tests.geometry.test_jets import differences, torus, wavy


def helix(w, radius=2.0, screw=0.7):
    """Derivatives 1 to 3 of a helix run through at uneven speed: angle w + w²/3."""
    a, a1, a2 = w + w * w / 3, 1 + 2 * w / 3, 2 / 3
    r1 = lambda x: np.stack([-radius * np.sin(x), radius * np.cos(x), screw + 0 * x], axis=-1)
    r2 = lambda x: np.stack([-radius * np.cos(x), -radius * np.sin(x), 0 * x], axis=-1)
    r3 = lambda x: np.stack([radius * np.sin(x), -radius * np.cos(x), 0 * x], axis=-1)
    col = lambda x: np.asarray(x)[..., None]
    return (
        col(a1) * r1(a),
        col(a1**2) * r2(a) + a2 * r1(a),
        col(a1**3) * r3(a) + 3 * a2 * col(a1) * r2(a),
    )


@pytest.mark.parametrize("screw", [0.7, -0.7])
def test_helix_has_constant_curvature_and_torsion_whatever_the_parameter(screw):
    f = frenet(*helix(np.linspace(-1, 1, 20), screw=screw))
    assert np.allclose(f.curvature, 2.0 / (4.0 + screw**2))
    assert np.allclose(f.torsion, screw / (4.0 + screw**2))
    assert np.allclose(np.cross(f.tangent, f.principal_normal), f.binormal)


def test_a_straight_line_has_no_torsion_and_no_trihedron():
    one = np.array([[1.0, 2.0, 3.0]])
    f = frenet(one, 0.5 * one, 0.0 * one)
    assert f.curvature == pytest.approx(0.0)
    assert np.isnan(f.torsion).all()
    assert np.isnan(f.binormal).all()


W = 0.3  # where curves are taken: u = u0 + a w + b w², v = v0 + c w + d w²


@pytest.fixture
def curve(rng):
    """Random parabolas in the parameters of the wavy sheet: (u, v) as functions of w, and their derivatives."""
    (u0, v0), (a, c), (b, d) = rng.uniform(-0.5, 0.5, (2, 80)), rng.normal(size=(2, 80)), rng.normal(size=(2, 80))
    at = lambda w: (u0 + a * w + b * w * w, v0 + c * w + d * w * w)
    return at, (a + 2 * b * W, c + 2 * d * W, 2 * b, 2 * d)


def trihedron(at, w):
    """Built from points and normals alone."""
    t = differences(lambda x, _: wavy(*at(x)).r, w, 0.0, 1, 0)[0]
    t /= np.linalg.norm(t, axis=1, keepdims=True)
    n = wavy(*at(w)).normal
    return t, np.cross(n, t), n


def test_bonnet_kovalevski_by_differences_of_the_trihedron(curve):
    """kn, kg and tg as the rates at which the surface trihedron turns (Litvin 92), to 1e-8."""
    at, rates = curve
    c = surface_curve(wavy(*at(W)), *rates)
    speed = np.linalg.norm(differences(lambda x, _: wavy(*at(x)).r, W, 0.0, 1, 0)[0], axis=1, keepdims=True)
    t, d, n = trihedron(at, W)
    slow = 0.2  # the outer differences widen the inner ones' steps
    dt, dn = (
        differences(lambda x, _, i=i: trihedron(at, W + slow * x)[i], 0.0, 0.0, 1, 0)[0] / slow / speed for i in (0, 2)
    )
    along = lambda a, b: np.sum(a * b, axis=1)
    scale = 1.0 + np.abs(c.geodesic_curvature)
    assert np.allclose(np.stack(c[:3]), np.stack([t, d, n]), atol=1e-10)
    assert np.max(np.abs(along(dt, n) - c.normal_curvature) / scale) < 1e-8
    assert np.max(np.abs(along(dt, d) - c.geodesic_curvature) / scale) < 1e-8
    assert np.max(np.abs(-along(dn, d) - c.geodesic_torsion) / scale) < 1e-8
    assert np.allclose(np.cross(c.rotation, t), dt, atol=1e-7)
    assert np.allclose(np.cross(c.rotation, n), dn, atol=1e-7)


def test_euler_and_bonnet_germain_give_the_same_from_the_principal_curvatures(curve):
    at, rates = curve
    jet = wavy(*at(W))
    c, k = surface_curve(jet, *rates), jet.curvature()
    assert np.allclose(k.normal_curvature(c.tangent), c.normal_curvature, rtol=1e-11)
    assert np.allclose(k.geodesic_torsion(c.tangent, c.normal), c.geodesic_torsion, rtol=1e-11, atol=1e-13)


def test_curvature_vector_of_the_space_curve_is_split_by_the_surface(curve):
    """ko² = kn² + kg² (Litvin 94), against the curve's own Frenet formula."""
    at, rates = curve
    c = surface_curve(wavy(*at(W)), *rates)
    first, second = differences(lambda x, _: wavy(*at(x)).r, W, 0.0, 1, 0)
    f = frenet(first, second, 0.0 * first)
    assert np.allclose(f.curvature, np.hypot(c.normal_curvature, c.geodesic_curvature), rtol=1e-8)
    assert np.allclose(np.sum(f.principal_normal * c.side, axis=1) * f.curvature, c.geodesic_curvature, atol=1e-8)


def test_surface_torsion_is_torsion_plus_the_turn_of_the_osculating_plane(curve):
    """Litvin 102, all by differences on the left side."""
    at, rates = curve
    c = surface_curve(wavy(*at(W)), *rates)
    point = lambda x, _: wavy(*at(x)).r

    def derivatives(w):
        return differences(point, w, 0.0, 1, 0)

    def delta(w):
        first, second = derivatives(w)
        f = frenet(first, second, 0.0 * first)
        n = wavy(*at(w)).normal
        return np.arctan2(
            np.sum(f.principal_normal * np.cross(n, f.tangent), axis=1), np.sum(f.principal_normal * n, axis=1)
        )

    slow = 0.3
    third = differences(lambda x, _: derivatives(W + slow * x)[1], 0.0, 0.0, 1, 0)[0] / slow
    turn = differences(lambda x, _: delta(W + slow * x), 0.0, 0.0, 1, 0)[0] / slow
    first, second = derivatives(W)
    torsion = frenet(first, second, third).torsion + turn / np.linalg.norm(first, axis=1)
    bent = np.hypot(c.normal_curvature, c.geodesic_curvature) > 0.3  # elsewhere the osculating plane spins
    assert bent.sum() > 40
    assert np.allclose(torsion[bent], c.geodesic_torsion[bent], atol=1e-5)


def test_lines_of_curvature_of_a_torus_have_no_torsion():
    """A tube's circle is a normal section; the outer equator is a geodesic, other rings bend by sin v / R."""
    v = np.array([0.0, 0.4, 1.2])
    jet = torus(np.zeros(3), v)
    tube, ring = surface_curve(jet, 0.0, 1.0), surface_curve(jet, 1.0, 0.0)
    assert np.allclose(tube.geodesic_curvature, 0.0, atol=1e-14)
    assert np.allclose(tube.normal_curvature, -0.5)
    assert np.allclose(np.abs(ring.geodesic_curvature), np.sin(v) / (5.0 + 2.0 * np.cos(v)))
    assert np.allclose([tube.geodesic_torsion, ring.geodesic_torsion], 0.0, atol=1e-14)


def test_geodesic_curvature_alone_depends_on_the_curve_s_own_bending(curve):
    at, (du, dv, ddu, ddv) = curve
    jet = wavy(*at(W))
    bent, straight = surface_curve(jet, du, dv, ddu, ddv), surface_curve(jet, du, dv)
    for name in ("normal_curvature", "geodesic_torsion"):
        assert np.allclose(getattr(bent, name), getattr(straight, name))
    assert np.min(np.abs(bent.geodesic_curvature - straight.geodesic_curvature)) > 1e-6


def test_reversing_the_normal_reverses_all_but_the_torsion(curve):
    at, (du, dv, ddu, ddv) = curve
    a, b = (surface_curve(wavy(*at(W), orientation), du, dv, ddu, ddv) for orientation in (1.0, -1.0))
    assert np.allclose(a.normal_curvature, -b.normal_curvature)
    assert np.allclose(a.geodesic_curvature, -b.geodesic_curvature)
    assert np.allclose(a.geodesic_torsion, b.geodesic_torsion)


def test_darboux_does_not_depend_on_the_speed(rng):
    v, a, n, dn = rng.normal(size=(4, 30, 3))
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    v -= np.sum(v * n, axis=1, keepdims=True) * n
    one, other = darboux(v, a, n, dn), darboux(3 * v, 9 * a + 2 * v, n, 3 * dn)
    assert np.allclose(one.geodesic_curvature, other.geodesic_curvature)
    assert np.allclose(one.normal_curvature, other.normal_curvature)
    assert np.allclose(one.geodesic_torsion, other.geodesic_torsion)


angles = st.floats(-3.0, 3.0)


@given(st.floats(-2.0, 2.0), st.floats(-2.0, 2.0), angles, angles.filter(lambda m: abs(np.sin(m)) > 0.05))
def test_litvins_problems_give_back_the_principal_curvatures(ka, kb, q, mu):
    """The surface's shape operator diag(ka, kb) is sectioned by hand; k1 = k2 and tan q infinite included."""
    shape = np.diag([ka, kb])
    t = lambda x: np.array([np.cos(x), np.sin(x)])
    d = lambda x: np.array([-np.sin(x), np.cos(x)])
    kn1, kn2 = (t(x) @ shape @ t(x) for x in (q, q + mu))
    t1, t2 = (t(x) @ shape @ d(x) for x in (q, q + mu))
    found = principal_from_sections(kn1, t1, kn2, mu)
    assert np.allclose([found.k1, found.k2], [max(ka, kb), min(ka, kb)], atol=1e-11)
    first = t(q - found.angle)
    assert first @ shape @ first == pytest.approx(max(ka, kb), abs=1e-9)
    assert second_torsion(kn1, t1, kn2, mu) == pytest.approx(t2, abs=1e-11)


def test_parallel_directions_are_refused():
    for problem in (principal_from_sections, second_torsion):
        with pytest.raises(InputError, match="parallel"):
            problem(0.1, 0.2, 0.1, np.pi)
