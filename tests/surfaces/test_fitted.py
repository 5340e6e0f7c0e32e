import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.output.step import write_step
from gearsim.surfaces.fitted import fit_grid
from gearsim.surfaces.nurbs_file import load_surfaces
from tests.gouging.cad_parts import in_process
from tests.helpers import observed_order
from tests.limits import files_no_larger_than


def flank(rows, columns, base=40.0, lead=600.0):
    """A helical involute flank of module 4: points, its distance function being that of the transverse involute."""
    roll, z = np.linspace(0.15, 0.5, rows)[:, None], np.linspace(0.0, 20.0, columns)[None, :]
    angle = roll + 2.0 * np.pi * z / lead
    x, y = base * (np.cos(angle) + roll * np.sin(angle)), base * (np.sin(angle) - roll * np.cos(angle))
    return np.stack([x, y, np.broadcast_to(z, x.shape)], axis=-1)


def off_flank(p, base=40.0, lead=600.0):
    """Distances along the transverse line of action [mm] from that flank."""
    r = np.hypot(p[:, 0], p[:, 1])
    roll = np.sqrt((r / base) ** 2 - 1.0)
    return base * (np.arctan2(p[:, 1], p[:, 0]) - roll + np.arctan(roll) - 2.0 * np.pi * p[:, 2] / lead)


def dense(surface, n=101):
    u, v = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(0.0, 1.0, n)], indexing="ij"))
    return surface.at(u, v)


def test_an_involute_flank_is_fitted_with_the_order_of_cubics():
    counts = np.array([9, 17, 33])
    fits = [fit_grid(flank(n, n)) for n in counts]
    stated, true = [f.largest for f in fits], [np.abs(off_flank(dense(f.surface))).max() for f in fits]
    assert observed_order(stated, 1.0 / (counts - 1)) > 3.5
    assert stated[-1] < 4e-6
    for said, is_so in zip(stated, true, strict=True):
        assert is_so < 1.5 * said
        assert said < 3.0 * is_so
    assert all(f.rms < f.largest for f in fits)


def test_every_second_row_and_column_lies_on_the_surface_also_of_even_counts():
    grid = flank(12, 15)
    fitted = fit_grid(grid)
    kept = grid[np.ix_([0, 2, 4, 6, 8, 10, 11], range(0, 15, 2))].reshape(-1, 3)
    places = dense(fitted.surface, 201)
    assert max(np.linalg.norm(places - p, axis=1).min() for p in kept) < 0.12  # half of the places' spacing
    assert np.allclose(places[[0, -1]], grid[[0, -1], [0, -1]], atol=1e-12)


def test_noise_swings_no_farther_than_cubics_do(rng):
    """5 um of noise on a plane of 30 x 30 points, with which another fit swings by hundreds of metres."""
    x, y = np.meshgrid(np.arange(30.0), np.arange(30.0), indexing="ij")
    fitted = fit_grid(np.stack([x, y, 0.005 * rng.normal(size=x.shape)], axis=-1))
    assert np.abs(dense(fitted.surface)[:, 2]).max() < 0.04
    assert 0.004 < fitted.rms < 0.01


def test_what_cannot_be_fitted_is_refused():
    grid = flank(9, 9)
    with pytest.raises(InputError, match="flank: a grid of at least 7 x 7 points is fitted, got \\(6, 9\\)"):
        fit_grid(grid[:6], "flank")
    grid[3, 4] = np.nan
    with pytest.raises(InputError, match="flank: 1 of 81 points are missing"):
        fit_grid(grid, "flank")
    grid = flank(9, 9)
    grid[:, 5] = grid[:, 4]
    with pytest.raises(InputError, match="columns 5 and 6 of the grid coincide"):
        fit_grid(grid)


def test_step_keeps_control_nets_and_sides(tmp_path, monkeypatch, capfd):
    in_process(monkeypatch)
    surfaces = [fit_grid(flank(9, 11), "left").surface, fit_grid(flank(11, 9) * [1, -1, 1], "right", flip=True).surface]
    write_step(surfaces, tmp_path / "tooth.step")
    assert capfd.readouterr().out == ""
    for ours, read in zip(surfaces, load_surfaces(tmp_path / "tooth.step"), strict=True):
        assert np.allclose(read.points, ours.points, rtol=0.0, atol=1e-11)
        assert np.allclose(read.knots_u, ours.knots_u, atol=1e-11)
        assert np.allclose(read.knots_v, ours.knots_v, atol=1e-11)
        assert (read.degree_u, read.degree_v, read.flip) == (3, 3, ours.flip)
    with files_no_larger_than(4096), pytest.raises(InputError, match="cannot write STEP file"):
        write_step(surfaces, tmp_path / "other.step")
    assert [f.name for f in tmp_path.iterdir()] == ["tooth.step"]
