import numpy as np
import pytest

from gearsim.geometry.turned import Turned
from gearsim.geometry.wedge import Wedge

RING = Turned(np.array([[2.0, -1.0], [5.0, 0.0], [4.0, 3.0], [2.0, 3.0]]))
WEDGES = [Wedge(RING, 0.7, 0.4), Wedge(RING, -2.5, 0.1), Wedge(RING, 3.1, 0.5 * np.pi)]


@pytest.mark.parametrize("wedge", WEDGES)
def test_chords_run_where_the_sector_contains_their_points(wedge, rng):
    middle = 3.5 * np.array([np.cos(wedge.middle), np.sin(wedge.middle), 0.3])
    origins = middle + rng.normal(0.0, 2.0, (400, 3))
    directions = rng.normal(size=(400, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    ray, start, end = wedge.chords(origins, directions)
    assert len(ray) > 20
    tau = rng.uniform(-12, 12, (400, 60))
    inside = np.zeros(tau.shape, dtype=bool)
    for r, a, b in zip(ray, start, end, strict=True):
        inside[r] |= (tau[r] > a) & (tau[r] < b)
    points = origins[:, None] + tau[..., None] * directions[:, None]
    assert np.array_equal(inside, wedge.contains(points))
    assert np.array_equal(wedge.signed_distance(points.reshape(-1, 3)) < 0.0, wedge.contains(points).ravel())


def test_sectors_all_round_hold_every_point_once(rng):
    points = rng.uniform(-5, 5, (5000, 3))
    points[:5] = [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [-3.0, 0.0, 0.0], [0.0, -3.0, 0.0], [4.0, 0.0, 1.0]]
    sectors = [Wedge(RING, 0.5 * np.pi * k + 0.25 * np.pi, 0.25 * np.pi) for k in range(4)]
    count = sum(s.contains(points).astype(int) for s in sectors)
    assert np.array_equal(count[5:], RING.contains(points[5:]).astype(int))
    assert sum(s.volume for s in sectors) == pytest.approx(RING.volume)


@pytest.mark.parametrize("wedge", WEDGES)
def test_normals_are_the_gradient_of_the_distance(wedge, rng):
    middle = 3.5 * np.array([np.cos(wedge.middle), np.sin(wedge.middle), 0.3])
    points = middle + rng.normal(0.0, 0.8, (300, 3))
    inside = points[wedge.contains(points)]
    normals, step = wedge.normals(inside), 1e-7
    slope = np.stack([(wedge.signed_distance(inside + step * e) - wedge.signed_distance(inside - step * e)) / (2 * step)
                      for e in np.eye(3)], axis=1)  # fmt: skip
    smooth = np.linalg.norm(slope, axis=1) > 0.999
    assert smooth.sum() > 20
    assert np.allclose(normals[smooth], slope[smooth], atol=1e-5)


@pytest.mark.parametrize("wedge", WEDGES)
def test_the_box_about_x_holds_the_turned_sector(wedge, rng):
    points = rng.uniform(-5, 5, (20000, 3))
    points = points[wedge.contains(points)]
    c, s = np.cos(wedge.middle), np.sin(wedge.middle)
    turned = points @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    lower, upper = wedge.box
    assert np.all((turned >= lower) & (turned <= upper))
