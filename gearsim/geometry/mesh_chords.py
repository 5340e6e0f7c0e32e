"""Where rays run inside a closed surface of triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from gearsim.errors import NumericalError

_ASIDE = (np.array([0.7310, 0.6824]), np.array([-0.5772, 0.8166]), np.array([0.3141, -0.9494]))
_ASIDE_MM = 1e-8


def mesh_chords(corners: NDArray, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Chords of rays, both shape (n, 3), in a closed surface of triangles, ``corners`` (m, 3, 3) [mm].

    As of `geometry.solid.Solid.chords`. Rays are looked at 1e-8 mm aside, so that none runs along an edge or a face.
    Raises NumericalError where a ray goes in and not out: the surface is not closed.
    """
    found = [np.empty(0, dtype=int), np.empty(0), np.empty(0)]
    ways, which = np.unique(directions, axis=0, return_inverse=True)
    for k, way in enumerate(ways):
        mine = np.flatnonzero(which.reshape(-1) == k)
        for aside in _ASIDE:
            ray, at = _crossings(corners, origins[mine], way, _ASIDE_MM * aside)
            if not (np.bincount(ray, minlength=len(mine)) % 2).any():
                break
        else:
            raise NumericalError("a ray goes into a surface of triangles and not out: it is not closed")
        found = [np.concatenate([a, b]) for a, b in zip(found, (mine[ray[::2]], at[::2], at[1::2]), strict=True)]
    order = np.lexsort((found[1], found[0]))
    ray, start, end = (column[order] for column in found)
    return ray, start, end


def _crossings(corners: NDArray, origins: NDArray, way: NDArray, aside: NDArray) -> tuple[NDArray, NDArray]:
    """Rays, by number in rising order, and distances [mm] along them, rising, at which they meet triangles."""
    across = np.linalg.svd(way[None])[2][1:]
    place = origins @ across.T + aside
    flat, depth = corners @ across.T, corners @ way
    middle = 0.5 * (flat.max(axis=1) + flat.min(axis=1))
    reach = np.linalg.norm(flat - middle[:, None], axis=2).max(axis=1)
    near = cKDTree(place).query_ball_point(middle, reach * (1.0 + 1e-9) + 1e-12)
    triangle = np.repeat(np.arange(len(corners)), [len(rays) for rays in near])
    ray = np.concatenate([np.asarray(rays, dtype=int) for rays in near]) if len(near) else triangle
    off = flat[triangle] - place[ray][:, None]
    after = np.roll(off, -1, axis=1)
    areas = off[..., 0] * after[..., 1] - off[..., 1] * after[..., 0]  # of the parts beside each edge
    hit = (areas > 0.0).all(axis=1) | (areas < 0.0).all(axis=1)
    triangle, ray, areas = triangle[hit], ray[hit], areas[hit]
    share = np.roll(areas, -1, axis=1) / areas.sum(axis=1, keepdims=True)
    at = np.einsum("ij,ij->i", share, depth[triangle]) - origins[ray] @ way
    order = np.lexsort((at, ray))
    return ray[order], at[order]
