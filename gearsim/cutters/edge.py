"""A sharp edge of a cutter's meridian, as the arc of radius 0 that joins two elements."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.geometry.grazing import MeridianPoints


@dataclass(frozen=True)
class SharpEdge:
    """A corner (r, z) [mm] of a convex section, whose normal turns left from ``first`` to ``last`` [rad].

    Angles as in `Element.angles`. Where an arc counts its length, an edge counts the angle [rad]; the curvature
    is infinite.
    """

    corner: tuple[float, float]
    first: float
    last: float

    @staticmethod
    def between(before: Element, after: Element) -> SharpEdge:
        """The corner in which one straight element of a chain ends and the next begins."""
        a, b = (e.at(np.array(0.0)) for e in (before, after))
        first, last = float(np.arctan2(a.nz, a.nr)), float(np.arctan2(b.nz, b.nr))
        return SharpEdge(before.end, first, last + 2.0 * np.pi if last < first else last)

    @property
    def length(self) -> float:
        """Angle [rad] between the normals of the two sides."""
        return self.last - self.first

    def at(self, s: NDArray) -> MeridianPoints:
        """The corner with its normals at angles s [rad] from the first side's."""
        angle = self.first + np.asarray(s, dtype=float)
        r, z, bend = (np.full(angle.shape, c) for c in (*self.corner, np.inf))
        return MeridianPoints(r, z, np.cos(angle), np.sin(angle), bend)
