import numpy as np
import pytest
from scipy.optimize import fsolve

from gearsim.metrology.closest import signed_distance
from gearsim.metrology.samples import profile_rays, sample_grid
from gearsim.surfaces.patch import SIDES
from tests.surfaces.test_face_milled import make_face_milled


def test_the_inspection_grid_keeps_its_margins(tooth):
    blank = tooth.blank
    grid = sample_grid(tooth.flank("convex"), 5, 9, 0.1)
    assert grid.shape == (5, 9)
    cone, _ = blank.cone_height(grid.point)
    expected = blank.toe + blank.face_width * np.linspace(0.1, 0.9, 9)
    assert np.allclose(cone, np.broadcast_to(expected, (5, 9)), atol=1e-11)
    assert np.allclose(cone[2, 4], blank.mean)


def test_windows_are_half_the_slot_and_half_the_tooth(tooth):
    """Across the slot at one height, walking both windows from either wall fills one pitch."""
    for side in ("convex", "concave"):
        grid = sample_grid(tooth.flank(side), 5, 9)
        radius = np.hypot(grid.point[..., 0], grid.point[..., 1])
        normal_pitch = 2.0 * np.pi * radius / tooth.blank.teeth * np.cos(np.radians(32.0))
        mean = 4  # the column where the spiral angle is 32 degrees
        assert np.allclose(2.0 * (grid.inward + grid.outward)[:, mean], normal_pitch[:, mean], rtol=0.02)
        assert grid.inward.min() > 0.5
        assert np.allclose(sample_grid(tooth.flank(side), 5, 9, window=2.0).inward, 2.0 * grid.inward)


def test_windows_end_at_the_blank(tooth):
    """Near the tip a normal soon leaves the face cone; at its window's end it is just outside the stock."""
    grid = sample_grid(tooth.flank("convex"), 9, 9, 0.01)
    tip = grid.rays().part(slice(-9, None))
    assert tip.end.max() < 0.5
    for step, inside in ((-1e-6, True), (1e-6, False)):
        ends = tip.origin + (tip.end + step)[:, None] * tip.direction
        assert np.all(tooth.blank.stock.contains(ends) == inside)


def test_rays_run_along_the_normals_row_by_row(tooth):
    grid = sample_grid(tooth.flank("concave"), 3, 4)
    rays = grid.rays()
    assert len(rays) == 12
    assert np.array_equal(rays.origin[5], grid.point[1, 1])
    assert np.array_equal(rays.direction[5], grid.normal[1, 1])
    assert np.array_equal(rays.start[5], -grid.inward[1, 1])


def section(patch, origin, across, up, heights):
    """Flank points in the plane through ``origin`` at heights along ``up``, by MINPACK from height to height."""
    at, points = np.array([p[0] for p in patch.locate(np.array([0.5]), np.array([0.3]))]), []
    for height in heights:
        at = fsolve(
            lambda p, h=height: [(r := patch.jet(*p[:, None]).r[0] - origin) @ across, r @ up - h], at, xtol=1e-11
        )
        points.append(patch.jet(*at[:, None]).r[0])
    return np.array(points)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("family", ["ruled", "face-milled"])
def test_profile_rays_stand_on_the_section_through_the_mean_point(tooth, family, side):
    """Points and directions from the section alone: a fine polyline's tangents, turned out of the material.

    The plane stands on the lengthwise curve's mean point: the face-milled slot's is the middle between its walls on the
    pitch cone.
    """
    offsets, contact = np.array([-2.0, -0.5, 0.0, 0.5, 2.0]), 4.366
    slot = tooth if family == "ruled" else make_face_milled()
    patch, blank, bottom = slot.flank(side), slot.blank, slot.bottom
    middle = bottom.jet(*bottom.locate(np.array([0.5]), np.array([0.5]))).r[0]
    origin, heights = middle, contact + offsets
    if family == "face-milled":
        walls = (slot.flank(s) for s in SIDES)
        on_cone = sum(w.jet(*w.meet(np.array([blank.mean]), np.array([0.0]))).r[0] for w in walls)
        sine, cosine = np.sin(blank.pitch), np.cos(blank.pitch)
        azimuth = on_cone[:2] / np.linalg.norm(on_cone[:2])
        pitch_point = blank.mean * np.array([*(sine * azimuth), cosine])
        origin = pitch_point - float(blank.dedendum_at(blank.mean)) * np.array([*(cosine * azimuth), -sine])
    across, up = blank.cone_directions(origin)
    normal, in_plane = profile_rays(patch, offsets, contact)
    step = 1e-4
    before, points, after = (section(patch, origin, across, up, heights + s) for s in (-step, 0.0, step))
    turned = np.cross(after - before, across) / np.linalg.norm(after - before, axis=1)[:, None]
    turned *= np.sign(np.sum(turned * (middle + 8.0 * up - points), axis=1))[:, None]
    assert np.allclose(normal.origin, points, atol=1e-10)
    assert np.array_equal(normal.origin, in_plane.origin)
    assert np.allclose(in_plane.direction, turned, atol=1e-7)
    assert np.allclose(np.sum(normal.direction * turned, axis=1) ** 2 + (normal.direction @ across) ** 2, 1.0)


@pytest.mark.parametrize("name", ["convex", "concave fillet", "bottom"])
def test_signed_distance_finds_the_offset_point(tooth, rng, name):
    patch = next(p for p in tooth.patches if p.name == name)
    grid = sample_grid(patch, 15, 61)
    phi, v = patch.locate(rng.uniform(0.1, 0.9, 200), rng.uniform(0.1, 0.9, 200))
    jet = patch.jet(phi, v)
    offset = rng.uniform(-0.3, 0.3, 200)
    distance, found_phi, found_v = signed_distance(grid, jet.r + offset[:, None] * jet.normal)
    assert np.allclose(distance, offset, atol=1e-11)
    assert np.allclose(found_phi, phi, atol=1e-9)
    assert np.allclose(found_v, v, atol=1e-9)
    assert np.isnan(signed_distance(grid, np.array([[500.0, 0.0, 0.0]]))[0][0])
