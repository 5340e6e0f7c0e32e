import numpy as np
import pytest

from gearsim.geometry.nearest import nearest_point, span
from gearsim.geometry.triangles import TriangleMesh
from tests.geometry.test_sections import cube, torus


def test_the_nearest_point_of_a_cube_is_the_place_held_to_it(rng):
    for place in rng.uniform(-1.0, 2.0, (200, 3)):
        point, triangle = nearest_point(cube(), place)
        expected = np.clip(place, 0.0, 1.0)
        if np.all(expected == place):  # inside: the nearest face
            axis = int(np.argmin(np.minimum(place, 1.0 - place)))
            expected[axis] = np.round(place[axis])
        assert np.allclose(point, expected, atol=1e-14)
        corners = cube().points[cube().triangles[triangle]]
        assert (
            abs(np.linalg.det(np.column_stack([corners[1] - corners[0], corners[2] - corners[0], point - corners[0]])))
            < 1e-14
        )


def test_corners_edges_and_triangles_without_area():
    flat = TriangleMesh(np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]), np.array([[0, 1, 2]]), np.zeros(1, int))
    assert np.array_equal(nearest_point(flat, np.array([1.5, 3.0, 0.0]))[0], [1.5, 0.0, 0.0])
    point = TriangleMesh(np.ones((3, 3)), np.array([[0, 1, 2]]), np.zeros(1, int))
    assert np.array_equal(nearest_point(point, np.zeros(3))[0], np.ones(3))
    with pytest.raises(ValueError, match="no triangles"):
        nearest_point(TriangleMesh(np.empty((0, 3)), np.empty((0, 3), int), np.empty(0, int)), np.zeros(3))


def test_a_span_is_measured_between_points_of_the_surface():
    found = span(cube(), (0.4, 0.5, -0.3), (0.4, 0.5, 1.2))
    assert found.distance == 1.0
    assert np.allclose(found.first, [0.4, 0.5, 0.0])
    across = span(torus(), (9.0, 0.0, 0.0), (-9.0, 0.0, 0.0))
    assert across.distance == pytest.approx(14.0, abs=1e-12)
