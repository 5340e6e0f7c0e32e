"""A balanced tree of boxes over triangles: which of them many queries may meet, all queries level by level together."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.nearest import on_triangles

_LEAF = 4
_CHUNK = 1 << 14
_PAD = 1e-12
Keep = Callable[[NDArray, NDArray, NDArray], NDArray]
"""Which pairs (k,) of queries and boxes are followed: of query numbers (k,), lower and upper corners (k, 3)."""


@dataclass(frozen=True)
class TriangleTree:
    """``corners`` [mm] of triangles, shape (m, 3, 3), m at least 1; answers name triangles by their place in it."""

    corners: NDArray[np.floating]

    @cached_property
    def _order(self) -> tuple[NDArray, NDArray]:
        """The triangles leaf by leaf, and where each leaf begins, with the end."""
        centre = self.corners.mean(axis=1)
        m, depth = len(centre), max(0, int(np.log2(len(self.corners) / _LEAF)))
        order = np.arange(m)
        for level in range(depth):
            first = m * np.arange((1 << level) + 1) // (1 << level)
            node = np.repeat(np.arange(1 << level), np.diff(first))
            here = centre[order]
            size = np.maximum.reduceat(here, first[:-1]) - np.minimum.reduceat(here, first[:-1])
            order = order[np.lexsort((here[np.arange(m), np.argmax(size, axis=1)[node]], node))]
        return order, m * np.arange((1 << depth) + 1) // (1 << depth)

    @cached_property
    def _levels(self) -> list[tuple[NDArray, NDArray]]:
        """Lower and upper corners of the boxes, from the root to the leaves; box i is parted into 2 i and 2 i + 1."""
        order, first = self._order
        own = self.corners[order]
        lower = np.minimum.reduceat(own.min(axis=1), first[:-1])
        upper = np.maximum.reduceat(own.max(axis=1), first[:-1])
        levels = [(lower, upper)]
        while len(lower) > 1:
            lower, upper = np.minimum(lower[::2], lower[1::2]), np.maximum(upper[::2], upper[1::2])
            levels.append((lower, upper))
        return levels[::-1]

    def pairs(self, queries: NDArray, keep: Keep) -> tuple[NDArray, NDArray]:
        """Queries, in rising order, and triangles, both shape (k,), whose boxes all have been kept."""
        query, node = queries, np.zeros(len(queries), dtype=int)
        for level, (lower, upper) in enumerate(self._levels):
            if level:
                query, node = np.repeat(query, 2), (2 * node[:, None] + np.arange(2)).ravel()
            kept = keep(query, lower[node], upper[node])
            query, node = query[kept], node[kept]
        order, first = self._order
        row, at = spread(first[node], first[node + 1])
        return query[row], order[at]

    def nearest(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Distance [mm] of points, shape (n, 3), from the nearest triangle, and which it is, both shape (n,)."""
        distance, triangle = np.empty(len(points)), np.empty(len(points), dtype=int)
        for begin in range(0, len(points), _CHUNK):
            own = slice(begin, begin + _CHUNK)
            distance[own], triangle[own] = self._nearest(points[own])
        return distance, triangle

    def _nearest(self, points: NDArray) -> tuple[NDArray, NDArray]:
        slack = _PAD * (np.abs(self.corners).max() + np.abs(points).max())
        bound = (np.sqrt(self._some_near(points)) + slack) ** 2

        def keep(query: NDArray, lower: NDArray, upper: NDArray) -> NDArray:
            kept: NDArray = _square(points[query], lower, upper) <= bound[query]
            return kept

        query, triangle = self.pairs(np.arange(len(points)), keep)
        away = _squares(self.corners[triangle], points[query])
        order = np.lexsort((away, query))
        best = order[np.flatnonzero(np.diff(query[order], prepend=-1))]
        return np.sqrt(away[best]), triangle[best]

    def _some_near(self, points: NDArray) -> NDArray:
        """Squares of distances to one triangle that is near to each point: where the nearer boxes lead to."""
        node = np.zeros(len(points), dtype=int)
        for lower, upper in self._levels[1:]:
            node = 2 * node
            first, second = (_square(points, lower[k], upper[k]) for k in (node, node + 1))
            node = node + (second < first)
        order, first = self._order
        return _squares(self.corners[order[first[node]]], points)


def _square(at: NDArray, lower: NDArray, upper: NDArray) -> NDArray:
    """Squares of the distances between points and boxes, all (k, 3)."""
    square: NDArray = (np.maximum(np.maximum(lower - at, at - upper), 0.0) ** 2).sum(axis=1)
    return square


def _squares(corners: NDArray, points: NDArray) -> NDArray:
    """Squares of the distances between triangles, shape (k, 3, 3), and points, shape (k, 3)."""
    foot = on_triangles(corners - points[:, None])
    square: NDArray = np.einsum("ij,ij->i", foot, foot)
    return square


def spread(begin: NDArray, end: NDArray) -> tuple[NDArray, NDArray]:
    """All whole numbers of half-open ranges, and the row (k,) of the range that each comes from."""
    count = np.maximum(end - begin, 0)
    row = np.repeat(np.arange(len(count)), count)
    return row, np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count) + begin[row]


def chunks(counts: NDArray, most: int) -> Iterator[slice]:
    """Slices of rows whose counts add up to about ``most``, one row at least."""
    total, begin = np.cumsum(counts), 0
    while begin < len(counts):
        done = total[begin - 1] if begin else 0
        end = max(begin + 1, int(np.searchsorted(total, done + most, side="right")))
        yield slice(begin, end)
        begin = end
