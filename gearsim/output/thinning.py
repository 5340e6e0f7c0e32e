"""Fewer triangles of a shape, for looking at it: points that share a cell of a lattice become one."""

from __future__ import annotations

from collections.abc import Sequence
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
    (one,), cell = thinned_together([shape], most)
    return one, cell


def thinned_together(shapes: Sequence[Shape], most: int) -> tuple[list[Shape], float]:
    """Shapes that have at most so many triangles together, thinned alike: points in which they met stay common."""
    if sum(len(shape.triangles) for shape in shapes) <= most:
        return list(shapes), 0.0
    points = np.concatenate([shape.points for shape in shapes])
    ends = np.cumsum([len(shape.points) for shape in shapes])[:-1]
    corners = np.concatenate([shape.points[shape.triangles].astype(np.float64) for shape in shapes])
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    cell = max(float(np.sqrt(np.linalg.norm(sides, axis=1).sum() / max(most, 1))), 1e-9)
    while True:
        cell_of = _cells(points, cell)
        parts = np.split(cell_of, ends)
        kept = [part[shape.triangles] for part, shape in zip(parts, shapes, strict=True)]
        whole = [(k != np.roll(k, 1, axis=1)).all(axis=1) for k in kept]
        if sum(int(w.sum()) for w in whole) <= most:
            count = np.bincount(cell_of)
            middle = np.column_stack([np.bincount(cell_of, points[:, k]) / count for k in range(3)])
            return [_merged(*of, middle) for of in zip(shapes, parts, whole, strict=True)], cell
        cell *= _COARSER


def _cells(points: NDArray, cell: float) -> NDArray:
    """The number of every point's cell among those that hold any, shape (n,)."""
    place = np.floor((points - points.min(axis=0)) / cell).astype(np.int64)
    counts = place.max(axis=0) + 1
    key = (place[:, 0] * counts[1] + place[:, 1]) * counts[2] + place[:, 2]
    return np.asarray(np.unique(key, return_inverse=True)[1]).reshape(-1)


def _merged(shape: Shape, cell_of: NDArray, whole: NDArray, middle: NDArray) -> Shape:
    """A shape of the triangles that stay ``whole``, its points those in the ``middle`` of their cells."""
    own, of = np.unique(cell_of, return_inverse=True)
    colours = {name: _colouring(colouring, of, whole) for name, colouring in shape.colours.items()}
    return replace(shape, points=middle[own], triangles=of[shape.triangles][whole], colours=colours, smooth=False)


def _colouring(colouring: Colouring, cell_of: NDArray, whole: NDArray) -> Colouring:
    if isinstance(colouring, Classes):
        return replace(colouring, number=colouring.number[whole])
    size = np.where(np.isnan(colouring.value), np.inf, np.abs(colouring.value))
    by_size = np.argsort(size, kind="stable")
    value = np.empty(int(cell_of.max()) + 1)
    value[cell_of[by_size]] = colouring.value[by_size]  # of those assigned to one place the last stays
    return Values(value, *colouring.scale)  # type: ignore[arg-type]
