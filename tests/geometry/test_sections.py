import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.sections import section
from gearsim.geometry.triangles import TriangleMesh
from tests.conftest import random_rotation


def torus(large=5.0, small=2.0, n=160, m=80):
    """A torus about z, its points on the surface."""
    u, v = np.meshgrid(*(2 * np.pi * np.arange(k) / k for k in (n, m)), indexing="ij")
    r = large + small * np.cos(v)
    points = np.stack([r * np.cos(u), r * np.sin(u), small * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = (a.ravel() for a in np.indices((n, m)))
    a, b, c, d = i * m + j, (i + 1) % n * m + j, (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
    triangles = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return TriangleMesh(points, triangles, np.zeros(len(triangles), dtype=int))


def cube():
    """The unit cube."""
    points = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
    squares = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    triangles = np.array([t for a, b, c, d in squares for t in ((a, b, c), (a, c, d))])
    return TriangleMesh(points, triangles, np.zeros(12, dtype=int))


def test_meshes_for_these_tests_are_closed_and_outward():
    assert cube().open_edges == torus().open_edges == 0
    assert cube().volume == pytest.approx(1.0)
    assert torus().volume == pytest.approx(2.0 * np.pi**2 * 5.0 * 4.0, rel=2e-3)
    assert (cube().euler, torus().euler) == (2, 0)


def test_a_torus_has_an_outer_loop_and_a_hole():
    found = section(torus(), (0.0, 0.0, 0.7), (0.0, 0.0, 3.0))
    half = np.sqrt(4.0 - 0.49)
    expected = [np.pi * (5.0 + half) ** 2, -np.pi * (5.0 - half) ** 2]
    assert sorted(found.loop_areas, reverse=True) == pytest.approx(expected, rel=2e-3)
    assert found.area == pytest.approx(4.0 * np.pi * 5.0 * half, rel=2e-3)
    assert all(np.allclose(loop[:, 2], 0.7, atol=1e-12) for loop in found.loops)
    assert sorted(found.lengths) == pytest.approx([2 * np.pi * (5.0 - half), 2 * np.pi * (5.0 + half)], rel=2e-3)


def test_seen_from_the_other_side_loops_turn_the_other_way_and_areas_stay():
    there, back = (section(torus(), (1.0, 0.3, 0.1), n) for n in ((0.2, 0.9, 0.3), (-0.2, -0.9, -0.3)))
    assert there.area == pytest.approx(back.area, rel=1e-12)
    assert len(there.loops) == len(back.loops) == 2
    assert min(there.loop_areas) > 0.0


def test_sections_turn_with_the_body(rng):
    body, turn, shift = torus(), random_rotation(rng), np.array([1e4, -30.0, 7.0])
    moved = TriangleMesh(body.points @ turn.T + shift, body.triangles, body.tag)
    point, normal = np.array([0.5, 0.2, 0.3]), np.array([0.3, 0.1, 1.0])
    a, b = section(body, point, normal), section(moved, turn @ point + shift, turn @ normal)
    assert b.area == pytest.approx(a.area, rel=1e-9)
    assert sorted(b.lengths) == pytest.approx(sorted(a.lengths), rel=1e-9)


def test_planes_through_corners_edges_and_faces():
    """Corners in the plane are above it; what touches it from above is no section."""
    assert section(cube(), (0, 0, 1), (0, 0, 1)).area == pytest.approx(1.0)
    assert section(cube(), (0, 0, 0), (0, 0, 1)).loops == ()
    assert section(cube(), (0, 0, 0), (1, -1, 0)).area == pytest.approx(np.sqrt(2.0))
    assert section(cube(), (1, 1, 1), (1, 1, 1)).loops == ()
    assert section(cube(), (1, 0, 0), (1, 1, 1)).area == pytest.approx(np.sqrt(3.0) / 2.0)
    assert section(cube(), (0, 0, 5), (0, 0, 1)).loops == ()


@pytest.mark.parametrize(("point", "normal"), [((0, 0, 0), (0, 0, 0)), ((0, 0), (0, 0, 1)), ((0, 0, 0), (0, np.nan, 1)),
                                               ((np.inf, 0, 0), (0, 0, 1))])  # fmt: skip
def test_what_is_no_plane_is_refused(point, normal):
    with pytest.raises(InputError, match="wanted are 3 numbers each, the normal not 0"):
        section(cube(), point, normal)
