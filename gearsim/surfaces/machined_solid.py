"""A solid part as it is intended: a body less what is taken from it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.solid import Solid
from gearsim.surfaces.part import Tolerance

SOLID = "solid"


@dataclass(frozen=True)
class MachinedSolid:
    """A ``body`` less the solids ``minus``, and how far ends of a stock's rays may lie off its surface."""

    body: Solid
    minus: tuple[Solid, ...]
    tolerance: Tolerance
    volume: ClassVar[float | None] = None  # shapes taken may overlap

    @property
    def tolerances(self) -> dict[str, Tolerance]:
        """What is held against which tolerance, by name."""
        return {SOLID: self.tolerance}

    def by_face(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Signed distances [mm] of points, shape (n, 3), and of each the number of its name: all are the solid's."""
        return self.signed_distance(points), np.zeros(len(points), dtype=int)

    def signed_distance(self, points: NDArray) -> NDArray:
        """Distance [mm] of points, shape (n, 3), from the surface, negative inside.

        It is that of the body and of each solid taken from it, whichever is the larger: exact beside a face, and no
        more than the true distance where faces meet.
        """
        distance = self.body.signed_distance(points)
        for solid in self.minus:
            distance = np.maximum(distance, -solid.signed_distance(points))
        return distance
