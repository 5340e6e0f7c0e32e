"""The cells around crossed edges, and the vertices of their sheets: the topology of a closed surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.contour.crossings import Crossings
from gearsim.simulation.contour.sheets import sheet_tables

# The four cells around an edge, right-handed about its axis: their steps along the next axis and the one after,
# and the edge's place in them.
_STEPS = np.array([[-1, -1], [0, -1], [0, 0], [-1, 0]])
_PLACES = np.array([3, 2, 0, 1])


@dataclass(frozen=True)
class Quads:
    """A quad of vertices around every crossed edge, in the order of the crossings, shape (n, 4), seen from the next
    node counterclockwise.

    ``cell``: of each vertex, its cell's number; ``cells`` (rising) those of all cells with surface. ``double``: sides
    (quad, side) whose two vertices are joined by a second arc of the same face, shape (m, 2); ``arc`` numbers their
    arcs, each on two sides.
    """

    corners: NDArray[np.integer]
    cell: NDArray[np.integer]
    cells: NDArray[np.integer]
    double: NDArray[np.integer]
    arc: NDArray[np.integer]


def quads(crossings: Sequence[Crossings], shape: tuple[int, int, int]) -> Quads:
    """Quads around edges of a lattice of ``shape`` cells; an index below 0 is that of the last cell."""
    tables = sheet_tables()
    around = np.concatenate([_around(c, shape) for c in crossings])
    edge = np.concatenate([np.tile(4 * c.axis + _PLACES, (len(c), 1)) for c in crossings]).ravel()
    leaves = np.concatenate([c.leaves for c in crossings])
    order = np.argsort(around.ravel())
    cells, first, count = _runs(around.ravel()[order])
    bits = (1 << edge).astype(np.int16)
    crossed = np.bitwise_or.reduceat(bits[order], first) if len(first) else bits
    one = order[first]
    case = 2 * crossed.astype(int) + (leaves[one // 4] ^ tables.differs[crossed, edge[one]])
    sheets = tables.number[case]
    vertex = np.cumsum(sheets, dtype=int) - sheets
    corners = np.empty(len(order), dtype=int)
    corners[order] = np.repeat(vertex, count)
    cases = np.empty(len(order), dtype=np.int16)
    cases[order] = np.repeat(case, count)
    corners += tables.sheet[cases, edge]
    double, arc = _double(crossings, around, tables.twice[cases].reshape(-1, 4))
    return Quads(corners.reshape(-1, 4), np.repeat(cells, sheets), cells, double, arc)


def _around(crossings: Crossings, shape: tuple[int, int, int]) -> NDArray:
    """Numbers of the four cells around each edge."""
    cell = [np.repeat(crossings.node[:, k : k + 1].astype(np.int64), 4, axis=1) for k in range(3)]
    for k, step in zip(_others(crossings.axis), _STEPS.T, strict=True):
        cell[k] = (cell[k] + step) % shape[k]
    return (cell[0] * shape[1] + cell[1]) * shape[2] + cell[2]


def _others(axis: int) -> tuple[int, int]:
    return (axis + 1) % 3, (axis + 2) % 3


def _runs(rising: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The different values, where each begins, and how often it comes."""
    first = np.flatnonzero(np.diff(rising, prepend=-1))
    return rising[first], first, np.diff(first, append=len(rising))


def _double(crossings: Sequence[Crossings], around: NDArray, twice: NDArray) -> tuple[NDArray, NDArray]:
    """Sides on a face that both its cells' sheets cross in two arcs, and the number of each one's arc."""
    axis = np.repeat([c.axis for c in crossings], [len(c) for c in crossings])
    sides, keys = [], []
    for side in range(4):
        face = (axis + 1 + side % 2) % 3
        here, there = 2 * face + (side < 2), 2 * face + (side >= 2)
        both = (twice[:, side] >> here) & (twice[:, (side + 1) % 4] >> there) & 1
        quad = np.flatnonzero(both)
        sides.append(np.column_stack([quad, np.full(len(quad), side)]))
        keys.append(np.column_stack([around[quad, (1, 2, 2, 3)[side]], face[quad]]))
    double, key = np.concatenate(sides), np.concatenate(keys)
    node = np.concatenate([_material(c) for c in crossings])[double[:, 0]]
    _, arc = np.unique(np.column_stack([key, node]), axis=0, return_inverse=True)
    return double, arc.reshape(-1)


def _material(crossings: Crossings) -> NDArray:
    """The node of each edge that is material."""
    node = crossings.node.copy()
    node[:, crossings.axis] += ~crossings.leaves
    return node
