"""Where a plane cuts a surface that is known on a grid of points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_ROUNDING = 1e-9  # of a spacing: places on lines of the grid come back that near to them


def cut_grid(grid: NDArray, point: NDArray, normal: NDArray, values: NDArray) -> list[tuple[NDArray, NDArray]]:
    """Curves in which a plane cuts a surface through a ``grid`` of points [mm], shape (m, n, 3).

    ``point`` [mm] and unit ``normal`` of the plane, shape (3,). Of each curve its points [mm], shape (k, 3), and the
    ``values``, (m, n), there, nan where they are not known. Between points the surface runs straight: of a curvature
    radius R and a spacing h it is missed by h² / 8 R. Where the grid has holes (nan) curves end.
    """
    from contourpy import contour_generator

    height = np.ma.masked_invalid((grid - point) @ normal)
    out = []
    for found in contour_generator(z=height).lines(0.0):
        line = np.asarray(found, dtype=float)
        whole = np.round(line)
        column, row = np.where(np.abs(line - whole) < _ROUNDING, whole, line).T
        out.append((_between(grid, row, column), _between(values[..., None], row, column)[:, 0]))
    return out


def _between(grid: NDArray, row: NDArray, column: NDArray) -> NDArray:
    """Of a grid, shape (m, n, k), what lies at places that are whole numbers in one of row and column at least."""
    low_row, low_column = np.floor(row).astype(int), np.floor(column).astype(int)
    high_row, high_column = np.ceil(row).astype(int), np.ceil(column).astype(int)
    low, high = grid[low_row, low_column], grid[high_row, high_column]
    share = np.maximum(row - low_row, column - low_column)[:, None]
    return np.asarray(np.where(share > 0.0, (1.0 - share) * low + share * high, low))
