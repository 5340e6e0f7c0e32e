"""B-spline surfaces through grids of points, such as those of a machined flank."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.nurbs import surface_derivatives
from gearsim.surfaces.nurbs import NurbsSurface

_DEGREE = 3
_FEWEST = 2 * _DEGREE + 1
_STEPS = 6


class Fitted(NamedTuple):
    """A surface and how far [mm] the grid's points are from it, at most and by root mean square.

    Half of the rows and half of the columns are on it by construction; the others, three quarters of all points, say
    how it runs between them.
    """

    surface: NurbsSurface
    largest: float
    rms: float


def fit_grid(points: NDArray, name: str = "surface", flip: bool = False) -> Fitted:
    """The bicubic surface through every second row and column of a grid of points [mm], shape (m, n, 3).

    Interpolation in each direction with the mean chord lengths of all rows, or all columns, for parameters; not-a-knot
    at the ends. It follows noise as it follows the points, and swings no farther between them. ``flip`` as of
    NurbsSurface. Raises InputError for less than 7 rows or columns, points that are missing, and rows or columns that
    coincide.
    """
    grid = np.asarray(points, dtype=float)
    if grid.ndim != 3 or grid.shape[2] != 3 or min(grid.shape[:2]) < _FEWEST:
        raise InputError(f"{name}: a grid of at least {_FEWEST} x {_FEWEST} points is fitted, got {grid.shape[:2]}")
    missing = np.count_nonzero(~np.isfinite(grid).all(axis=2))
    if missing:
        raise InputError(
            f"{name}: {missing} of {grid[..., 0].size} points are missing; fit a part of the grid that is whole"
        )
    u, v = (_parameters(grid, axis, name) for axis in (0, 1))
    rows, columns = (np.append(np.arange(0, n - 1, 2), n - 1) for n in grid.shape[:2])
    from scipy.interpolate import make_interp_spline  # slow to load, and few surfaces are fitted

    along_u = make_interp_spline(u[rows], grid[np.ix_(rows, columns)], _DEGREE, axis=0)
    along_v = make_interp_spline(v[columns], along_u.c, _DEGREE, axis=1)
    poles = np.moveaxis(along_v.c, 0, 1)
    surface = NurbsSurface(_DEGREE, _DEGREE, along_u.t, along_v.t, poles, flip=flip, name=name)
    off = _distances(surface, grid, u, v)
    return Fitted(surface, float(off.max()), float(np.sqrt(np.mean(off**2))))


def whole_block(points: NDArray) -> tuple[slice, slice]:
    """The rows and columns that are left of a grid, shape (m, n, 3), once border lines with missing points are gone.

    The border line that lacks the most goes first. Points that are missing in the middle stay.
    """
    known = np.isfinite(points).all(axis=2)
    (top, left), (bottom, right) = (0, 0), known.shape
    while bottom > top and right > left:
        block = ~known[top:bottom, left:right]
        lacking = [float(line.mean()) for line in (block[0], block[-1], block[:, 0], block[:, -1])]
        worst = int(np.argmax(lacking))
        if lacking[worst] == 0.0:
            break
        top, bottom = top + (worst == 0), bottom - (worst == 1)
        left, right = left + (worst == 2), right - (worst == 3)
    return slice(top, bottom), slice(left, right)


def _parameters(grid: NDArray, axis: int, name: str) -> NDArray:
    """Shares of the mean length of the lines along an axis."""
    steps = np.linalg.norm(np.diff(grid, axis=axis), axis=2).mean(axis=1 - axis)
    if not np.all(steps > 0.0):
        row = int(np.argmin(steps))
        raise InputError(f"{name}: {('rows', 'columns')[axis]} {row + 1} and {row + 2} of the grid coincide")
    way = np.concatenate([[0.0], np.cumsum(steps)])
    return way / way[-1]


def _distances(surface: NurbsSurface, grid: NDArray, u: NDArray, v: NDArray) -> NDArray:
    """Distances of a grid's points from the surface, from their parameters on towards the nearest place."""
    at_u, at_v = (a.ravel() for a in np.meshgrid(u, v, indexing="ij"))
    points, least = grid.reshape(-1, 3), np.full(at_u.size, np.inf)
    for _ in range(_STEPS):
        r, ru, rv, *_rest = surface_derivatives(*surface.along, surface.net, at_u, at_v)
        off = points - r
        least = np.minimum(least, np.linalg.norm(off, axis=1))
        e, f, g, p, q = (np.einsum("ij,ij->i", *pair) for pair in ((ru, ru), (ru, rv), (rv, rv), (off, ru), (off, rv)))
        area = np.maximum(e * g - f * f, 1e-300)
        at_u = np.clip(at_u + (g * p - f * q) / area, 0.0, 1.0)
        at_v = np.clip(at_v + (e * q - f * p) / area, 0.0, 1.0)
    return least
