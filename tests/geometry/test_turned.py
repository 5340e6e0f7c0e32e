import numpy as np
import pytest

from gearsim.geometry.turned import Turned

RING = Turned(np.array([[5.0, 0.0], [9.0, 1.0], [8.0, 4.0], [4.0, 3.0]]))


def random_rays(rng, n):
    origin, target = rng.uniform(-12, 12, (2, n, 3))
    direction = target - origin
    return origin, direction / np.linalg.norm(direction, axis=1, keepdims=True)


def test_chords_hold_exactly_the_points_inside(rng):
    origin, direction = random_rays(rng, 500)
    ray, start, end = RING.chords(origin, direction)
    tau = rng.uniform(-30, 30, (500, 200))
    inside = RING.contains(origin[:, None] + tau[..., None] * direction[:, None])
    covered = np.zeros(tau.shape, dtype=bool)
    for i, a, b in zip(ray, start, end, strict=True):
        covered[i] |= (tau[i] > a) & (tau[i] < b)
    assert np.array_equal(inside, covered)
    assert inside.any()


def test_chord_ends_lie_on_the_boundary(rng):
    origin, direction = random_rays(rng, 500)
    ray, start, end = RING.chords(origin, direction)
    for tau in (start, end):
        p = origin[ray] + tau[:, None] * direction[ray]
        near = [RING.contains(p + s * 1e-7 * direction[ray]) for s in (-1.0, 1.0)]
        assert np.mean(near[0] != near[1]) > 0.99


def test_volume_from_parallel_chords_is_that_of_pappus():
    """Guldin: volume = 2 pi (first moment of the polygon about the axis)."""
    h = 0.05
    grid = np.arange(-9.5, 9.5, h) + 0.5 * h
    x, y = (g.ravel() for g in np.meshgrid(grid, grid))
    origin = np.column_stack([x, y, np.full(x.size, -1.0)])
    _, start, end = RING.chords(origin, np.tile([0.0, 0.0, 1.0], (x.size, 1)))
    r, z = RING.polygon.T
    r2, z2 = np.roll(r, -1), np.roll(z, -1)
    moment = np.abs(np.sum((r + r2) * (r * z2 - r2 * z)) / 6.0)
    assert h * h * np.sum(end - start) == pytest.approx(2.0 * np.pi * moment, rel=2e-5)


def test_rays_parallel_to_a_flat_face_are_handled():
    flat = Turned(np.array([[0.0, 0.0], [5.0, 0.0], [5.0, 2.0], [0.0, 2.0]]))
    _, start, end = flat.chords(np.array([[-9.0, 1.0, 1.0]]), np.array([[1.0, 0.0, 0.0]]))
    half = np.sqrt(24.0)
    assert np.allclose([start[0], end[0]], [9.0 - half, 9.0 + half])
