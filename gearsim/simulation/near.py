"""Which rows of a motion may bring a tool to a solid: all others stay clear of it, for certain."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.motion.segments import DEGREE, SegmentTable

_HALVINGS, _MOST_BALLS, _AT_ONCE = 6, 32, 1 << 18
_ROUNDING = 1e-9


@dataclass(frozen=True)
class Cloud:
    """All that lies within ``around`` [mm] of points, shape (n, 3), as what a tool may come near to."""

    points: NDArray[np.floating]
    around: float

    @cached_property
    def _tree(self) -> Any:
        from scipy.spatial import cKDTree

        return cKDTree(self.points)

    def signed_distance(self, points: NDArray) -> NDArray[np.floating]:
        """Distance [mm] of points, shape (n, 3), from its surface, negative inside."""
        return np.asarray(self._tree.query(points)[0] - self.around)


class Near(Protocol):
    """What can be asked how far points are from it."""

    def signed_distance(self, points: NDArray) -> NDArray: ...


def rows_near(table: SegmentTable, cutter: Profile, solid: Near) -> NDArray[np.bool_]:
    """Rows, shape (rows,), that are not shown to stay clear of a solid whose distances are never told too large.

    The tool lies in balls along its axis. At the middle of a stretch of a row a ball is as far from the solid as its
    centre less its radius, and the row's bound of speed says how much nearer it comes within the stretch; what is not
    clear so is halved, six times at most. ``table`` must be compiled for the tool's own reach.
    """
    height, radius = _balls(cutter)
    row, middle, half = np.arange(len(table)), np.zeros(len(table)), 1.0
    found = np.zeros(len(table), dtype=bool)
    for _ in range(_HALVINGS + 1):
        parts = [slice(i, i + _AT_ONCE) for i in range(0, len(row), _AT_ONCE)]
        gaps = [_gap(table, solid, row[p], middle[p], height, radius) for p in parts]
        gap = np.concatenate([*gaps, np.empty(0)])
        found[row[gap < -radius.max()]] = True  # a centre within the solid: no need to halve
        near = (gap <= half * table.speed[row] + _ROUNDING) & ~found[row]
        row, middle = row[near], middle[near]
        half *= 0.5
        row, middle = np.tile(row, 2), np.concatenate([middle - half, middle + half])
    found[row] = True
    return found


def _gap(
    table: SegmentTable, solid: Near, row: NDArray, x: NDArray, height: NDArray, radius: NDArray
) -> NDArray[np.floating]:
    """How far [mm] the balls are from the solid at x of each row, at least."""
    powers = x[:, None] ** np.arange(DEGREE + 1)
    tip, axis = (np.einsum("nk,nkc->nc", powers, column[row]) for column in (table.tip, table.axis))
    gap = np.full(len(row), np.inf)
    for z, r in zip(height, radius, strict=True):
        gap = np.minimum(gap, solid.signed_distance(tip + z * axis) - r)
    return gap


def _balls(cutter: Profile) -> tuple[NDArray, NDArray]:
    """Heights and radii [mm] of balls on the axis that hold the tool."""
    low, high = cutter.box[2], cutter.box[3]
    count = int(np.clip(np.ceil((high - low) / max(cutter.max_radius, 1e-3)), 1, _MOST_BALLS))
    ends = np.linspace(low, high, count + 1)
    widest = [max(_widest(e, a, b) for e in cutter.elements) for a, b in pairwise(ends)]
    return 0.5 * (ends[:-1] + ends[1:]), np.hypot(np.array(widest), 0.5 * np.diff(ends))


def _widest(e: Element, low: float, high: float) -> float:
    """Largest radius [mm] of an element between two heights, or more."""
    _, widest, z0, z1 = e.box
    if z1 < low or z0 > high:
        return 0.0
    if e.is_arc or e.is_flat:
        return widest
    (ra, za), (rb, zb) = e.start, e.end
    at = np.clip((np.clip(np.array([low, high]), z0, z1) - za) / (zb - za), 0.0, 1.0)
    return float((ra + at * (rb - ra)).max())
