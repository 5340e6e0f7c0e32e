"""Where the edges of a tri-dexel's lattice meet the surface: the ends of the intervals of the bundle along them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.contour.crossings import Crossings
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.ends import Normals, outward
from gearsim.simulation.intervals import IntervalSet

_CLOSE = 1e-6
"""Of the pitch: an end so near to an edge of the lattice lies on it."""


@dataclass(frozen=True)
class Hits:
    """Points [mm] on crossed edges with the outward ``normal`` there, both shape (n, 3), in the box's frame.

    ``tag``: what made the surface there. A normal is zero where the edge's own bundle has no end on it: two bundles do
    not agree there.
    """

    point: NDArray[np.floating]
    normal: NDArray[np.floating]
    tag: NDArray[np.integer]


def nodes(box: DexelBox, axis: int) -> NDArray:
    """Places [mm along the rays] of a lattice's nodes along one edge of the box, with the empty ones around it."""
    n = int(box.counts[axis])
    return (box.upper[axis] - box.lower[axis]) * (np.arange(-1, n + 1) + 0.5) / n


def hits(box: DexelBox, left: Sequence[IntervalSet], crossings: Crossings, normals: Normals) -> Hits:
    """Where crossed edges along one axis of the lattice meet the surface of the material ``left`` in three bundles.

    That is the nearest end, of the right kind, on the edge's ray, or the edge's end that is nearest to it.
    """
    axis, count = crossings.axis, len(crossings)
    at, tag, real = np.empty(count), np.full(count, -1), np.zeros(count, dtype=bool)
    for leaves in (False, True):
        mine = crossings.leaves == leaves
        row = crossings.row[mine] if len(crossings.row) else _nearest(box, left[axis], crossings, leaves)
        at[mine], tag[mine], real[mine] = _ends(box, left[axis], crossings, leaves, row)
    point = np.column_stack([nodes(box, k)[crossings.node[:, k]] for k in range(3)]) + box.lower
    point[:, axis] = box.lower[axis] + at
    normal = np.zeros((count, 3))
    normal[real] = outward(box, axis, point[real], tag[real], crossings.leaves[real], normals)
    return Hits(point, normal, tag)


def _ends(
    box: DexelBox, material: IntervalSet, crossings: Crossings, leaves: bool, row: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Places of the ends in given rows (-1: none) on their edges, their tags, and whether they lie there."""
    place = nodes(box, crossings.axis)
    lower = crossings.node[crossings.leaves == leaves, crossings.axis]
    first, last = place[lower], place[lower + 1]
    if not len(material.lo):
        return 0.5 * (first + last), np.full(len(row), -1), np.zeros(len(row), dtype=bool)
    end = (material.hi if leaves else material.lo)[row]
    at = np.clip(end, first, last)
    real = (row >= 0) & (np.abs(end - at) <= _CLOSE * (last - first))
    tag = (material.hi_segment if leaves else material.lo_segment)[row]
    return np.where(row >= 0, at, 0.5 * (first + last)), np.where(row >= 0, tag, -1), real


def _nearest(box: DexelBox, material: IntervalSet, crossings: Crossings, leaves: bool) -> NDArray:
    """The intervals whose ends are nearest to edges, on the same ray and of the same kind; -1 where there is none."""
    axis, mine = crossings.axis, crossings.leaves == leaves
    if not len(material.lo):
        return np.full(np.count_nonzero(mine), -1)
    place, node = nodes(box, axis), crossings.node[mine].astype(np.int64)
    end = material.hi if leaves else material.lo
    edge = np.searchsorted(place[1:-1], end)
    first, second = (k for k in range(3) if k != axis)
    ray = (node[:, first] - 1) * box.counts[second] + node[:, second] - 1
    tall = len(place)
    after = np.searchsorted(material.ray * tall + edge, ray * tall + node[:, axis])
    rows = np.column_stack([after, after - 1])
    own = (rows >= material.first[ray, None]) & (rows < material.first[ray + 1, None])
    found = end[np.where(own, rows, 0)]
    low, high = place[node[:, axis], None], place[node[:, axis] + 1, None]
    off = np.where(own, np.maximum(np.maximum(low - found, found - high), 0.0), np.inf)
    best = np.argmin(off, axis=1)[:, None]
    row = np.take_along_axis(rows, best, axis=1)
    return np.where(np.take_along_axis(own, best, axis=1), row, -1)[:, 0]
