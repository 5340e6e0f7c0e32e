"""A cutter's meridian in the (r, z) half plane: an ordered chain of lines and arcs with their normals.

The chain runs from the axis at the tip, outward and up, back to the axis at the top; the material of the
tool lies on its left. Tool frame: origin at the tip, +z away from it. Lengths in mm.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.grazing import MeridianPoints


@dataclass(frozen=True)
class Element:
    """A line (``radius`` 0) or a convex arc from ``start`` to ``end``, both (r, z) [mm]."""

    start: tuple[float, float]
    end: tuple[float, float]
    centre: tuple[float, float] = (0.0, 0.0)
    radius: float = 0.0

    @property
    def is_arc(self) -> bool:
        return self.radius > 0.0

    @property
    def is_flat(self) -> bool:
        """A disc normal to the axis, whose effective radius r/nr is infinite."""
        return not self.is_arc and self.start[1] == self.end[1]

    @property
    def angles(self) -> tuple[float, float]:
        """An arc's first and last normal, as angles [rad] from the radial direction, up."""
        (r0, z0), (r1, z1), (rc, zc) = self.start, self.end, self.centre
        first, last = np.arctan2(z0 - zc, r0 - rc), np.arctan2(z1 - zc, r1 - rc)
        return float(first), float(last)

    @property
    def length(self) -> float:
        """Arc length [mm]."""
        if self.is_arc:
            first, last = self.angles
            return self.radius * (last - first)
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))

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

    def nearest(self, r: NDArray, z: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """The element's points nearest to (r, z) and the normals there: (pr, pz, nr, nz)."""
        if not self.is_arc:
            tr, tz = self._tangent
            s = np.clip((r - self.start[0]) * tr + (z - self.start[1]) * tz, 0.0, self.length)
            return self.start[0] + s * tr, self.start[1] + s * tz, np.full(r.shape, tz), np.full(r.shape, -tr)
        dr, dz = r - self.centre[0], z - self.centre[1]
        size = np.maximum(np.hypot(dr, dz), 1e-300)
        nr, nz = dr / size, dz / size
        first, last = self.angles
        middle, half = 0.5 * (first + last), 0.5 * (last - first)
        beyond = nr * np.cos(middle) + nz * np.sin(middle) < np.cos(half)
        end = np.where(nz * np.cos(middle) - nr * np.sin(middle) < 0.0, first, last)
        nr, nz = np.where(beyond, np.cos(end), nr), np.where(beyond, np.sin(end), nz)
        return self.centre[0] + self.radius * nr, self.centre[1] + self.radius * nz, nr, nz


@dataclass(frozen=True)
class Profile:
    """A convex cutter as a chain of elements; build one with the functions of the catalogue."""

    name: str
    elements: tuple[Element, ...]

    def __post_init__(self) -> None:
        if not self.elements:
            raise InputError(f"cutter {self.name!r} has an empty profile")
        for a, b in zip(self.elements, self.elements[1:], strict=False):
            if np.hypot(a.end[0] - b.start[0], a.end[1] - b.start[1]) > 1e-9:
                raise InputError(f"cutter {self.name!r}: the profile has a gap between {a.end} and {b.start}")
        for e in self.elements:
            if min(e.start[0], e.end[0]) < -1e-12 or e.length <= 0.0:
                raise InputError(f"cutter {self.name!r}: profile element {e.start} to {e.end} is empty or r < 0")
        turns = [self._turn(a, b) for a, b in zip(self.elements, self.elements[1:], strict=False)]
        if min(turns, default=0.0) < -1e-9:
            raise InputError(f"cutter {self.name!r}: the profile is not convex; only convex cutters are supported")

    @staticmethod
    def _turn(a: Element, b: Element) -> float:
        before, after = a.at(np.array(a.length)), b.at(np.array(0.0))
        return float(before.nr * after.nz - before.nz * after.nr)

    @property
    def height(self) -> float:
        """Length of the tool along its axis [mm]."""
        return max(e.end[1] for e in self.elements)

    @property
    def max_radius(self) -> float:
        """Largest radius [mm]."""
        return max(self.element_radius(e) for e in self.elements)

    @staticmethod
    def element_radius(e: Element) -> float:
        """Largest radius [mm] on one element."""
        ends = max(e.start[0], e.end[0])
        if e.is_arc and e.angles[0] < 0.0 < e.angles[1]:
            return e.centre[0] + e.radius
        return ends

    @property
    def reach(self) -> float:
        """Largest distance of any tool point from the tip [mm], from above."""
        return float(np.hypot(self.height, self.max_radius))

    def radius_at(self, z: float) -> float:
        """Radius [mm] of the tool at height z [mm]."""
        if not 0.0 <= z <= self.height:
            raise InputError(f"cutter {self.name!r} has no section at z = {z:g} mm (0 to {self.height:g} mm)")
        radii = []
        for e in self.elements:
            if not e.is_flat and e.start[1] <= z <= e.end[1]:
                if e.is_arc:
                    radii.append(e.centre[0] + np.sqrt(max(e.radius**2 - (z - e.centre[1]) ** 2, 0.0)))
                else:
                    radii.append(np.interp(z, [e.start[1], e.end[1]], [e.start[0], e.end[0]]))
        return float(max(radii))

    @cached_property
    def flank(self) -> int:
        """Index of the straight flank: the longest line that is not a disc.

        Raises InputError where the cutter has none (a ball).
        """
        lines = [i for i, e in enumerate(self.elements) if not e.is_arc and not e.is_flat]
        if not lines:
            raise InputError(f"cutter {self.name!r} has no straight flank to mill a ruled surface with")
        return max(lines, key=lambda i: self.elements[i].length)

    @cached_property
    def edges(self) -> tuple[int, ...]:
        """Joints, named by the element before them, where the normal jumps: sharp circles of the tool."""
        pairs = enumerate(zip(self.elements, self.elements[1:], strict=False))
        return tuple(i for i, (a, b) in pairs if self._turn(a, b) > 1e-9)

    def at(self, element: NDArray, s: NDArray) -> MeridianPoints:
        """Points at arc lengths s [mm] of the elements with the given indices, both shape (n,)."""
        columns = np.empty((5, *np.shape(s)))
        for i, e in enumerate(self.elements):
            mine = element == i
            columns[:, mine] = np.stack(e.at(s[mine]))
        return MeridianPoints(*columns)

    def distance_gradient(self, r: NDArray, z: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Signed distance [mm] of points (r >= 0, z), any shape, negative inside, and its gradient (nr, nz).

        The nearest element rules; at a sharp edge, seen from outside, the gradient points from the edge.
        """
        r, z = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(z, dtype=float))
        best = np.full(r.shape, np.inf)
        distance, nr, nz = np.empty(r.shape), np.empty(r.shape), np.empty(r.shape)
        for e in self.elements:
            pr, pz, mr, mz = e.nearest(r, z)
            dr, dz = r - pr, z - pz
            gap2 = dr * dr + dz * dz
            inward = dr * mr + dz * mz <= 0.0
            take = (gap2 < best) | ((gap2 == best) & ~inward)
            best[take] = gap2[take]
            gap = np.sqrt(gap2[take])
            distance[take] = np.where(inward[take], -gap, gap)
            apart = ~inward[take] & (gap > 1e-9)
            scale = 1.0 / np.where(apart, gap, 1.0)
            nr[take] = np.where(apart, dr[take] * scale, mr[take])
            nz[take] = np.where(apart, dz[take] * scale, mz[take])
        return distance, nr, nz

    def signed_distance(self, r: NDArray, z: NDArray) -> NDArray:
        """Signed distance [mm] of points (r >= 0, z), any shape, to the tool: negative inside."""
        return self.distance_gradient(r, z)[0]
