import numpy as np
import pytest

from gearsim.geometry.jets import Curvature
from gearsim.verify import principal
from gearsim.verify.differences import curvature_gap, differentiate

BIG, SMALL = 50.0, 4.0


def torus(u, v):
    """A torus of a gear's size; the first parameter runs round the axis, the second round the tube."""
    a, b = 1.5 * u, 5.0 * v
    ring = BIG + SMALL * np.cos(b)
    return np.stack([ring * np.cos(a), ring * np.sin(a), SMALL * np.sin(b)], axis=1)


def against_the_torus(points, u, v):
    """Differences, and how far their normals and curvatures are from the torus's."""
    a, b = 1.5 * u, 5.0 * v
    found = differentiate(points, u, v)
    outward = np.stack([np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)], axis=1)
    side = np.sign(np.sum(found.normal * outward, axis=1))
    expected = principal(side * -1.0 / SMALL, side * -np.cos(b) / (BIG + SMALL * np.cos(b)))
    angle = np.linalg.norm(np.cross(found.normal, outward), axis=1)
    return found, angle, curvature_gap(found.curvature, expected)


def test_a_torus_has_its_curvatures(rng):
    found, angle, gap = against_the_torus(torus, *rng.uniform(0.02, 0.98, size=(2, 300)))
    assert angle.max() < 1e-11
    assert gap.max() < 1e-9
    assert found.curvature_error.max() < 1e-9


@pytest.mark.parametrize("noise", [1e-12, 1e-9, 1e-6])
def test_the_error_told_is_that_of_the_differences(rng, noise):
    def rough(u, v):
        return torus(u, v) + noise * rng.normal(size=(len(u), 3))

    found, angle, gap = against_the_torus(rough, *rng.uniform(0.1, 0.9, size=(2, 300)))
    assert np.all(gap < 10.0 * found.curvature_error)
    assert np.quantile(angle / found.normal_error, 0.95) < 10.0
    assert np.median(found.curvature_error) < 5e3 * noise


def test_an_edge_of_regression_does_not_settle():
    """The tangents of a helix: across the helix itself, u = 1/2, the surface turns back."""

    def tangents(u, v):
        s, w = 4.0 * v, 10.0 * (u - 0.5)
        curve = np.stack([5.0 * np.cos(s), 5.0 * np.sin(s), 2.0 * s], axis=1)
        along = np.stack([-5.0 * np.sin(s), 5.0 * np.cos(s), np.full(len(s), 2.0)], axis=1)
        return curve + w[:, None] * along

    v = np.linspace(0.3, 0.7, 9)
    on, off = (differentiate(tangents, np.full(9, u), v) for u in (0.5, 0.8))
    assert np.all(on.curvature_error > 1e-6)
    assert np.all(off.curvature_error < 1e-7)


def test_only_points_of_the_chart_and_of_one_side_of_a_joint_are_asked_for(rng):
    asked = []

    def watched(u, v):
        asked.append((u, v))
        return torus(u, v)

    u, v = rng.uniform(0.4, 0.5, 50), rng.uniform(0.0, 1.0, 50)
    differentiate(watched, u, v, joints=(0.4, 0.5))
    for a, b in asked:
        assert np.all((a > 0.4) & (a < 0.5))
        assert np.all((b >= 0.0) & (b <= 1.0))


def test_a_missing_neighbour_leaves_the_finer_steps():
    def half(u, v):
        return np.where((u > 0.45)[:, None], torus(u, v), np.nan)

    found = differentiate(half, np.array([0.5, 0.4]), np.array([0.5, 0.5]))
    assert found.curvature_error[0] < 1e-6
    assert found.curvature_error[1] == np.inf


@pytest.mark.parametrize("name", ["gaussian", "mean", "k1", "k2"])
def test_the_gap_looks_at_every_curvature(name):
    one = principal(np.array([0.5]), np.array([-0.25]))
    values = {k: getattr(one, k) for k in ("gaussian", "mean", "k1", "k2", "direction1", "direction2")}
    other = Curvature(**{**values, name: values[name] + 1e-3})
    assert curvature_gap(other, one)[0] == pytest.approx(1e-3 / (0.25 if name == "gaussian" else 0.5))
