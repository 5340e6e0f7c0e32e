"""A motion cut into stretches, as a tree that says where the cutter may be near a point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.motion.sources import MotionSource

SPACING = 0.25
_SAMPLES = 9
_MARGIN = 1.3


@dataclass(frozen=True)
class StretchTree:
    """Stretches of pieces with a bound of the curvature, and the poses of the tree above them.

    Leaves: ``piece``, ``start``, ``end`` (t) and ``curvature`` [mm], shape (n,), n a power of two (the last stretch
    repeats). Nodes, shape (2 n,): node i has the children 2 i and 2 i + 1, the root is 1, leaf k is node n + k; no
    tool point under a node is farther than ``spread`` [mm] from where it is at the pose (``tip``, ``axis``).
    """

    piece: NDArray[np.integer]
    start: NDArray[np.floating]
    end: NDArray[np.floating]
    curvature: NDArray[np.floating]
    tip: NDArray[np.floating]
    axis: NDArray[np.floating]
    spread: NDArray[np.floating]


def stretch_tree(
    source: MotionSource, cutter: Profile, spacing: float = SPACING, least: int = 1
) -> StretchTree:  # fmt: skip
    """Stretches of a motion, ``least`` a piece or more, on none of which a tool point moves more than ``spacing`` [mm].

    The second derivative of a point, as the tool sees it, is bounded from samples of each piece, with a margin.
    """
    speed, curvature = _bounds(source, cutter)
    count = np.maximum(least, np.ceil(speed / spacing).astype(int))
    leaves = 1 << int(np.ceil(np.log2(count.sum())))
    which = np.minimum(np.arange(leaves), count.sum() - 1)
    piece = np.repeat(np.arange(source.pieces), count)[which]
    index = (np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count))[which]
    start, end = index / count[piece], (index + 1) / count[piece]
    tip, axis = (s.value for s in source.pose(piece, 0.5 * (start + end), 0))
    own = 0.5 * _MARGIN * speed[piece] / count[piece]
    return StretchTree(piece, start, end, curvature[piece], *_nodes(cutter, tip, axis, own))


def _bounds(source: MotionSource, cutter: Profile) -> tuple[NDArray, NDArray]:
    """The fastest tool point's speed and the curvature's bound K, with its margin, for each piece [mm]."""
    piece = np.repeat(np.arange(source.pieces), _SAMPLES)
    tip, axis = source.pose(piece, np.tile(np.linspace(0.0, 1.0, _SAMPLES), source.pieces), 2)
    (travel, bending), (spin, swing) = ([np.linalg.norm(d, axis=1) for d in s.derivatives()[1:]] for s in (tip, axis))
    reach = cutter.reach
    speed = (travel + reach * spin).reshape(-1, _SAMPLES).max(axis=1)
    curvature = (bending + reach * swing + spin * (2.0 * travel + spin * reach)).reshape(-1, _SAMPLES).max(axis=1)
    bound = _MARGIN * curvature
    if cutter.is_ring:
        bound += 2.0 * (_MARGIN * speed) ** 2 / cutter.min_radius
    return speed, bound


def _nodes(cutter: Profile, tip: NDArray, axis: NDArray, own: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Poses and spreads of the nodes over leaves with given ones: a node has its middle leaf's pose."""
    leaves = len(own)
    _, radius, bottom, top = cutter.box
    centre, size = tip + 0.5 * (bottom + top) * axis, float(np.hypot(radius, 0.5 * (top - bottom)))
    middle, spread = np.zeros(2 * leaves, dtype=int), np.zeros(2 * leaves)
    every = np.arange(leaves)
    width = 1
    while width <= leaves:
        heads = every[::width] + width // 2
        mine = np.repeat(heads, width)
        apart = np.linalg.norm(centre - centre[mine], axis=1) + size * np.linalg.norm(axis - axis[mine], axis=1)
        nodes = slice(leaves // width, 2 * leaves // width)
        middle[nodes], spread[nodes] = heads, (apart + own).reshape(-1, width).max(axis=1)
        width *= 2
    return tip[middle], axis[middle], spread
