"""Deviation of the machined surface along rays: positive is material left, negative is overcut."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.simulation.intervals import IntervalSet


class Crossing(IntEnum):
    """What a ray met inside its window; ABSENT: there is no surface to measure and no ray was sent."""

    MEASURED = 0
    UNCUT = 1
    THROUGH = 2
    ABSENT = 3


@dataclass(frozen=True)
class Deviation:
    """Deviations along rays, each field of the rays' grid shape.

    ``value`` [mm], nan unless ``crossing`` [Crossing] is MEASURED: UNCUT, no cut within the outward
    window (at least that much material is left); THROUGH, the cut goes past the inward window.
    ``segment`` made the crossing (-1: none); ``multiple``: there is more material or air farther out.
    """

    value: NDArray[np.floating]
    crossing: NDArray[np.integer]
    segment: NDArray[np.integer]
    multiple: NDArray[np.bool_]

    @property
    def measured(self) -> NDArray:
        return self.crossing == Crossing.MEASURED

    def split(self, counts: Sequence[int]) -> list[Deviation]:
        """The deviations, shape (n,), of bundles of so many rays that were joined."""
        ends = np.cumsum(counts)[:-1]
        columns = (np.split(getattr(self, f), ends) for f in self.__dataclass_fields__)
        return [Deviation(*parts) for parts in zip(*columns, strict=True)]

    def reshaped(self, shape: tuple[int, int]) -> Deviation:
        """The same deviations on a grid."""
        return Deviation(*(getattr(self, f).reshape(shape) for f in self.__dataclass_fields__))

    def summary_um(self) -> dict[str, float | int | None]:
        """min, max, mean, rms [um] of the measured samples, and how many were uncut or cut through."""
        um = 1e3 * self.value[self.measured]
        numbers = {"min": None, "max": None, "mean": None, "rms": None} if not um.size else {
            "min": float(um.min()), "max": float(um.max()), "mean": float(um.mean()),
            "rms": float(np.sqrt(np.mean(um**2))),
        }  # fmt: skip
        return {
            **numbers,
            "samples": int(self.crossing.size),
            "uncut": int(np.count_nonzero(self.crossing == Crossing.UNCUT)),
            "through": int(np.count_nonzero(self.crossing == Crossing.THROUGH)),
        }


def measure(rays: RayBundle, removed: IntervalSet) -> Deviation:
    """Deviation along rays that have material behind their origin (in the window), from what was removed.

    A cut that holds the origin is followed inward to its start; otherwise the first cut outward counts.
    """
    n = len(rays)
    reaching = np.flatnonzero(removed.hi >= 0.0)
    ray, first = np.unique(removed.ray[reaching], return_index=True)
    row = reaching[first]
    value, segment = np.full(n, np.inf), np.full(n, -1)
    value[ray], segment[ray] = removed.lo[row], removed.lo_segment[row]
    crossing = np.where(
        value > rays.end, Crossing.UNCUT, np.where(value < rays.start, Crossing.THROUGH, Crossing.MEASURED)
    )
    measured = crossing == Crossing.MEASURED
    multiple = np.zeros(n, dtype=bool)
    multiple[ray] = removed.hi[row] < rays.end[ray]
    return Deviation(np.where(measured, value, np.nan), crossing, np.where(measured, segment, -1), multiple & measured)
