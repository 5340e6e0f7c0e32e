"""Where a stock's material ends along its rays: points with outward normals and tags."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.stock import AXES, Stock

Normals = Callable[[NDArray, NDArray], NDArray]
"""Outward normals, shape (n, 3), at points [mm], shape (n, 3), of the surfaces with given tags, shape (n,)."""

_ROUNDING = 1e-14


@dataclass(frozen=True)
class Ends:
    """Ends of material in the part's frame: ``point`` [mm] and unit outward ``normal``, shape (n, 3); ``tag`` and
    ``bundle`` (the axis, 0 to 2, of the box that the ray runs along), shape (n,)."""

    point: NDArray[np.floating]
    normal: NDArray[np.floating]
    tag: NDArray[np.integer]
    bundle: NDArray[np.integer]


def material_ends(stock: Stock, normals: Normals) -> Ends:
    """All ends of the material left, bundle after bundle, first those that rays come in through."""
    parts = []
    for axis, left in zip(AXES, stock.left, strict=True):
        local = np.empty((2 * len(left.lo), 3))
        first, second = (k for k in AXES if k != axis)
        row, column = np.divmod(np.tile(left.ray, 2), stock.box.counts[second])
        local[:, first], local[:, second] = stock.box.centres(first)[row], stock.box.centres(second)[column]
        local[:, axis] = stock.box.lower[axis] + np.concatenate([left.lo, left.hi])
        tag = np.concatenate([left.lo_segment, left.hi_segment])
        leaves = np.repeat([False, True], len(left.lo))
        normal = stock.box.frame.direction(outward(stock.box, axis, local, tag, leaves, normals))
        parts.append((stock.box.frame.point(local), normal, tag, np.full(len(tag), axis, dtype=np.int8)))
    return Ends(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def outward(box: DexelBox, axis: int, point: NDArray, tag: NDArray, leaves: NDArray, normals: Normals) -> NDArray:
    """Normals in a box's frame at ends of material along one of its axes, ``point`` in its frame; ``leaves``: the
    upper ends. Where a blank goes on beyond the box, it is the box's side that ends it."""
    sides = np.array([box.lower[axis], box.upper[axis]])
    off = np.abs(point[:, axis, None] - sides).min(axis=1)
    on_side = (tag < 0) & (off <= _ROUNDING * np.abs(sides).max())
    out = np.zeros(point.shape)
    out[on_side, axis] = np.where(leaves[on_side], 1.0, -1.0)
    rest = ~on_side
    out[rest] = box.frame.inverse().direction(normals(box.frame.point(point[rest]), tag[rest]))
    return out
