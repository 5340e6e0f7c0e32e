import numpy as np
import pytest

from gearsim.metrology.samples import sample_grid
from gearsim.metrology.topography import topography


@pytest.fixture(params=["convex", "concave"])
def grid(request, tooth):
    return sample_grid(tooth.flank(request.param), 5, 9, 0.1)


def turned(grid, angle):
    """Deviation [um] of a flank turned about the gear axis, by moving points: (moved - intended) . normal."""
    c, s = np.cos(angle), np.sin(angle)
    moved = grid.point @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]).T
    return 1e3 * np.einsum("ijk,ijk->ij", moved - grid.point, grid.normal)


@pytest.mark.parametrize("angle", [3e-5, -2e-5])
def test_a_turned_flank_is_a_pure_rotation(grid, angle):
    t = topography(grid, turned(grid, angle))
    assert np.abs(t.as_cut_um).max() > 0.5
    assert np.abs(t.mid_zeroed_um).max() < 2e-3
    assert np.abs(t.best_rotated_um).max() < 2e-3
    assert abs(t.best_rotation_um) == pytest.approx(1e3 * abs(angle) * t.mid_radius_mm, rel=1e-3)
    assert abs(np.radians(t.rotation_deg(t.mid_rotation_um))) == pytest.approx(abs(angle), rel=1e-3)


def test_a_patch_stays_five_micrometres_as_cut_and_when_the_mid_point_is_untouched(grid):
    patch = np.zeros(grid.shape)
    patch[3:, 6:] = 5.0
    t = topography(grid, patch)
    assert np.array_equal(t.as_cut_um, patch)
    assert np.allclose(t.mid_zeroed_um, patch)
    assert t.mid_rotation_um == 0.0


def test_best_rotation_leaves_least_squares(grid, rng):
    um = rng.normal(size=grid.shape)
    t = topography(grid, um)
    best = np.sum(t.best_rotated_um**2)
    per_arc = (um - t.best_rotated_um) / t.best_rotation_um
    for arc in (t.best_rotation_um * 1.01, t.best_rotation_um * 0.99):
        assert np.sum((um - arc * per_arc) ** 2) > best
    assert t.mid_zeroed_um[2, 4] == pytest.approx(0.0, abs=1e-12)


def test_unmeasured_points_stay_unmeasured(grid):
    um = np.ones(grid.shape)
    um[0, 0] = np.nan
    t = topography(grid, um)
    assert np.isnan(t.best_rotated_um[0, 0])
    assert np.isfinite(t.best_rotated_um).sum() == um.size - 1
