"""Rays: straight lines with an origin, a direction and a window of interest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rigid import Rigid


@dataclass(frozen=True)
class RayBundle:
    """Rays with a window of interest.

    ``origin`` [mm] and unit ``direction`` have shape (n, 3); ``start`` and ``end`` [mm along the ray],
    shape (n,), bound where cuts matter: those wholly outside may be missing from the result.
    """

    origin: NDArray[np.floating]
    direction: NDArray[np.floating]
    start: NDArray[np.floating]
    end: NDArray[np.floating]

    def __len__(self) -> int:
        return len(self.origin)

    def moved(self, rigid: Rigid) -> RayBundle:
        """The same rays in another frame."""
        return RayBundle(rigid.point(self.origin), rigid.direction(self.direction), self.start, self.end)

    def part(self, chosen: NDArray | slice) -> RayBundle:
        """A selection of the rays."""
        return RayBundle(self.origin[chosen], self.direction[chosen], self.start[chosen], self.end[chosen])


def join_rays(bundles: list[RayBundle]) -> RayBundle:
    """One bundle of several, in order."""
    fields = ("origin", "direction", "start", "end")
    return RayBundle(*(np.concatenate([getattr(b, f) for b in bundles]) for f in fields))
