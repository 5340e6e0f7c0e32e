"""Distances to surfaces of triangles, and between places on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.geometry.triangles import TriangleMesh

_CHUNK = 1 << 18


@dataclass(frozen=True)
class Span:
    """Two points on a surface [mm], shape (3,), with the triangles they lie on, and the ``distance`` [mm] between."""

    first: NDArray[np.floating]
    second: NDArray[np.floating]
    triangles: tuple[int, int]
    distance: float


def span(mesh: TriangleMesh, first: ArrayLike, second: ArrayLike) -> Span:
    """The distance between the points of a surface that are nearest to two places [mm], shape (3,)."""
    a, b = (nearest_point(mesh, np.array(place, dtype=float)) for place in (first, second))
    return Span(a[0], b[0], (a[1], b[1]), float(np.linalg.norm(b[0] - a[0])))


def nearest_point(mesh: TriangleMesh, place: NDArray) -> tuple[NDArray, int]:
    """The point [mm] of a surface that is nearest to a place, shape (3,), and its triangle: every one is looked at.

    Raises ValueError where the surface has no triangles.
    """
    least, point, triangle = np.inf, place, -1
    for begin in range(0, len(mesh.triangles), _CHUNK):
        near = on_triangles(mesh.points[mesh.triangles[begin : begin + _CHUNK]] - place)
        away = np.einsum("ij,ij->i", near, near)
        best = int(np.argmin(away))
        if away[best] < least:
            least, point, triangle = float(away[best]), place + near[best], begin + best
    if triangle < 0:
        raise ValueError("the surface has no triangles")
    return point, triangle


def on_triangles(corners: NDArray) -> NDArray:
    """The points of triangles, shape (m, 3, 3), that are nearest to the origin."""
    after = np.roll(corners, -1, axis=1)
    way = after - corners
    square = np.einsum("mij,mij->mi", way, way)
    share = np.clip(-np.einsum("mij,mij->mi", corners, way) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    on_edges = corners + share[..., None] * way
    edge = np.argmin(np.einsum("mij,mij->mi", on_edges, on_edges), axis=1)
    best = on_edges[np.arange(len(corners)), edge]
    normal = np.cross(way[:, 0], way[:, 1])
    size = np.einsum("ij,ij->i", normal, normal)
    foot = normal * (np.einsum("ij,ij->i", normal, corners[:, 0]) / np.where(size > 0.0, size, 1.0))[:, None]
    side = np.einsum("mij,mj->mi", np.cross(way, foot[:, None] - corners), normal)
    within = (size > 0.0) & np.all(side >= 0.0, axis=1)
    return np.where(within[:, None], foot, best)
