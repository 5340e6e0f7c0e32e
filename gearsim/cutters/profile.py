"""A cutter's meridian in the (r, z) half plane: an ordered chain of lines and arcs with their normals.

The chain runs from the axis at the tip, outward and up, back to the axis at the top; that of a ring (the
head of a face mill) is closed and does not touch the axis. The material lies on its left. Tool frame:
origin at the tip, +z away from it. Lengths in mm.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.checks import CORNER, joints, problem, turn
from gearsim.cutters.element import Element
from gearsim.errors import InputError
from gearsim.geometry.grazing import MeridianPoints

__all__ = ["Element", "Profile"]

_ON_AXIS = 1e-9
_Pair = tuple[NDArray, NDArray]


@dataclass(frozen=True)
class Profile:
    """A cutter as a chain of elements; build one with the functions of the catalogue.

    Reentrant corners (undercut tools: lollipop, T-slot, dovetail) are allowed where the chain rises all
    along; concave arcs are not. Raises InputError for what no cutter can be.
    """

    name: str
    elements: tuple[Element, ...]

    def __post_init__(self) -> None:
        wrong = problem(self.elements, bool(self.elements) and self.is_ring)
        if wrong:
            raise InputError(f"cutter {self.name!r}: {wrong}")

    @cached_property
    def is_ring(self) -> bool:
        """Whether the chain is closed and leaves a hole around the axis."""
        first, last = self.elements[0].start, self.elements[-1].end
        return bool(np.hypot(first[0] - last[0], first[1] - last[1]) <= _ON_AXIS) and first[0] > _ON_AXIS

    @cached_property
    def is_convex(self) -> bool:
        """Whether the whole tool is a convex body."""
        return not self.is_ring and not self._reentrant

    @cached_property
    def _reentrant(self) -> list[int]:
        pairs = enumerate(joints(self.elements, self.is_ring))
        return [i for i, (a, b) in pairs if turn(a, b) < -CORNER]

    @cached_property
    def parts(self) -> tuple[Profile, ...]:
        """Convex cutters whose union is the tool, from the tip up, overlapping; a convex one or a ring itself."""
        if not self._reentrant:
            return (self,)
        cuts = [0, *(i + 1 for i in self._reentrant), len(self.elements)]
        runs = [list(self.elements[a:b]) for a, b in pairwise(cuts)]
        bodies = [_closed(self.name, run) for run in runs]
        longer = [list(run) for run in runs]
        for k in range(len(runs) - 1):
            below, above = runs[k][-1], runs[k + 1][0]
            if _rise(above, 0.0) >= _rise(below, below.length):
                longer[k + 1] = _prolonged_down(longer[k + 1], bodies[k])
            else:
                longer[k] = _prolonged_up(longer[k], bodies[k + 1])
        return tuple(_closed(f"{self.name}, part {k + 1}", run) for k, run in enumerate(longer))

    @cached_property
    def box(self) -> tuple[float, float, float, float]:
        """Smallest and largest r, smallest and largest z [mm]."""
        boxes = np.array([e.box for e in self.elements])
        low, high = boxes.min(axis=0), boxes.max(axis=0)
        return float(low[0]), float(high[1]), float(low[2]), float(high[3])

    @property
    def height(self) -> float:
        """Height of the tool's top over its tip [mm]."""
        return self.box[3]

    @property
    def max_radius(self) -> float:
        """Largest radius [mm]."""
        return self.box[1]

    @property
    def min_radius(self) -> float:
        """Smallest radius [mm]: that of a ring's hole, else 0."""
        return self.box[0]

    @property
    def reach(self) -> float:
        """Largest distance of any tool point from the tip [mm], from above."""
        return float(np.hypot(max(self.box[3], -self.box[2]), self.max_radius))

    def radius_at(self, z: float) -> float:
        """Largest radius [mm] of the tool at height z [mm]; raises InputError beyond its ends."""
        return float(self.radii_at(np.array([z]))[0])

    def radii_at(self, z: NDArray) -> NDArray:
        """Largest radii [mm] at heights z [mm], shape (n,); raises InputError beyond the tool's ends."""
        beyond = ~((self.box[2] <= z) & (z <= self.height))
        if beyond.any():
            ends = f"{self.box[2]:g} to {self.height:g} mm"
            raise InputError(f"cutter {self.name!r} has no section at z = {z[beyond][0]:g} mm ({ends})")
        return np.asarray(np.max([e.widest_at(z) for e in self.elements], axis=0))

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
        """Convex joints, named by the element before them, where the normal jumps: sharp circles that can cut."""
        pairs = enumerate(joints(self.elements, self.is_ring))
        return tuple(i for i, (a, b) in pairs if turn(a, b) > CORNER)

    def at(self, element: NDArray, s: NDArray) -> MeridianPoints:
        """Points at arc lengths s [mm] of the elements with the given indices, both shape (n,)."""
        columns = np.empty((5, *np.shape(s)))
        for i, e in enumerate(self.elements):
            mine = element == i
            columns[:, mine] = np.stack(e.at(s[mine]))
        return MeridianPoints(*columns)

    def nearest(self, r: NDArray, z: NDArray) -> tuple[NDArray, NDArray]:
        """The element, and the arc length [mm] on it, of the profile's point nearest to (r, z), shape (n,)."""
        foot = [e.nearest(r, z)[:2] for e in self.elements]
        element = np.argmin([(r - pr) ** 2 + (z - pz) ** 2 for pr, pz in foot], axis=0)
        lengths = [np.clip(e.arc_length_at(*f), 0.0, e.length) for e, f in zip(self.elements, foot, strict=True)]
        return element, np.choose(element, lengths)

    def distance_gradient(self, r: NDArray, z: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Signed distance [mm] of points (r >= 0, z), any shape, negative inside, and its gradient (nr, nz).

        The nearest element rules; of two that meet in the nearest corner, the one seen more squarely. At a
        sharp edge, seen from outside, the gradient points from the edge; at a reentrant one, from inside, to it.
        """
        r, z = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(z, dtype=float))
        distance, nr, nz = np.empty(r.shape), np.empty(r.shape), np.empty(r.shape)
        for take, signed, (dr, dz), (mr, mz) in self._nearer(r, z):
            distance[take] = signed[take]
            gap = np.abs(signed[take])
            apart = gap > 1e-9
            scale = np.copysign(1.0, signed[take]) / np.where(apart, gap, 1.0)
            nr[take] = np.where(apart, dr[take] * scale, mr[take])
            nz[take] = np.where(apart, dz[take] * scale, mz[take])
        return distance, nr, nz

    def _nearer(self, r: NDArray, z: NDArray) -> Iterator[tuple[NDArray, NDArray, _Pair, _Pair]]:
        """Element by element: whose points it is nearest to so far, its distance, the way from its foot, its normal."""
        best, square = np.full(r.shape, np.inf), np.zeros(r.shape)
        for e in self.elements:
            pr, pz, mr, mz = e.nearest(r, z)
            dr, dz = r - pr, z - pz
            gap, along = np.sqrt(dr * dr + dz * dz), dr * mr + dz * mz
            tie, squarely = 1e-12 * (1.0 + gap), np.abs(along)
            take = (gap < best - tie) | ((gap <= best + tie) & (squarely > square))
            best, square = np.where(take, gap, best), np.where(take, squarely, square)
            yield take, np.where(along > 0.0, gap, -gap), (dr, dz), (mr, mz)

    def signed_distance(self, r: NDArray, z: NDArray) -> NDArray:
        """Signed distance [mm] of points (r >= 0, z), any shape, to the tool: negative inside."""
        r, z = np.broadcast_arrays(np.asarray(r, dtype=float), np.asarray(z, dtype=float))
        distance = np.empty(r.shape)
        for take, signed, *_ in self._nearer(r, z):
            distance = np.where(take, signed, distance)
        return distance


def _rise(e: Element, s: float) -> float:
    """How steeply an element rises along the axis at arc length s: 1 parallel to it, 0 level."""
    return float(e.at(np.array(s)).nr)


def _closed(name: str, run: list[Element]) -> Profile:
    """The body of a rising run of elements, closed by discs."""
    (r0, z0), (r1, z1) = run[0].start, run[-1].end
    bottom = [Element((0.0, z0), (r0, z0))] if r0 > _ON_AXIS else []
    top = [Element((r1, z1), (0.0, z1))] if r1 > _ON_AXIS else []
    return Profile(name, (*bottom, *run, *top))


def _prolonged_down(run: list[Element], body: Profile) -> list[Element]:
    """A run prolonged straight below its start, as far as that stays within the body beneath."""
    p = run[0].at(np.array(0.0))
    start = _last_inside(body, run[0].start, (float(p.nz), -float(p.nr)))
    if run[0].is_arc:
        return [Element(start, run[0].start), *run]
    return [Element(start, run[0].end), *run[1:]]


def _prolonged_up(run: list[Element], body: Profile) -> list[Element]:
    """A run prolonged straight above its end, as far as that stays within the body above."""
    p = run[-1].at(np.array(run[-1].length))
    end = _last_inside(body, run[-1].end, (-float(p.nz), float(p.nr)))
    if run[-1].is_arc:
        return [*run, Element(run[-1].end, end)]
    return [*run[:-1], Element(run[-1].start, end)]


def _last_inside(body: Profile, start: tuple[float, float], way: tuple[float, float]) -> tuple[float, float]:
    """Nearly the last point on the way from a corner of a convex body that lies in it and not beyond the axis.

    A millionth short of it: the overlap serves as well, and rounding puts no point outside the body.
    """
    inside, outside = 0.0, 2.0 * body.reach
    for _ in range(60):
        middle = 0.5 * (inside + outside)
        r, z = start[0] + middle * way[0], start[1] + middle * way[1]
        if r >= 0.0 and body.signed_distance(np.array(r), np.array(z)) <= 1e-12:
            inside = middle
        else:
            outside = middle
    inside *= 1.0 - 1e-6
    r, z = start[0] + inside * way[0], start[1] + inside * way[1]
    return (0.0, z) if r <= _ON_AXIS else (r, z)
