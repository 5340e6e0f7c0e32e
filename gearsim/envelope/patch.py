"""A cutter's own envelope as an intended surface: what a motion cuts when nothing else is asked of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.surface import envelope_points
from gearsim.geometry.grazing import Grazing
from gearsim.geometry.jets import Curvature
from gearsim.motion.sources import MotionSource
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Way


@dataclass(frozen=True)
class EnvelopeJet:
    """Grazing points as a surface jet over (time, arc length); normals out of the material."""

    grazing: Grazing

    @property
    def r(self) -> NDArray:
        return self.grazing.point

    @property
    def ru(self) -> NDArray:
        return self.grazing.point_t

    @property
    def rv(self) -> NDArray:
        return self.grazing.point_s

    @property
    def normal(self) -> NDArray:
        return -self.grazing.normal

    def second_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """L, M, N by Weingarten's equations, shape (n,)."""
        g = self.grazing
        pairs = ((g.point_t, g.normal_t), (g.point_t, g.normal_s), (g.point_s, g.normal_s))
        first, mixed, last = (np.einsum("ij,ij->i", a, b) for a, b in pairs)
        return first, mixed, last

    def curvature(self) -> Curvature:
        return self.grazing.curvature()


@dataclass(frozen=True)
class EnvelopePatch:
    """One branch of the envelope of a chain of profile elements, from the tip up, under a whole motion.

    Parameters: u, the time in pieces of the motion (0 to ``source.pieces``), and v, the arc length [mm]
    along the chain. ``window`` [mm] is how far to look for the machined surface, either way. A motion is
    extended smoothly beyond the ends of a piece, so that u = 1 belongs to the first piece alone.
    """

    name: str
    source: MotionSource
    cutter: Profile
    elements: tuple[int, ...]
    branch: float
    window: float

    blank: BevelBlank | None = None

    @cached_property
    def _ends(self) -> NDArray:
        """Arc lengths [mm] at which the chain's elements end."""
        return np.cumsum([self.cutter.elements[i].length for i in self.elements])

    def place(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Piece, its t, profile element and arc length [mm] on it, all shape (n,)."""
        piece = np.clip(np.ceil(u).astype(int) - 1, 0, self.source.pieces - 1)
        index = np.minimum(np.searchsorted(self._ends, v, side="left"), len(self.elements) - 1)
        start = np.concatenate([[0.0], self._ends])[index]
        return piece, u - piece, np.array(self.elements)[index], v - start

    def jet(self, u: NDArray, v: NDArray) -> EnvelopeJet:
        """Points and tangents, shape (n, 3), nan where the envelope does not exist."""
        piece, t, element, s = self.place(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        branch = np.full(len(t), self.branch)
        return EnvelopeJet(envelope_points(self.source, self.cutter, piece, t, element, s, branch))

    @property
    def ways(self) -> tuple[Way, Way]:
        """Along the motion, and up the tool's profile."""
        return Way("share of the motion"), Way("up the tool's profile [mm]", 0.0, float(self._ends[-1]))

    def locate(self, length: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters of fractions of the motion and of the chain's arc length."""
        length, height = np.broadcast_arrays(np.asarray(length, dtype=float), np.asarray(height, dtype=float))
        return length * self.source.pieces, height * self._ends[-1]

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        return np.full(np.shape(u), self.window), np.full(np.shape(u), self.window)
