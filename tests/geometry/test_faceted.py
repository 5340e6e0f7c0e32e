"""Solids of triangles: rays through corners, edges and faces see what a block or a turned body of that form shows."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.faceted import Faceted
from gearsim.geometry.solid import Block
from gearsim.geometry.triangles import TriangleMesh
from gearsim.geometry.turned import Turned

FACES = np.array([[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4],
                  [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]])  # fmt: skip
BLOCK = Block(np.array([-1.0, 0.0, 2.0]), np.array([3.0, 1.0, 5.0]))
OUTLINE = np.array([[2.0, -1.0], [5.0, 0.0], [4.0, 3.0], [2.0, 3.0]])


def surface(points, triangles):
    return TriangleMesh(np.array(points, dtype=float), np.array(triangles), np.full(len(triangles), -1))


def block(lower, upper):
    corners = np.array([[(upper if i >> k & 1 else lower)[k] for k in range(3)] for i in range(8)])
    return surface(corners, FACES)


def revolved(outline, n):
    """A turned body's outline at n angles, its corners on it."""
    k, angle = len(outline), 2.0 * np.pi * np.arange(n) / n
    r, z = outline.T
    points = np.stack([np.outer(np.cos(angle), r), np.outer(np.sin(angle), r), np.tile(z, (n, 1))], axis=-1)
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(k), indexing="ij"))
    after, over = (i + 1) % n, (j + 1) % k
    a, b, c, d = i * k + j, after * k + j, after * k + over, i * k + over
    return surface(points.reshape(-1, 3), np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])]))


SOLID = Faceted(block(BLOCK.lower, BLOCK.upper))
RING = Faceted(revolved(OUTLINE, 48))


def lattice(axis, sense, low=-6.0, high=6.0, step=0.5):
    at = np.arange(low, high + step, step)
    origins = np.stack(np.meshgrid(at, at, [-9.0 * sense], indexing="ij"), axis=-1).reshape(-1, 3)
    return np.roll(origins, axis - 2, axis=1), np.tile(sense * np.eye(3)[axis], (len(origins), 1))


@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_rays_in_faces_and_edges_and_through_corners_see_what_a_block_shows(axis, sense, rng):
    origins, directions = lattice(axis, sense)
    meant = BLOCK.chords(origins, directions)
    assert len(meant[0]) > 8
    found = SOLID.chords(origins, directions)
    assert all(np.array_equal(a, b) for a, b in zip(found, meant, strict=True))
    few = rng.permutation(len(origins))[:60]  # in no rows
    found, meant = (s.chords(origins[few], directions[few]) for s in (SOLID, BLOCK))
    assert all(np.array_equal(a, b) for a, b in zip(found, meant, strict=True))


def test_rays_of_any_direction_through_corners_and_edges_lose_and_gain_nothing(rng):
    """From places all about to corners, middles of edges and points of faces: as long inside as in the block."""
    corners = SOLID.mesh.points
    goals = np.concatenate([corners, 0.5 * (corners[:, None] + corners).reshape(-1, 3)])
    origins = np.repeat(rng.uniform(-9.0, 9.0, (40, 3)), len(goals), axis=0)
    way = np.tile(goals, (40, 1)) - origins
    directions = way / np.linalg.norm(way, axis=1)[:, None]
    lengths = []
    for solid in (SOLID, BLOCK):
        ray, start, end = solid.chords(origins, directions)
        lengths.append(np.bincount(ray, end - start, minlength=len(origins)))
    assert lengths[1].max() > 4.0
    assert np.allclose(*lengths, atol=1e-13)


def test_points_on_its_faces_belong_to_it_as_to_a_block(rng):
    points = np.round(rng.uniform(-2, 6, (3000, 3)))
    assert np.array_equal(SOLID.contains(points), BLOCK.contains(points))
    points = rng.uniform(-2, 6, (500, 3))
    assert np.allclose(SOLID.signed_distance(points), BLOCK.signed_distance(points), atol=1e-14)
    assert (SOLID.volume, *np.concatenate(SOLID.box)) == (12.0, -1, 0, 2, 3, 1, 5)


def test_a_faceted_ring_is_the_turned_one_within_its_chords(rng):
    turned, chord = Turned(OUTLINE), 5.0 * (1.0 - np.cos(np.pi / 48))
    assert RING.volume == pytest.approx(turned.volume * np.sin(2.0 * np.pi / 48) / (2.0 * np.pi / 48), rel=1e-12)
    points = rng.uniform(-6, 6, (400, 3))
    off = RING.signed_distance(points) - turned.signed_distance(points)
    assert -chord <= off.min() <= off.max() <= chord
    origins, directions = lattice(2, 1.0)
    ray, _, end = RING.chords(origins, directions)
    assert np.allclose(end, 12.0 - np.maximum(0.0, np.hypot(*origins[ray, :2].T) - 4.0) * 3.0, atol=4.0 * chord)
    flat = np.hypot(*origins[ray, :2].T) < 3.9
    assert set(end[flat]) == {12.0}  # of the flat face, rays in edges of its triangles too, exactly


