"""Sections of closed surfaces of triangles by planes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry.triangles import TriangleMesh


@dataclass(frozen=True)
class Section:
    """What a plane cuts of a body: closed ``loops`` of points [mm], each shape (n, 3), the last not the first again.

    Seen against the unit ``normal`` of the plane the material lies on the left: outer loops turn left, holes right.
    """

    normal: NDArray[np.floating]
    loops: tuple[NDArray[np.floating], ...]

    @property
    def area(self) -> float:
        """Area [mm²] of the material, holes taken out."""
        return float(sum(self.loop_areas))

    @property
    def loop_areas(self) -> list[float]:
        """Area [mm²] within each loop, negative for a hole."""
        sums = [np.cross(loop, np.roll(loop, -1, axis=0)).sum(axis=0) for loop in self._near]
        return [0.5 * float(total @ self.normal) for total in sums]

    @property
    def _near(self) -> list[NDArray]:
        """The loops about points of their own, so that far origins cost no digits."""
        return [loop - loop[0] for loop in self.loops]

    @property
    def lengths(self) -> list[float]:
        """Length [mm] of each loop."""
        return [float(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum()) for loop in self.loops]


def section(mesh: TriangleMesh, point: ArrayLike, normal: ArrayLike) -> Section:
    """The section of a watertight surface by the plane through ``point`` [mm] with a ``normal``, each shape (3,).

    It is exact for the mesh, and as near to the part as that is: planes and their edges are met, a surface of curvature
    radius R is missed by about pitch² / 8 R. Corners in the plane count as above it: of a face in the plane the outline
    is found where the material is below. Raises InputError where the normal has no length or a number is not finite.
    """
    at, way = np.array(point, dtype=float), np.array(normal, dtype=float)
    length = float(np.linalg.norm(way))
    if not (at.shape == way.shape == (3,) and np.isfinite(at).all() and np.isfinite(length) and length > 0.0):
        raise InputError(f"section plane: point {at} and normal {way}; wanted are 3 numbers each, the normal not 0")
    way /= length
    height = (mesh.points - at) @ way
    edge, points = _crossed(mesh, height)
    if not len(points):
        return Section(way, ())
    return Section(way, tuple(_loops(edge[0], edge[1], points)))


def _crossed(mesh: TriangleMesh, height: NDArray) -> tuple[NDArray, NDArray]:
    """Edges, by number, at which the section begins and ends in each crossed triangle, shape (2, m); their points."""
    upper = (height >= 0.0)[mesh.triangles]
    corner = mesh.triangles[upper.any(axis=1) & ~upper.all(axis=1)]
    start, end = corner, np.roll(corner, -1, axis=1)
    above = height[corner] >= 0.0
    after = np.roll(above, -1, axis=1)
    pairs = [np.column_stack([start[which], end[which]]) for which in (above & ~after, ~above & after)]
    ends = np.sort(np.concatenate(pairs), axis=1)
    edges, number = np.unique(ends, axis=0, return_inverse=True)
    low, high = height[edges[:, :1]], height[edges[:, 1:]]
    share = np.divide(low, low - high, out=np.zeros(low.shape), where=low != high)
    points = mesh.points[edges[:, 0]] + share * (mesh.points[edges[:, 1]] - mesh.points[edges[:, 0]])
    return number.reshape(2, -1), points


def _loops(start: NDArray, end: NDArray, points: NDArray) -> list[NDArray]:
    """Points in order along the loops that lead from edge to edge; places that repeat the one before are left out."""
    n = len(points)
    from scipy.sparse import coo_matrix  # slow to load, and few jobs have sections
    from scipy.sparse.csgraph import connected_components

    count, loop = connected_components(coo_matrix((np.ones(n), (start, end)), shape=(n, n)), directed=False)
    before = np.empty(n, dtype=int)
    before[end] = start
    _, first = np.unique(loop, return_index=True)
    before[first] = first
    steps = (before != np.arange(n)).astype(int)
    for _ in range(n.bit_length()):  # every round doubles how far back ``before`` points
        steps, before = steps + steps[before], before[before]
    order = np.lexsort((steps, loop))
    rows = np.split(points[order], np.cumsum(np.bincount(loop, minlength=count))[:-1])
    kept = [row[np.any(row != np.roll(row, 1, axis=0), axis=1)] for row in rows]
    return [row for row in kept if len(row) > 2]
