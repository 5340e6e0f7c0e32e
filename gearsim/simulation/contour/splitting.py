"""Quads around crossed edges as triangles."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.contour.cells import Quads

_BETTER = 1e-9
_CHUNK = 1 << 19


def split(
    quads: Quads, way: NDArray, leaves: NDArray, points: NDArray, hit: NDArray
) -> tuple[NDArray, NDArray, NDArray]:  # fmt: skip
    """Points [mm] with those that were added, triangles (m, 3), and the quad each is of.

    ``way``, shape (n, 3), of the edge that each quad is around, ``leaves`` as of its crossing, ``hit`` [mm] where the
    surface meets it. The edge meets one of the two triangles; of the two diagonals that one is taken with which it does
    nearer to its hit, so that quads bend along sharp edges. Where two cells share two arcs of one face, the side is led
    through a point of its own for each arc, and the quad is a fan around its hit: else four faces would meet in that
    side.
    """
    plain = np.ones(len(leaves), dtype=bool)
    plain[quads.double[:, 0]] = False
    number = np.flatnonzero(plain)
    second = np.concatenate(
        [np.empty(0, dtype=bool)]
        + [_other_diagonal(points[quads.corners[q]] - hit[q, None], way[q]) for q in _chunks(number)]
    )
    turned = np.where(second[:, None], np.roll(quads.corners[plain], -1, axis=1), quads.corners[plain])
    fans, owner, added = _fans(quads, len(points), hit)
    triangles = np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]], fans])
    quad = np.concatenate([number, number, owner])
    back = ~leaves[quad]
    triangles[back] = triangles[back][:, ::-1]
    return np.concatenate([points, added]), triangles, quad


def _chunks(number: NDArray) -> list[NDArray]:
    return [number[begin : begin + _CHUNK] for begin in range(0, len(number), _CHUNK)]


def _other_diagonal(corner: NDArray, way: NDArray) -> NDArray:
    """Whether quads, shape (n, 4, 3) as seen from their hits, are better split from corner 1 to 3 than from 0 to 2."""
    height = np.einsum("nki,ni->nk", corner, way)
    across = np.cross(corner[:, 2] - corner[:, 0], corner[:, 3] - corner[:, 1])
    turn = np.copysign(1.0, np.einsum("ni,ni->n", across, way))  # -1 where the lattice is left-handed
    beside = np.einsum("nki,ni->nk", np.cross(corner, np.roll(corner, -2, axis=1)), way)
    rows, off = np.arange(len(corner))[:, None], []
    for first in (0, 1):
        right = turn * beside[:, first] < 0.0  # the edge passes right of the diagonal
        three = np.array([[first, first + 2, (first + 3) % 4], [first, first + 1, first + 2]])[right.astype(int)]
        p = corner[rows, three]
        share = np.einsum("nki,ni->nk", np.cross(np.roll(p, -1, axis=1), np.roll(p, 1, axis=1)), way)
        with np.errstate(divide="ignore", invalid="ignore"):
            gap = np.abs((share * height[rows, three]).sum(axis=1) / share.sum(axis=1))
        off.append(np.where(np.isfinite(gap), gap, np.inf))
    return off[1] + _BETTER * np.abs(height).max(axis=1, initial=0.0) < off[0]


def _fans(quads: Quads, first: int, hit: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Triangles of the quads with double sides, their quads, and the points they add, numbered from ``first``."""
    owner = np.unique(quads.double[:, 0])
    centre = first + np.arange(len(owner))
    arcs = int(quads.arc.max(initial=-1)) + 1
    between = np.full((len(owner), 4), -1)
    between[np.searchsorted(owner, quads.double[:, 0]), quads.double[:, 1]] = first + len(owner) + quads.arc
    middle = np.zeros((arcs, 3))
    np.add.at(middle, quads.arc, 0.5 * hit[quads.double[:, 0]])
    start, end = quads.corners[owner], np.roll(quads.corners[owner], -1, axis=1)
    led, hub = between >= 0, np.broadcast_to(centre[:, None], between.shape)
    triangles = np.concatenate(
        [
            np.column_stack([hub[~led], start[~led], end[~led]]),
            np.column_stack([hub[led], start[led], between[led]]),
            np.column_stack([hub[led], between[led], end[led]]),
        ]
    )
    of = np.broadcast_to(owner[:, None], between.shape)
    return triangles, np.concatenate([of[~led], of[led], of[led]]), np.concatenate([hit[owner], middle])