def test_chords_run_where_it_contains_their_points(rng):
    origins = rng.uniform(-6, 6, (300, 3))
    way = rng.normal(size=(300, 3))
    directions = way / np.linalg.norm(way, axis=1)[:, None]
    ray, start, end = RING.chords(origins, directions)
    tau = rng.uniform(-15, 15, (300, 40))
    inside = np.zeros(tau.shape, dtype=bool)
    for r, a, b in zip(ray, start, end, strict=True):
        inside[r] |= (tau[r] > a) & (tau[r] < b)
    assert np.array_equal(inside, RING.contains(origins[:, None] + tau[..., None] * directions[:, None]))


@pytest.mark.parametrize("solid", [SOLID, RING])
def test_normals_are_those_of_the_face_that_was_met(solid, rng):
    origins, directions = lattice(0, 1.0, step=0.37)
    ray, start, end = solid.chords(origins, directions)
    points = np.concatenate([origins[ray] + t[:, None] * directions[ray] for t in (start, end)])
    for some in (points, points[rng.permutation(len(points))[:40]] + 1e-3):
        normals = solid.normals(some)
        assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-14)
    into = np.einsum("ij,ij->i", solid.normals(points), np.tile(directions[ray], (2, 1)))
    assert (into[: len(ray)] < 0.0).all()
    assert (into[len(ray) :] > 0.0).all()


def test_a_cavity_is_no_material_and_bodies_that_touch_are_one():
    inner = block(np.array([0.0, 0.25, 3.0]), np.array([1.0, 0.75, 4.0]))
    hollow = surface(
        np.concatenate([SOLID.mesh.points, inner.points]), np.concatenate([FACES, inner.triangles[:, ::-1] + 8])
    )
    ray, start, end = Faceted(hollow).chords(np.array([[-5.0, 0.5, 3.5]]), np.array([[1.0, 0.0, 0.0]]))
    assert (start.tolist(), end.tolist()) == ([4.0, 6.0], [5.0, 8.0])
    beside = block(np.array([3.0, 0.0, 2.0]), np.array([4.0, 1.0, 5.0]))
    both = surface(np.concatenate([SOLID.mesh.points, beside.points]), np.concatenate([FACES, FACES + 8]))
    ray, start, end = Faceted(both).chords(np.array([[-5.0, 0.5, 3.5]]), np.array([[1.0, 0.0, 0.0]]))
    assert (ray.tolist(), start.tolist(), end.tolist()) == ([0], [4.0], [9.0])


def test_surfaces_that_bound_no_solid_are_refused():
    points = SOLID.mesh.points
    cases = [
        (FACES[:0], "it has no triangles"),
        (FACES[:-1], r"its surface is not closed, first at an edge about \(3, "),
        (np.concatenate([FACES[:-1], FACES[-1:, ::-1]]), "triangles do not join in one sense"),
        (FACES[:, ::-1], "is inside out or flat, its volume is -12 mm³"),
    ]
    for triangles, message in cases:
        with pytest.raises(InputError, match=message):
            Faceted(surface(points, triangles))


def test_a_surface_that_crosses_itself_is_refused_where_a_ray_sees_it():
    other = block(np.array([2.0, 0.0, 2.0]), np.array([6.0, 1.0, 5.0]))
    crossing = Faceted(surface(np.concatenate([SOLID.mesh.points, other.points]), np.concatenate([FACES, FACES + 8])))
    with pytest.raises(InputError, match=r"\(2.5, 0.5, 3.5\) mm lies twice within its surface"):
        crossing.chords(np.array([[-5.0, 0.5, 3.5]]), np.array([[1.0, 0.0, 0.0]]))
    small = block(np.array([4.0, 0.0, 2.0]), np.array([5.0, 1.0, 5.0]))
    points = np.concatenate([SOLID.mesh.points, small.points])
    inverted = Faceted(surface(points, np.concatenate([FACES, FACES[:, ::-1] + 8])))
    with pytest.raises(InputError, match=r"\(4.5, 0.5, 3.5\) mm lies within a surface that is inside out"):
        inverted.chords(np.array([[-5.0, 0.5, 3.5]]), np.array([[1.0, 0.0, 0.0]]))
