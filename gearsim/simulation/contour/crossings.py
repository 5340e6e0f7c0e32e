"""Edges of a lattice, between neighbouring nodes, of which one is material and the other is not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.contour.columns import Columns


@dataclass(frozen=True)
class Crossings:
    """Edges along one ``axis`` of the lattice from a node, shape (n, 3), to the next.

    Indices count from 0 at the empty nodes around the lattice, but along an index that is periodic. ``leaves``: the
    node is material and the next is not. ``row``: the interval with that end, where it is known, else empty.
    """

    axis: int
    node: NDArray[np.integer]
    leaves: NDArray[np.bool_]
    row: NDArray[np.integer]

    def __len__(self) -> int:
        return len(self.leaves)


def along(columns: Columns) -> Crossings:
    """Edges along the columns: where their runs begin and end."""
    place = _place(columns, np.concatenate([columns.column, columns.column]))
    node = np.column_stack([place, np.concatenate([columns.begin, columns.end])])
    leaves = np.repeat([False, True], len(columns.column))
    return Crossings(2, node.astype(np.int32), leaves, np.concatenate([columns.begin_row, columns.end_row]))


def across(columns: Columns, axis: int) -> Crossings:
    """Edges between columns that are neighbours along ``axis``, 0 or 1: nodes that one of the two alone holds.

    The runs of the two are merged: between an odd bound and the next lie the nodes of one alone.
    """
    bounds = np.concatenate([columns.begin, columns.end])
    place = _place(columns, np.concatenate([columns.column, columns.column]))
    before = place.copy()
    before[:, axis] -= 1  # a pair has the number of its first column
    wraps = columns.periodic and axis == 0
    if wraps:
        before[:, 0] %= columns.shape[0]
    wide, tall = columns.shape[1] + 2, columns.shape[2] + 1
    pair = np.concatenate([place, before])
    key = (pair[:, 0] * wide + pair[:, 1]) * tall + np.concatenate([bounds, bounds])
    order = np.argsort(key, kind="stable")
    key, first = key[order], order < len(bounds)
    start, length = key[::2], key[1::2] - key[::2]
    leaves = np.cumsum(first)[::2] % 2 == 1
    flat = np.repeat(start - np.cumsum(length) + length, length) + np.arange(length.sum())
    node = np.column_stack([*np.divmod(flat // tall, wide), flat % tall + 1]).astype(np.int32)
    return Crossings(axis, node, np.repeat(leaves, length), np.empty(0, dtype=int))


def _place(columns: Columns, column: NDArray) -> NDArray:
    """The first two indices of columns."""
    first, second = np.divmod(column, columns.shape[1])
    return np.column_stack([first + (not columns.periodic), second + 1])
