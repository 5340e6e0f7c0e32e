"""A cylindrical gear's flank as far as a tool generates it."""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.patch import Way

_OFF = 1.618e-4  # of the facewidth


@dataclass(frozen=True)
class ReachedFlank(InvoluteFlank):
    """A flank as far as the tool generates it: ``locate`` spans the rolls ``reached`` [rad], at root and tip.

    Heights are moved off round numbers: a ray in the very plane in which a tool's end moves touches it all along.
    """

    reached: tuple[float, float] = (0.0, 0.0)

    @property
    def ways(self) -> tuple[Way, Way]:
        """As of the whole flank, the rolls as far as they are reached."""
        root, tip = map(degrees, self.reached)
        return super().ways[0], Way(super().ways[1].what, root, tip)

    def locate(self, length: ArrayLike, height: ArrayLike) -> tuple[NDArray, NDArray]:
        root, tip = self.reached
        off = np.asarray(length, dtype=float) + _OFF
        return root + (tip - root) * np.asarray(height, dtype=float), super().locate(off, height)[1]
