"""One element of a cutter's meridian: a straight line or a convex arc in the (r, z) half plane."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.grazing import MeridianPoints


@dataclass(frozen=True)
class Element:
    """A line (``radius`` 0) or a convex arc from ``start`` to ``end``, both (r, z) [mm].

    The tool's material lies on the left. An arc turns left about its ``centre``, by at most 180 deg; the
    centre may lie beyond the axis (r < 0), as a slender barrel's does.
    """

    start: tuple[float, float]
    end: tuple[float, float]
    centre: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0

    @property
    def is_arc(self) -> bool:
        return self.radius > 0.0

    @property
    def is_flat(self) -> bool:
        """A disc or annulus normal to the axis, whose effective radius r/nr is infinite."""
        return not self.is_arc and abs(self.end[1] - self.start[1]) <= 1e-12 * self.length

    @property
    def kind(self) -> str:
        """``arc``, ``flat`` or ``line``."""
        return "arc" if self.is_arc else "flat" if self.is_flat else "line"

    @cached_property
    def angles(self) -> tuple[float, float]:
        """An arc's first and last normal, as rising angles [rad] from the radial direction, up."""
        (r0, z0), (r1, z1), (rc, zc) = self.start, self.end, self.centre
        first, last = float(np.arctan2(z0 - zc, r0 - rc)), float(np.arctan2(z1 - zc, r1 - rc))
        return first, last + 2.0 * np.pi if last < first else last

    @cached_property
    def length(self) -> float:
        """Arc length [mm]."""
        if self.is_arc:
            first, last = self.angles
            return self.radius * (last - first)
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Smallest and largest r, smallest and largest z [mm] on the element."""
        low, high = np.minimum(self.start, self.end), np.maximum(self.start, self.end)
        if self.is_arc:
            first, last = self.angles
            quarter = 0.5 * np.pi * np.arange(np.ceil(2.0 * first / np.pi), np.floor(2.0 * last / np.pi) + 1.0)
            extremes = np.array(self.centre) + self.radius * np.column_stack([np.cos(quarter), np.sin(quarter)])
            low, high = np.vstack([low, extremes]).min(axis=0), np.vstack([high, extremes]).max(axis=0)
        return float(low[0]), float(high[0]), float(low[1]), float(high[1])

    def at(self, s: NDArray) -> MeridianPoints:
        """Points at arc lengths s [mm] from the element's start; s beyond its ends extends it smoothly."""
        s = np.asarray(s, dtype=float)
        if self.is_arc:
            angle = self.angles[0] + s / self.radius
            nr, nz = np.cos(angle), np.sin(angle)
            r, z = self.centre[0] + self.radius * nr, self.centre[1] + self.radius * nz
            return MeridianPoints(r, z, nr, nz, np.full(s.shape, 1.0 / self.radius))
        tr, tz = self._tangent
        constant = np.ones(s.shape)
        return MeridianPoints(self.start[0] + tr * s, self.start[1] + tz * s, tz * constant, -tr * constant, 0.0 * s)

    @property
    def _tangent(self) -> tuple[float, float]:
        return (self.end[0] - self.start[0]) / self.length, (self.end[1] - self.start[1]) / self.length

    def arc_length_at(self, r: NDArray, z: NDArray) -> NDArray:
        """Arc lengths s [mm] of points on the element."""
        if not self.is_arc:
            return np.hypot(r - self.start[0], z - self.start[1])
        turned = np.arctan2(z - self.centre[1], r - self.centre[0]) - self.angles[0]
        return self.radius * ((turned + 1.0) % (2.0 * np.pi) - 1.0)  # a rounding error before the start stays small

    def widest_at(self, z: NDArray) -> NDArray:
        """Largest radius [mm] of the element's points at heights z [mm], any shape; -inf where it has none."""
        if self.is_flat:
            return np.where(z == self.start[1], max(self.start[0], self.end[0]), -np.inf)
        inside = (self.box[2] <= z) & (z <= self.box[3])
        if not self.is_arc:
            share = (z - self.start[1]) / (self.end[1] - self.start[1])
            return np.where(inside, self.start[0] + share * (self.end[0] - self.start[0]), -np.inf)
        half = np.sqrt(np.maximum(self.radius**2 - (z - self.centre[1]) ** 2, 0.0))
        middle = 0.5 * sum(self.angles)
        spread = np.cos(0.5 * (self.angles[1] - self.angles[0])) - 1e-12
        out = np.full(np.shape(z), -np.inf)
        for side in (-half, half):
            on = inside & (side * np.cos(middle) + (z - self.centre[1]) * np.sin(middle) >= spread * self.radius)
            out = np.where(on, self.centre[0] + side, out)
        return out

    def nearest(self, r: NDArray, z: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """The element's points nearest to (r, z) and the normals there: (pr, pz, nr, nz)."""
        if not self.is_arc:
            tr, tz = self._tangent
            s = np.clip((r - self.start[0]) * tr + (z - self.start[1]) * tz, 0.0, self.length)
            return self.start[0] + s * tr, self.start[1] + s * tz, np.full(r.shape, tz), np.full(r.shape, -tr)
        dr, dz = r - self.centre[0], z - self.centre[1]
        size = np.hypot(dr, dz)
        first, last = self.angles
        middle, half = 0.5 * (first + last), 0.5 * (last - first)
        at_centre = size < 1e-300
        size = np.where(at_centre, 1.0, size)
        nr, nz = np.where(at_centre, np.cos(middle), dr / size), np.where(at_centre, np.sin(middle), dz / size)
        beyond = nr * np.cos(middle) + nz * np.sin(middle) < np.cos(half)
        end = np.where(nz * np.cos(middle) - nr * np.sin(middle) < 0.0, first, last)
        nr, nz = np.where(beyond, np.cos(end), nr), np.where(beyond, np.sin(end), nz)
        return self.centre[0] + self.radius * nr, self.centre[1] + self.radius * nz, nr, nz
