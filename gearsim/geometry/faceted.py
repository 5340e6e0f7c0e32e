"""Solids bounded by triangles: blanks of the user's own, the surface of a saved stock, the net of a solid of faces."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.ray_crossings import Crossings, crossings
from gearsim.geometry.triangle_tree import TriangleTree
from gearsim.geometry.triangles import TriangleMesh

_SAME = 1e-6
"""Of the solid's size: how far it may cross itself, as it does by the rounding of an STL's float32."""
_ON_FACE = 1e-9
_IN_ROWS = 4


@dataclass(frozen=True)
class Faceted:
    """The inside of a closed surface; a ``name`` for messages, ``slack`` [mm] that it may cross itself by.

    Rays are exact to rounding, and watertight: one that runs in a face, an edge or through a corner sees material where
    one a little above it in the two other coordinates does, as Block has it. Raises InputError where the surface is
    empty, open, or inside out, and a ray's chords where it crosses itself.
    """

    mesh: TriangleMesh
    name: str = "solid"
    slack: float = 0.0

    def __post_init__(self) -> None:
        if not len(self.mesh.triangles):
            raise InputError(f"{self.name}: it has no triangles")
        place = _open_edge(self.mesh)
        if place is not None:
            raise InputError(
                f"{self.name}: its surface is not closed, first at an edge about {_said(place)} mm, where triangles "
                "do not join in one sense; mend the file (close holes, join corners, turn all triangles outwards)"
            )
        if not self.volume > 0.0:
            raise InputError(
                f"{self.name}: its surface is inside out or flat, its volume is {self.volume:.6g} mm³; turn its "
                "triangles outwards"
            )

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        used = self.mesh.points[np.unique(self.mesh.triangles)]
        return used.min(axis=0), used.max(axis=0)

    @property
    def volume(self) -> float:
        return self.mesh.volume

    @cached_property
    def _tree(self) -> TriangleTree:
        return TriangleTree(self.mesh.points[self.mesh.triangles])

    @cached_property
    def _normals(self) -> NDArray:
        """Outward unit normals of the triangles, shape (m, 3); zero where one has no area."""
        corners = self._tree.corners
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(normal, axis=1, keepdims=True)
        return normal / np.where(size > 0.0, size, 1.0)

    @cached_property
    def _real(self) -> tuple[TriangleTree, NDArray]:
        """The triangles that have an area, and their numbers."""
        real = np.flatnonzero(self._normals.any(axis=1))
        return TriangleTree(self._tree.corners[real]), real

    @cached_property
    def _size(self) -> float:
        return float(np.linalg.norm(np.subtract(*self.box)))

    def contains(self, points: NDArray) -> NDArray:
        at = points.reshape(-1, 3)
        found = crossings(self._tree, at, np.tile([0.0, 0.0, 1.0], (len(at), 1)))
        before = found.at <= 0.0
        inside = np.bincount(found.ray[before], found.way[before], minlength=len(at)) > 0.0
        return inside.reshape(points.shape[:-1])

    def signed_distance(self, points: NDArray) -> NDArray:
        distance, _ = self._real[0].nearest(points.reshape(-1, 3))
        distance = distance.reshape(points.shape[:-1])
        return np.where(self.contains(points), -distance, distance)

    def normals(self, points: NDArray) -> NDArray:
        face = np.full(len(points), -1)
        for axis in range(3):  # most are ends of rays in rows along one of them
            left = np.flatnonzero(face < 0)
            if len(np.unique(points[left, axis - 1])) * _IN_ROWS > len(left):
                continue
            found = crossings(self._tree, points[left], np.tile(np.eye(3)[axis], (len(left), 1)))
            on = (np.abs(found.at) <= _ON_FACE * self._size) & self._normals[found.triangle].any(axis=1)
            face[left[found.ray[on]]] = found.triangle[on]
        left = np.flatnonzero(face < 0)
        tree, number = self._real
        face[left] = number[tree.nearest(points[left])[1]]
        return self._normals[face]

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        found = crossings(self._tree, origins, directions)
        depth = np.cumsum(found.way)
        self._require_simple(found, depth, origins, directions)
        starts, ends = (depth > 0) & (depth <= found.way), (depth <= 0) & (depth > found.way)
        ray, lo, hi = found.ray[starts], found.at[starts], found.at[ends]
        real = hi > lo
        return ray[real], lo[real], hi[real]

    def _require_simple(self, found: Crossings, depth: NDArray, origins: NDArray, directions: NDArray) -> None:
        """Raise InputError where a ray is inside twice, or less than outside, for longer than rounding makes it."""
        odd = np.flatnonzero((depth < 0) | (depth > 1))
        length = found.at[odd + 1] - found.at[odd]
        odd = odd[length > _SAME * self._size + self.slack]
        if len(odd):
            k = int(odd[0])
            place = origins[found.ray[k]] + 0.5 * (found.at[k] + found.at[k + 1]) * directions[found.ray[k]]
            what = (
                "twice within its surface: it crosses itself" if depth[k] > 1 else "within a surface that is inside out"
            )
            raise InputError(f"{self.name}: {_said(place)} mm lies {what}; mend the file (unite the bodies)")


def _open_edge(mesh: TriangleMesh) -> NDArray | None:
    """The middle [mm] of an edge that triangles do not run along as often one way as the other; None: closed."""
    start, end = mesh.triangles.ravel(), np.roll(mesh.triangles, -1, axis=1).ravel()
    sense = np.where(start < end, 1, -1)
    key, edge = np.unique(np.minimum(start, end) * len(mesh.points) + np.maximum(start, end), return_inverse=True)
    apart = np.flatnonzero(np.bincount(edge, sense) != 0.0)
    if not len(apart):
        return None
    middle: NDArray = mesh.points[list(divmod(int(key[apart[0]]), len(mesh.points)))].mean(axis=0)
    return middle


def _said(place: NDArray) -> str:
    return f"({', '.join(f'{x:.6g}' for x in place)})"
