"""How far a tool provably stays off a blank.

The tool is cut into discs along its axis: each lies within a ball about its middle, so the ball's distance from the
blank is a lower bound. Between two poses looked at no point of the tool moves farther than a known way.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.solid import Solid
from gearsim.geometry.turned import Turned
from gearsim.motion.sources import CLMotion

CLEAR_MM = 0.5
_DISC_MM = 0.25
_LOOK_MM = 0.25
_POINT_MM = 0.02
_MOST_DISCS = 4000  # of a tool longer than 1 m, each then longer, too
_MOST_POINTS = 100_000
_AT_ONCE = 1 << 12
_OPPOSITE = -0.99
_ROUGH = 8.0


@dataclass(frozen=True)
class Clearance:
    """Lower bounds [mm] of the distance between a cutter, moved about, and an uncut blank.

    ``rough``: looks are that many times as far apart, discs that many times as thick, and bounds the lower.
    """

    stock: Solid
    cutter: Profile
    rough: float = 1.0

    def clears(self, tips: NDArray, axes: NDArray) -> bool:
        """Whether the cutter is far enough off all along, as ``along`` tells; where it is far, rough looks do."""
        return self._roughly.along(tips, axes) >= CLEAR_MM or self.along(tips, axes) >= CLEAR_MM

    @cached_property
    def _roughly(self) -> Clearance:
        return replace(self, rough=_ROUGH)

    def at(self, tips: NDArray, axes: NDArray) -> NDArray:
        """At poses: tips [mm] and unit axes, shape (n, 3)."""
        z, reach = self._discs
        out = np.empty(len(tips))
        for begin in range(0, len(tips), _AT_ONCE):
            own = slice(begin, begin + _AT_ONCE)
            middles = tips[own, None] + z[:, None] * axes[own, None]
            out[own] = (self.stock.signed_distance(middles) - reach).min(axis=1)
        return out

    def along(self, tips: NDArray, axes: NDArray) -> float:
        """All along straight tip lines, the axis turning at a constant rate; minus infinity where it turns round."""
        cosine = (axes[1:] * axes[:-1]).sum(axis=1)
        if (cosine < _OPPOSITE).any():
            return -np.inf
        motion, turn = CLMotion(tips, axes), np.arccos(np.minimum(cosine, 1.0))
        way = np.linalg.norm(np.diff(tips, axis=0), axis=1) + self.cutter.reach * turn
        count = np.maximum(1, np.ceil(way / (self.rough * _LOOK_MM)).astype(int))
        piece = np.repeat(np.arange(len(way)), count)
        t = (np.arange(len(piece)) - np.repeat(np.cumsum(count) - count, count) + 0.5) / count[piece]
        tip, axis = (s.value for s in motion.pose(piece, t, 0))
        return float((self.at(tip, axis) - 0.5 * (way / count)[piece]).min())

    def height(self, tip: NDArray, axis: NDArray) -> float:
        """How far up [mm] along its axis the tool must go to be clear from there on."""
        centre, radius = self.sphere
        top = max(0.0, radius - float((tip - centre) @ axis))
        up = np.linspace(0.0, top, max(1, ceil(top / _LOOK_MM)) + 1)
        off = self.at(tip + up[:, None] * axis, np.broadcast_to(axis, (len(up), 3))) - up[1]
        near = np.flatnonzero(off < CLEAR_MM)
        return float(up[min(near[-1] + 1, len(up) - 1)]) if len(near) else 0.0

    @cached_property
    def sphere(self) -> tuple[NDArray, float]:
        """Centre, and how far [mm] from it along its own axis a tip must stand for the tool to be clear."""
        lower, upper = self.stock.box
        centre, blank = 0.5 * (lower + upper), 0.5 * float(np.linalg.norm(upper - lower))
        if isinstance(self.stock, Turned):
            polygon = self.stock.polygon
            blank = float(np.hypot(polygon[:, 0], polygon[:, 1] - centre[2]).max())
        below = max(0.0, -float(self._discs[0][0]))
        return centre, blank + below + float(self._discs[1].max()) + 2.0 * _LOOK_MM + CLEAR_MM

    @cached_property
    def _discs(self) -> tuple[NDArray, NDArray]:
        """Middles [mm] of discs along the axis, and how far from its middle each disc's farthest point lies at most."""
        low, high = self.cutter.box[2:]
        fine = max(_POINT_MM, self.cutter.reach / _MOST_POINTS)
        edges = np.linspace(low, high, min(ceil((high - low) / (self.rough * _DISC_MM)), _MOST_DISCS) + 1)
        points = [e.at(np.linspace(0.0, e.length, ceil(e.length / fine) + 1)) for e in self.cutter.elements]
        r, z = (np.concatenate([getattr(p, name) for p in points]) for name in ("r", "z"))
        radius = np.zeros(len(edges) - 1)
        for beside in (-fine, 0.0, fine):
            disc = np.searchsorted(edges, z + beside, side="right") - 1
            np.maximum.at(radius, np.clip(disc, 0, len(radius) - 1), r)
        return 0.5 * (edges[:-1] + edges[1:]), np.hypot(radius + fine, 0.5 * (edges[1] - edges[0]))
