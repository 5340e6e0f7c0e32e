"""What a cell of voxels holds, against NumPy twins that look at many points of it."""

import numpy as np
import pytest
import warp as wp

from gearsim.kernels.voxel_volume import Corners, below_zero, cell_share, certain_shares

F64 = wp.float64
SPACING = np.array([0.3, 0.2, 0.25])
CORNER = np.stack(np.meshgrid([0, 1], [0, 1], [0, 1], indexing="ij"), axis=-1).reshape(8, 3)


@wp.kernel(enable_backward=False)
def cell_kernel(
    corner: wp.array2d(dtype=F64), spacing: wp.vec3d, error: F64, share: wp.array2d(dtype=F64),
):  # fmt: skip
    i = wp.tid()
    d = Corners()
    for c in range(8):
        d[c] = corner[i, c]
    bounds = certain_shares(d, spacing, error)
    share[i, 0] = cell_share(d)
    share[i, 1] = bounds[0]
    share[i, 2] = bounds[1]
    share[i, 3] = below_zero(d[0], d[1], d[3], d[7], F64(0.5))


def shares(corner, device, error=0.0):
    """Estimate, least, most, and the share of the tetrahedron 0 1 3 7."""
    out = wp.zeros((len(corner), 4), dtype=F64, device=device)
    given = [wp.array(corner, dtype=F64, device=device), wp.vec3d(*SPACING), error]
    wp.launch(cell_kernel, len(corner), inputs=given, outputs=[out], device=device)
    return out.numpy().T


def test_a_tetrahedron_below_zero_is_what_random_points_say(rng, device):
    corner = rng.normal(size=(60, 8))
    weight = rng.dirichlet(np.ones(4), 20000)
    sampled = (weight @ corner[:, [0, 1, 3, 7]].T < 0.0).mean(axis=0)
    np.testing.assert_allclose(shares(corner, device)[3], sampled, atol=0.02)


def test_a_plane_through_a_cell_is_met_exactly(rng, device):
    normal = rng.normal(size=(50, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    corner = (CORNER - 0.5) * SPACING @ normal.T + rng.uniform(-0.1, 0.1, 50)
    points = (rng.random((40000, 3)) - 0.5) * SPACING
    sampled = (points @ normal.T + corner.mean(axis=0) < 0.0).mean(axis=0)
    estimate, least, most, _ = shares(corner.T, device)
    np.testing.assert_allclose(estimate, sampled, atol=0.015)
    assert np.all(least <= estimate + 1e-12)
    assert np.all(estimate <= most + 1e-12)
    assert (least > 0.0).any()
    assert (most < 1.0).any()


def test_certain_parts_are_those_in_the_corners_balls(rng, device):
    corner, error = rng.uniform(-0.4, 0.4, (50, 8)), 0.01
    part = (np.stack(np.meshgrid(*3 * [np.arange(3)], indexing="ij"), axis=-1).reshape(27, 3) + 0.5) / 3.0 * SPACING
    aside = np.linalg.norm(part[:, None] - CORNER * SPACING, axis=2)
    outer = 0.5 * np.linalg.norm(SPACING / 3.0) + error
    least = ((corner[:, None] + aside).min(axis=2) <= -outer).mean(axis=1)
    most = ((corner[:, None] - aside).max(axis=2) < outer).mean(axis=1)
    found = shares(corner, device, error)
    np.testing.assert_allclose(found[1], least, atol=1e-12)
    np.testing.assert_allclose(found[2], most, atol=1e-12)


@pytest.mark.parametrize(("rest", "share"), [(-1.0, 1.0), (0.0, 0.5), (1.0, 0.0)])
def test_a_cell_with_corners_on_the_surface_belongs_to_the_rest(rest, share, device):
    corner = np.zeros((8, 8))
    corner[np.arange(8), np.arange(8)] = rest
    np.testing.assert_allclose(shares(corner, device)[0], share, atol=1e-15)
