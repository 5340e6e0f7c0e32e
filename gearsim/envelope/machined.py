"""The machined surface along rays: the closed-form crossing that survives trimming."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.crossings import Crossings, Kind, together
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource

if TYPE_CHECKING:
    from gearsim.envelope.candidates import Candidates

TRIM_TOLERANCE = 1e-9
_CHECKED = 1e-3
_BEFORE = 1e-6
_SLICED = 256


@dataclass(frozen=True)
class EnvelopeRoad:
    """Deviation of the machined surface by the envelope road, per ray, each field of shape (n,).

    ``deviation`` [mm] along the ray's direction, nan where no class reaches the window; ``kind`` the
    class there (0: none); ``path`` (which motion), ``piece`` and ``t`` the pose; ``element``, ``s``,
    ``branch`` the profile point where the class is ENVELOPE.
    """

    deviation: NDArray
    kind: NDArray
    path: NDArray
    piece: NDArray
    t: NDArray
    element: NDArray
    s: NDArray
    branch: NDArray

    @property
    def valid(self) -> NDArray:
        return self.kind > 0

    def columns(self) -> list[NDArray]:
        """The fields in order."""
        return [getattr(self, f) for f in self.__dataclass_fields__]

    def part(self, rows: slice) -> EnvelopeRoad:
        """The same of some rays."""
        return EnvelopeRoad(*(column[rows] for column in self.columns()))

    def share(self) -> dict[str, float]:
        """Fraction of the rays in each class, 0 of none."""
        return {k.name.lower(): int(np.count_nonzero(self.kind == k)) / max(len(self.kind), 1) for k in Kind}


def machined_along(
    rays: RayBundle, sources: Sequence[MotionSource], cutter: Profile, device: str = "cpu"
) -> EnvelopeRoad:  # fmt: skip
    """Where rays whose material lies behind their origin meet the surface machined by some motions.

    From an origin that no pose reaches, outward to the first surviving crossing; from one inside the cut,
    inward to it. A candidate survives if no pose of any exact motion holds it deeper than 1e-9 mm. Rays that
    find nothing near their origin, or on whose way to the crossing another one was missed, are searched
    along their whole window. On the CPU slices of the rays run on all cores.
    """
    if not len(rays):
        return _road(0, together([]), np.empty(0, dtype=int))
    from gearsim.envelope.candidates import Candidates  # Warp loads with them: who only draws results can do without
    from gearsim.envelope.swept import Swept

    machined = Machined([Candidates(Swept(source, cutter, device)) for source in sources])
    cores = (os.cpu_count() or 1) if device == "cpu" and len(rays) >= _SLICED else 1
    ends = np.linspace(0, len(rays), cores + 1).astype(int)
    with ThreadPoolExecutor(cores) as pool:
        roads = list(pool.map(lambda span: machined.along(rays.part(slice(*span))), pairwise(ends)))
    return EnvelopeRoad(*(np.concatenate(c) for c in zip(*(road.columns() for road in roads), strict=True)))


@dataclass(frozen=True)
class Machined:
    """What some motions leave, each with its candidates."""

    motions: list[Candidates]

    def along(self, rays: RayBundle) -> EnvelopeRoad:
        """The machined surface along rays."""
        inside = self._reaches(rays.origin, 0.0)
        road = self._search(rays, inside, thorough=False)
        again = np.flatnonzero(~road.valid | self._passes_a_crossing(rays, inside, road.deviation))
        if len(again):
            found = self._search(rays.part(again), inside[again], thorough=True)
            for old, new in zip(road.columns(), found.columns(), strict=True):
                old[again] = new
        return road

    def _search(self, rays: RayBundle, inside: NDArray, thorough: bool) -> EnvelopeRoad:
        found = [self._near(motion, rays, thorough) for motion in self.motions]
        path = np.repeat(np.arange(len(found)), [len(f.ray) for f in found])
        every = together(found)
        ahead = np.flatnonzero(_ahead(every, inside))
        every, path = Crossings(*(c[ahead] for c in every)), path[ahead]
        points = rays.origin[every.ray] + every.tau[:, None] * rays.direction[every.ray]
        chosen = _nearest(every, ~self._reaches(points, TRIM_TOLERANCE))
        return _road(len(rays), Crossings(*(c[chosen] for c in every)), path[chosen])

    def _near(self, motion: Candidates, rays: RayBundle, thorough: bool) -> Crossings:
        """Candidates of one motion; of several, only along rays whose window its cutter comes near."""
        if len(self.motions) == 1:
            return motion.along(rays, thorough)
        window = float(max(rays.end.max(), -rays.start.min()))
        near = np.flatnonzero(motion.swept.least_distance(rays.origin, floor=window, enough=window) <= window)
        found = motion.along(rays.part(near), thorough)
        return found._replace(ray=near[found.ray])

    def _passes_a_crossing(self, rays: RayBundle, inside: NDArray, deviation: NDArray) -> NDArray:
        """Whether points on the way from the origin to the crossing lie in the other state than the origin.

        A crossing behind a missed one leads back: a nanometre before it, too, the state is the other one.
        """
        way = np.abs(np.nan_to_num(deviation))
        shares = [(0.25, _CHECKED), (0.5, _CHECKED), (0.75, _CHECKED), (1.0, 4.0 * _BEFORE)]
        rows = [np.flatnonzero(way > least) for _, least in shares]
        tau = [
            share * deviation[row] - (np.copysign(_BEFORE, deviation[row]) if share == 1.0 else 0.0)
            for (share, _), row in zip(shares, rows, strict=True)
        ]
        row, along = np.concatenate(rows), np.concatenate(tau)
        points = rays.origin[row] + along[:, None] * rays.direction[row]
        cuts_in = inside[row]
        other = np.empty(len(row), dtype=bool)
        other[cuts_in] = ~self._reaches(points[cuts_in], -TRIM_TOLERANCE)
        other[~cuts_in] = self._reaches(points[~cuts_in], TRIM_TOLERANCE)
        return np.bincount(row[other], minlength=len(rays)) > 0

    def _reaches(self, points: NDArray, depth: float) -> NDArray:
        """Whether some pose holds points deeper than ``depth`` [mm], shape (n,)."""
        reached = np.zeros(len(points), dtype=bool)
        for motion in self.motions:
            left = np.flatnonzero(~reached)
            reached[left] = motion.swept.least_distance(points[left], floor=-depth, enough=-depth) < -depth
        return reached


def _ahead(found: Crossings, inside: NDArray) -> NDArray:
    """Which crossings lie in the direction to look: inward from inside the cut, outward otherwise."""
    inward = inside[found.ray]
    return np.where(inward, found.tau <= TRIM_TOLERANCE, found.tau >= -TRIM_TOLERANCE)


def _nearest(found: Crossings, allowed: NDArray) -> NDArray:
    """Rows of the nearest allowed crossing of each ray that has one; ties go to the first class."""
    rows = np.flatnonzero(allowed)
    rows = rows[np.lexsort((found.kind[rows], np.abs(found.tau[rows]), found.ray[rows]))]
    return rows[np.unique(found.ray[rows], return_index=True)[1]]


def _road(n: int, found: Crossings, path: NDArray) -> EnvelopeRoad:
    """Spread the chosen crossings over all rays."""

    def spread(values: NDArray, missing: float) -> NDArray:
        out = np.full(n, missing, dtype=values.dtype)
        out[found.ray] = values
        return out

    return EnvelopeRoad(
        spread(found.tau, np.nan), spread(found.kind, 0), spread(path, -1), spread(found.piece, -1),
        spread(found.t, np.nan), spread(found.element, -1), spread(found.s, np.nan), spread(found.branch, 0),
    )  # fmt: skip
