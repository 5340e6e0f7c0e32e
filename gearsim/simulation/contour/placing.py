"""Where a sheet's vertex lies in its cell: nearest to the planes through its hits."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_SHARP = 0.01
"""Planes bend where a direction has this share of their normals' spread; less is taken for a curve."""
_THIN = 0.09
"""The same share for planes on both sides of a thin wall or wedge: where they meet, far off, is not asked."""
_CHUNK = 1 << 19


def place(
    vertices: NDArray, point: NDArray, normal: NDArray, lower: NDArray, upper: NDArray
) -> tuple[NDArray, NDArray]:  # fmt: skip
    """Places [mm] of vertices, shape (n, 3), within their boxes, and where the planes alone would put them.

    ``vertices``, shape (m, 4): those that each hit is shared by, with its unit ``normal``, shape (m, 3); those with a
    zero normal count only where a vertex has no other. Of all places that are nearest to the planes (least squares;
    directions in which the planes hardly differ count as free) the one next to the middle of the hits is taken (Ju et
    al., "Dual contouring of Hermite data", 2002). One out of its box is held at the sides that it is beyond.
    """
    n = len(lower)
    middle = _mean(vertices, point, np.any(normal != 0.0, axis=1), n)
    square, right = np.empty((n, 3, 3)), np.zeros((n, 3))
    for i in range(3):
        for j in range(i, 3):
            square[:, i, j] = square[:, j, i] = _sum(vertices, normal[:, i] * normal[:, j], n)
    for own in vertices.T:
        planes = np.einsum("ij,ij->i", normal, point - middle[own])
        right += np.column_stack([np.bincount(own, normal[:, i] * planes, n) for i in range(3)])
    least = np.where(_facing(vertices, normal, square), _THIN, _SHARP) * np.trace(square, axis1=1, axis2=2)
    free, held = np.empty((n, 3)), np.empty((n, 3))
    for begin in range(0, n, _CHUNK):
        part = slice(begin, begin + _CHUNK)
        bounds = (side[part] - middle[part] for side in (lower, upper))
        free[part], held[part] = _least(square[part], right[part], least[part], *bounds)
    return middle + held, middle + free


def _sum(vertices: NDArray, weight: NDArray, n: int) -> NDArray:
    """Of each of n vertices what its hits weigh."""
    return np.sum([np.bincount(own, weight, n) for own in vertices.T], axis=0)


def _mean(vertices: NDArray, point: NDArray, real: NDArray, n: int) -> NDArray:
    """The mean of each vertex's real hits, or of all where it has none."""
    count = _sum(vertices, real, n)
    alone = count == 0.0
    weight = [real, np.where(alone[vertices].any(axis=1), 1.0, 0.0)]  # of vertices that have real hits, and the others
    count = np.where(alone, _sum(vertices, weight[1], n), count)
    sums = [np.where(alone, *(_sum(vertices, w * point[:, k], n) for w in weight[::-1])) for k in range(3)]
    return np.column_stack(sums) / count[:, None]


def _facing(vertices: NDArray, normal: NDArray, square: NDArray) -> NDArray:
    """Vertices with planes that nearly lie back to back: their normals point both ways along their main direction."""
    value, way = np.linalg.eigh(square)
    share = value / np.maximum(np.trace(square, axis1=1, axis2=2), 1e-300)[:, None]
    doubtful = np.any((share > _SHARP) & (share < _THIN), axis=1)
    main = np.where(doubtful[:, None], way[:, :, 2], 0.0)
    both = [np.zeros(len(square)), np.zeros(len(square))]
    for own in vertices.T:
        row = np.flatnonzero(doubtful[own])
        along = np.einsum("ij,ij->i", normal[row], main[own[row]])
        for side, sign in zip(both, (1.0, -1.0), strict=True):
            side += np.bincount(own[row], sign * along > 0.3, len(square))
    return (both[0] > 0.0) & (both[1] > 0.0)


def _least(
    square: NDArray, right: NDArray, least: NDArray, lower: NDArray, upper: NDArray
) -> tuple[NDArray, NDArray]:  # fmt: skip
    """Least squares without and with bounds, shape (n, 3): coordinates out of bounds are held there, step by step."""
    free = _solve(square, right, least)
    at, fixed = free.copy(), np.zeros(free.shape, dtype=bool)
    for _ in range(3):
        out = (at < lower) | (at > upper)
        fixed |= out
        again = out.any(axis=1)
        held = np.where(fixed, np.clip(at, lower, upper), 0.0)[again]
        loose = ~fixed[again]
        rest = right[again] - np.einsum("nij,nj->ni", square[again], held)
        part = square[again] * loose[:, :, None] * loose[:, None, :]
        at[again] = held + _solve(part, rest * loose, least[again])
    return free, np.clip(at, lower, upper)


def _solve(square: NDArray, right: NDArray, least: NDArray) -> NDArray:
    """The shortest solutions; directions with a value of at most ``least`` are left out."""
    value, way = np.linalg.eigh(square)
    scale = np.where(value > np.maximum(least, 1e-300)[:, None], value, np.inf)
    return np.einsum("nij,nj->ni", way, np.einsum("nji,nj->ni", way, right) / scale)
