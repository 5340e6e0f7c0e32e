"""Fewer triangles of a shape, for looking at it: points that share a cell of a lattice become one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearsim.output.shapes import Classes, Colouring, Shape, Values

_COARSER = 1.25  # from one try to the next


def thinned(shape: Shape, most: int) -> tuple[Shape, float]:
    """A shape of at most so many triangles, and the edge [mm] of the cells in which points became one; else itself, 0.

    No point moves by more than the cell's diagonal. Where points become one, the value farthest from 0 stays, and a
    missing one before all: what is out of tolerance or was not measured cannot vanish.
    """
    if len(shape.triangles) <= most:
        return shape, 0.0
    corners = shape.points[shape.triangles].astype(np.float64)
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    cell = max(float(np.sqrt(np.linalg.norm(sides, axis=1).sum() / max(most, 1))), 1e-9)
    while True:
        cell_of = _cells(shape.points, cell)
        kept = cell_of[shape.triangles]
        whole = (kept != np.roll(kept, 1, axis=1)).all(axis=1)
        if int(whole.sum()) <= most:
            return _merged(shape, cell_of, whole), cell
        cell *= _COARSER


def _cells(points: NDArray, cell: float) -> NDArray:
    """The number of every point's cell among those that hold any, shape (n,)."""
    place = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    counts = place.max(axis=0) + 1
    key = (place[:, 0] * counts[1] + place[:, 1]) * counts[2] + place[:, 2]
    return np.asarray(np.unique(key, return_inverse=True)[1]).reshape(-1)


def _merged(shape: Shape, cell_of: NDArray, whole: NDArray) -> Shape:
    count = np.bincount(cell_of)
    points = np.column_stack([np.bincount(cell_of, shape.points[:, k]) / count for k in range(3)])
    colours = {name: _colouring(colouring, cell_of, whole) for name, colouring in shape.colours.items()}
    return replace(shape, points=points, triangles=cell_of[shape.triangles][whole], colours=colours, smooth=False)


def _colouring(colouring: Colouring, cell_of: NDArray, whole: NDArray) -> Colouring:
    if isinstance(colouring, Classes):
        return replace(colouring, number=colouring.number[whole])
    size = np.where(np.isnan(colouring.value), np.inf, np.abs(colouring.value))
    by_size = np.argsort(size, kind="stable")
    value = np.empty(int(cell_of.max()) + 1)
    value[cell_of[by_size]] = colouring.value[by_size]  # of those assigned to one place the last stays
    return Values(value, *colouring.scale)  # type: ignore[arg-type]
