import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.solid import Block
from gearsim.geometry.turned import Turned

BLOCK = Block(np.array([-1.0, 0.0, 2.0]), np.array([3.0, 1.0, 5.0]))
RING = Turned(np.array([[2.0, -1.0], [5.0, 0.0], [4.0, 3.0], [2.0, 3.0]]))
SOLIDS = [BLOCK, RING]


def random_rays(rng, n=400):
    direction = rng.normal(size=(n, 3))
    return rng.uniform(-6, 6, (n, 3)), direction / np.linalg.norm(direction, axis=1)[:, None]


@pytest.mark.parametrize("solid", SOLIDS)
def test_chords_run_where_the_solid_contains_their_points(solid, rng):
    origins, directions = random_rays(rng)
    ray, start, end = solid.chords(origins, directions)
    assert len(ray) > 20
    assert np.all(end > start)
    assert np.all(np.diff(ray) >= 0)
    tau = rng.uniform(-15, 15, (len(origins), 60))
    inside = np.zeros(tau.shape, dtype=bool)
    for r, a, b in zip(ray, start, end, strict=True):
        inside[r] |= (tau[r] > a) & (tau[r] < b)
    points = origins[:, None] + tau[..., None] * directions[:, None]
    assert np.array_equal(inside, solid.contains(points))


@pytest.mark.parametrize("solid", SOLIDS)
def test_a_solid_fills_its_box_and_no_more(solid, rng):
    lower, upper = solid.box
    points = rng.uniform(lower - 1.0, upper + 1.0, (4000, 3))
    inside = solid.contains(points)
    assert np.all((points[inside] >= lower) & (points[inside] <= upper))
    distance = solid.signed_distance(points)
    assert np.array_equal(distance < 0.0, inside)
    for axis in range(3):  # something lies within a tenth of the box's length of each of its faces
        assert points[inside][:, axis].min() < lower[axis] + 0.1 * (upper - lower)[axis]
        assert points[inside][:, axis].max() > upper[axis] - 0.1 * (upper - lower)[axis]


@pytest.mark.parametrize("solid", SOLIDS)
def test_volume_is_that_of_its_chords(solid):
    lower, upper = solid.box
    n = 256
    y, z = (lower[k] + (upper - lower)[k] * (np.arange(n) + 0.5) / n for k in (1, 2))
    at = np.stack(np.meshgrid(y, z, indexing="ij"), axis=-1).reshape(-1, 2)
    origins = np.column_stack([np.full(len(at), lower[0] - 1.0), at])
    _, start, end = solid.chords(origins, np.tile([1.0, 0.0, 0.0], (len(at), 1)))
    cell = (upper - lower)[1] * (upper - lower)[2] / n**2
    assert cell * (end - start).sum() == pytest.approx(solid.volume, rel=1e-3)


def test_volumes_in_closed_form():
    assert BLOCK.volume == 12.0
    tube = Turned(np.array([[1.0, 0.0], [2.0, 0.0], [2.0, 5.0], [1.0, 5.0]]))
    assert tube.volume == pytest.approx(15.0 * np.pi, rel=1e-14)
    cone = Turned(np.array([[0.0, 0.0], [3.0, 0.0], [0.0, 4.0]]))
    assert cone.volume == pytest.approx(12.0 * np.pi, rel=1e-14)


def test_a_ray_in_a_face_belongs_to_the_lower_face_alone():
    origins = np.array([[-5.0, 0.0, 3.0], [-5.0, 1.0, 3.0], [-5.0, 0.5, 2.0], [-5.0, 0.5, 5.0]])
    ray, start, end = BLOCK.chords(origins, np.tile([1.0, 0.0, 0.0], (4, 1)))
    assert ray.tolist() == [0, 2]
    assert start.tolist() == [4.0, 4.0]
    assert end.tolist() == [8.0, 8.0]


def test_a_block_without_an_inside_is_refused():
    with pytest.raises(InputError, match="every upper coordinate must be the larger"):
        Block(np.zeros(3), np.array([1.0, 0.0, 1.0]))


@pytest.mark.parametrize("solid", [*SOLIDS, Turned(RING.polygon[::-1]), Turned(np.array([[0, 0], [3, 0], [0, 4.0]]))])
def test_normals_point_out_of_the_solid(solid, rng):
    """A step along the normal leaves the surface by its length, one against it goes in as far; but near edges."""
    origins, directions = random_rays(rng)
    ray, start, end = solid.chords(origins, directions)
    points = np.concatenate([origins[ray] + tau[:, None] * directions[ray] for tau in (start, end)])
    normals = solid.normals(points)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-14)
    for step in (1e-3, -1e-3):
        off = np.abs(solid.signed_distance(points + step * normals) - step) > 1e-9
        assert off.mean() < 0.01


def test_the_axis_is_no_face_and_edges_have_the_normal_of_a_face():
    disc = Turned(np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]]))
    assert np.allclose(disc.normals(np.array([[0.0, 0.0, 2.0], [0.0, 0.0, 0.0]])), [[0, 0, 1], [0, 0, -1]])
    assert np.isclose(disc.normals(np.array([[4.0, 0.0, 2.0]])) ** 2, 1.0).sum() == 1
    assert np.isclose(BLOCK.normals(np.array([[3.0, 1.0, 5.0]])) ** 2, 1.0).sum() == 1
