"""Solids bounded by NURBS faces, each whole from border to border, and what of every face is tolerated."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.faceted import Faceted
from gearsim.geometry.solid import Solid
from gearsim.geometry.triangles import TriangleMesh
from gearsim.surfaces.foot_within import foot_within
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.part import Tolerance

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

_CELLS = 48
_SAME_MM = 1e-5
_TIE_MM = 1e-7


@dataclass(frozen=True, eq=False)
class FacedSolid:
    """A body bounded by ``faces``, their normals out of it.

    Distances are those from the exact faces. Inside and outside, chords and volume are those of a net of 48 x 48 cells
    a face, which is off by a 48th of a face, squared, over eight times its radius of curvature.

    Raises InputError for faces that do not meet all along their borders: neighbours share a whole side each.
    """

    faces: tuple[NurbsSurface, ...]

    def __post_init__(self) -> None:
        if self.mesh.open_edges:
            lonely = ", ".join(self.faces[k].name for k in self._open_faces())
            raise InputError(f"the faces enclose no solid: no other side lies along a side of {lonely}")
        if not self.mesh.volume > 0.0:
            raise InputError("the faces' normals point into the solid; set 'flip' of all of them")

    @cached_property
    def nodes(self) -> NDArray:
        """Points [mm] of every face on even shares of its domain, shape (faces, 49, 49, 3)."""
        share = np.linspace(0.0, 1.0, _CELLS + 1)
        u, v = (x.ravel() for x in np.meshgrid(share, share, indexing="ij"))
        return np.array([f.at(*f.locate(u, v)).reshape(_CELLS + 1, _CELLS + 1, 3) for f in self.faces])

    @cached_property
    def mesh(self) -> TriangleMesh:
        """The net's triangles, tagged with the numbers of their faces."""
        points = self.nodes.reshape(-1, 3)
        from scipy.sparse import coo_matrix  # slow to load, and few parts have faces
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        pairs = cKDTree(points).query_pairs(_SAME_MM, output_type="ndarray")
        links = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
        count, of = connected_components(links, directed=False)
        merged = np.stack([np.bincount(of, x, count) for x in points.T], axis=1) / np.bincount(of)[:, None]
        at = np.arange(len(points)).reshape(self.nodes.shape[:3])
        a, b, c, d = at[:, :-1, :-1], at[:, 1:, :-1], at[:, 1:, 1:], at[:, :-1, 1:]
        cells = np.stack([np.stack([a, b, c], axis=-1), np.stack([a, c, d], axis=-1)], axis=3)
        turned = np.array([face.flip for face in self.faces])
        cells[turned] = cells[turned][..., ::-1]
        triangles = of[cells.reshape(-1, 3)]
        tag = np.repeat(np.arange(len(self.faces)), 2 * _CELLS**2)
        real = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
        return TriangleMesh(merged, triangles[real], tag[real])

    @cached_property
    def _net(self) -> Faceted:
        """The net as a solid. Where faces nearly touch it may cross itself by less than a cell, which they do not."""
        return Faceted(self.mesh, "the faces' net", slack=float(self._cells.max()))

    def _open_faces(self) -> list[int]:
        t, n = self.mesh.triangles, len(self.mesh.points)
        start, end = t.ravel(), np.roll(t, -1, axis=1).ravel()
        alone = ~np.isin(start * n + end, end * n + start)
        return sorted(set(np.repeat(self.mesh.tag, 3)[alone].tolist()))

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        return self.mesh.points.min(axis=0), self.mesh.points.max(axis=0)

    @property
    def volume(self) -> float:
        return self.mesh.volume

    def contains(self, points: NDArray) -> NDArray:
        return self.signed_distance(points) < 0.0

    def signed_distance(self, points: NDArray) -> NDArray:
        return self.nearest(points.reshape(-1, 3))[0].reshape(points.shape[:-1])

    def normals(self, points: NDArray) -> NDArray:
        _, owner, u, v = self.nearest(points)
        out = np.empty(points.shape)
        for k, face in enumerate(self.faces):
            out[owner == k] = face.jet(u[owner == k], v[owner == k]).normal
        return out

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        return self._net.chords(origins, directions)

    def nearest(self, points: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Signed distances [mm] of points, shape (n, 3), from the surface, the numbers of the nearest faces, u and v.

        On an edge that face decides which sees the point most squarely: so the sign is right at any edge.
        """
        near = self._trees[0].query(points)[0]
        best = np.full((4, len(points)), np.inf)
        squarely, owner = np.zeros(len(points)), np.zeros(len(points), dtype=int)
        for k, face in enumerate(self.faces):
            asked, first = self._asked(k, points, near)
            u, v, off, height = foot_within(face, points[asked], *first)
            closer = off < best[0, asked] - _TIE_MM
            as_close = (off <= best[0, asked] + _TIE_MM) & (np.abs(height) > squarely[asked])
            better = asked[closer | as_close]
            values = np.stack([off, np.sign(height) * off, u, v])[:, closer | as_close]
            best[:, better], squarely[better], owner[better] = values, np.abs(height[closer | as_close]), k
        return best[1], owner, best[2], best[3]

    def _asked(self, k: int, points: NDArray, near: NDArray) -> tuple[NDArray, tuple[NDArray, NDArray]]:
        """Points that a face may be the nearest to, and parameters to look from; ``near`` bounds their distances."""
        net, cell = self.nodes[k].reshape(-1, 3), self._cells[k]
        within = (points > net.min(axis=0) - (near + cell)[:, None]) & (
            points < net.max(axis=0) + (near + cell)[:, None]
        )
        asked = np.flatnonzero(within.all(axis=1))
        off, node = self._trees[k + 1].query(points[asked])
        kept = off - cell <= near[asked]
        i, j = np.divmod(node[kept], _CELLS + 1)
        return asked[kept], self.faces[k].locate(i / _CELLS, j / _CELLS)

    @cached_property
    def _cells(self) -> NDArray:
        """How far [mm] at most a point of each face lies from a node of it."""
        sides = [np.linalg.norm(np.diff(self.nodes, axis=axis), axis=-1).max(axis=(1, 2)) for axis in (1, 2)]
        return np.asarray(np.hypot(*sides))

    @cached_property
    def _trees(self) -> list[cKDTree]:
        from scipy.spatial import cKDTree

        return [cKDTree(self.nodes.reshape(-1, 3)), *(cKDTree(net.reshape(-1, 3)) for net in self.nodes)]


@dataclass(frozen=True, eq=False)
class FacedPart:
    """A solid as it is intended, and how far ends of a stock's rays may lie off each of its faces, by name."""

    body: FacedSolid
    tolerances: dict[str, Tolerance]
    minus: ClassVar[tuple[Solid, ...]] = ()
    volume: ClassVar[float | None] = None  # that of the body's net is not the faces' own

    def signed_distance(self, points: NDArray) -> NDArray:
        """Distance [mm] of points, shape (n, 3), from the surface, negative inside."""
        return self.body.signed_distance(points)

    def by_face(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """The same, and the numbers of the faces that are nearest, in the order of ``tolerances``."""
        distance, owner, _, _ = self.body.nearest(points)
        return distance, owner
