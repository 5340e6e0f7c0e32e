"""Closed surfaces of triangles."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class TriangleMesh:
    """``points`` [mm], shape (n, 3); ``triangles``, shape (m, 3), of point numbers, seen from outside counterclockwise.

    ``tag``, shape (m,): what made each triangle's surface; -1: the blank itself.
    """

    points: NDArray[np.floating]
    triangles: NDArray[np.integer]
    tag: NDArray[np.integer]

    @cached_property
    def volume(self) -> float:
        """Enclosed volume [mm³], by the divergence theorem about the middle of the points."""
        if not len(self.points):
            return 0.0
        a, b, c = (self.points[self.triangles[:, k]] - self.points.mean(axis=0) for k in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)

    @property
    def area_vectors(self) -> NDArray:
        """Outward vectors as long as the triangles' areas [mm²], shape (m, 3)."""
        a, b, c = (self.points[self.triangles[:, k]] for k in range(3))
        return 0.5 * np.cross(b - a, c - a)

    @cached_property
    def open_edges(self) -> int:
        """Edges that do not lie between two triangles that run along them in opposite directions; 0: watertight."""
        n = len(self.points)
        start, end = self.triangles.ravel(), np.roll(self.triangles, -1, axis=1).ravel()
        there, back = (np.unique(a * n + b, return_counts=True) for a, b in ((start, end), (end, start)))
        if not np.array_equal(there[0], back[0]):
            return len(np.setxor1d(there[0], back[0])) // 2 + int(np.count_nonzero(there[1] > 1))
        return int(np.count_nonzero(there[1] > 1))

    @property
    def euler(self) -> int:
        """Euler characteristic of a watertight surface: 2 for a ball, 0 for a torus; their sum over parts apart."""
        return len(np.unique(self.triangles)) - len(self.triangles) * 3 // 2 + len(self.triangles)
