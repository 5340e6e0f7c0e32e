import numpy as np
import pytest

from gearsim.geometry.grazing import MeridianPoints, PoseJet, grazing_points
from tests.helpers import observed_order


def random_motion(rng, n):
    """Tips on cubic curves, axes turning: poses at t with exact derivatives, as functions of t."""
    c = rng.normal(size=(4, n, 3))
    w0, w1 = rng.normal(size=(2, n, 3)), rng.normal(size=(2, n, 3))

    def pose(t):
        tip = sum(c[k] * t**k for k in range(4))
        tip1 = c[1] + 2 * c[2] * t + 3 * c[3] * t**2
        tip2 = 2 * c[2] + 6 * c[3] * t
        a, a1 = w0[0] + w0[1] * t + w1[0] * t**2, w0[1] + 2 * w1[0] * t
        a2 = 2 * w1[0]
        size = np.linalg.norm(a, axis=1, keepdims=True)
        s1 = np.sum(a * a1, axis=1, keepdims=True) / size
        s2 = (np.sum(a1 * a1 + a * a2, axis=1, keepdims=True) - s1**2) / size
        axis = a / size
        axis1 = a1 / size - a * s1 / size**2
        axis2 = a2 / size - 2 * a1 * s1 / size**2 - a * s2 / size**2 + 2 * a * s1**2 / size**3
        return PoseJet(tip, axis, tip1, axis1, tip2, axis2)

    return pose


def arc(s, n, radius=2.0, centre=(3.0, 2.0)):
    angle = -0.8 + s / radius
    nr, nz = np.cos(angle), np.sin(angle)
    ones = np.ones(n)
    return MeridianPoints(
        (centre[0] + radius * nr) * ones, (centre[1] + radius * nz) * ones, nr * ones, nz * ones, ones / radius
    )


@pytest.fixture
def motion(rng):
    return random_motion(rng, 400)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_grazing_points_satisfy_the_envelope_condition(motion, sign):
    pose, meridian = motion(0.2), arc(1.0, 400)
    g = grazing_points(pose, meridian, np.full(400, sign))
    ok = g.exists
    assert 0.2 < ok.mean() < 1.0
    radial = g.point - pose.tip - meridian.z[:, None] * pose.axis
    q = g.point - pose.tip
    spin = np.cross(pose.axis, pose.axis_rate)
    velocity = pose.tip_rate + np.cross(spin, q)
    assert np.allclose(np.sum(g.normal * velocity, axis=1)[ok], 0.0, atol=1e-12)
    assert np.allclose(np.linalg.norm(radial, axis=1)[ok], meridian.r[ok])
    assert np.allclose(np.sum(g.normal * pose.axis, axis=1)[ok], meridian.nz[ok])
    centre = pose.tip_rate + (meridian.z - meridian.r * meridian.nz / meridian.nr)[:, None] * pose.axis_rate
    branch = np.sum(g.normal * np.cross(pose.axis, centre), axis=1)
    assert np.all(branch[ok] * sign >= 0.0)


def test_agrees_with_the_published_closed_form(motion):
    """Zhou 2.30: n from the velocity of the effective centre; an algebraically different route."""
    pose, meridian = motion(0.1), arc(2.0, 400)
    g = grazing_points(pose, meridian, np.ones(400))
    effective_radius = meridian.r / meridian.nr
    h = meridian.z - effective_radius * meridian.nz
    v = pose.tip_rate + h[:, None] * pose.axis_rate
    lv = np.cross(pose.axis, v)
    lv2, v2 = np.sum(lv * lv, axis=1), np.sum(v * v, axis=1)
    cosine = meridian.nz
    along = np.sum(pose.axis * v, axis=1)
    with np.errstate(invalid="ignore"):
        root = np.sqrt(lv2 - cosine**2 * v2)
    n = (cosine * v2 / lv2)[:, None] * pose.axis - (along * cosine / lv2)[:, None] * v + (root / lv2)[:, None] * lv
    assert np.array_equal(g.exists, np.isfinite(root))
    assert np.allclose(g.normal[g.exists], n[g.exists], atol=1e-12)
    surface = pose.tip + h[:, None] * pose.axis + effective_radius[:, None] * n
    assert np.allclose(g.point[g.exists], surface[g.exists], atol=1e-11)


def test_a_flat_disc_grazes_along_its_characteristic_line(motion):
    """nr = 0: the plane z = 0 of the tool; the contact satisfies l . velocity = 0 and lies in the plane."""
    n = 400
    meridian = MeridianPoints(*(np.full(n, x) for x in (2.5, 0.0, 0.0, -1.0, 0.0)))
    pose = motion(0.3)
    g = grazing_points(pose, meridian, np.ones(n))
    assert g.exists.any()
    q = (g.point - pose.tip)[g.exists]
    assert np.allclose(np.sum(q * pose.axis[g.exists], axis=1), 0.0, atol=1e-12)
    spin = np.cross(pose.axis, pose.axis_rate)[g.exists]
    velocity = pose.tip_rate[g.exists] + np.cross(spin, q)
    assert np.allclose(np.sum(velocity * pose.axis[g.exists], axis=1), 0.0, atol=1e-11)


@pytest.mark.parametrize("name", ["point", "normal"])
def test_derivatives_converge_with_second_order(motion, name):
    t, s, n = 0.2, 1.0, 400
    branch = np.ones(n)
    exact = grazing_points(motion(t), arc(s, n), branch)
    steps = [1e-2, 5e-3, 2.5e-3]
    errors = {"t": [], "s": []}
    for h in steps:
        for by, ends in (
            ("t", [(motion(t + d), arc(s, n)) for d in (h, -h)]),
            ("s", [(motion(t), arc(s + d, n)) for d in (h, -h)]),
        ):
            plus, minus = (grazing_points(*e, branch) for e in ends)
            difference = (getattr(plus, name) - getattr(minus, name)) / (2.0 * h)
            miss = np.linalg.norm(difference - getattr(exact, f"{name}_{by}"), axis=1)
            errors[by].append(np.nanmedian(miss))
    for by in errors:
        assert observed_order(errors[by], steps) == pytest.approx(2.0, abs=0.1)


def test_curvature_agrees_with_second_differences_of_points(motion):
    """Normal curvature along each parameter line from the points alone."""
    t, s, n, h = 0.2, 1.0, 400, 1e-3
    ones = np.ones(n)
    g = grazing_points(motion(t), arc(s, n), ones)
    c = g.curvature()
    out = -g.normal
    for by, ends in (
        ("s", [(motion(t), arc(s + d, n)) for d in (h, -h)]),
        ("t", [(motion(t + d), arc(s, n)) for d in (h, -h)]),
    ):
        plus, minus = (grazing_points(*e, ones).point for e in ends)
        second = np.sum(out * (plus - 2 * g.point + minus), axis=1) / h**2
        tangent = getattr(g, f"point_{by}")
        unit = tangent / np.linalg.norm(tangent, axis=1, keepdims=True)
        a, b = np.sum(unit * c.direction1, axis=1), np.sum(unit * c.direction2, axis=1)
        euler = (c.k1 * a**2 + c.k2 * b**2) * np.sum(tangent * tangent, axis=1)
        ok = g.exists & np.isfinite(second) & (np.abs(euler) < 50)
        relative = np.abs(second - euler)[ok] / (1.0 + np.abs(euler[ok]))
        assert np.median(relative) < 1e-5
        assert np.quantile(relative, 0.9) < 1e-3
