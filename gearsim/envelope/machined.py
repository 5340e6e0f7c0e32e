"""The machined surface along rays: the closed-form crossing that survives trimming."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.candidates import Crossings, Kind, all_candidates
from gearsim.envelope.trim import path_distance
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource

TRIM_TOLERANCE = 1e-9
_CLEAR = 2.0 * TRIM_TOLERANCE  # farther off, a distance is not needed exactly
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

    def share(self) -> dict[str, float]:
        """Fraction of the rays in each class."""
        return {k.name.lower(): float(np.mean(self.kind == k)) for k in Kind}


def machined_along(rays: RayBundle, sources: Sequence[MotionSource], cutter: Profile) -> EnvelopeRoad:
    """Where rays whose material lies behind their origin meet the surface machined by some motions.

    From an origin that no pose reaches, outward to the first surviving crossing; from one inside the cut,
    inward to it. A candidate survives if no pose of any exact motion holds it deeper than 1e-9 mm. Rays that
    find nothing near their origin, or on whose way to the crossing another one was missed, are searched
    along their whole window. Slices of the rays run on all cores: NumPy lets go of the interpreter.
    """
    if not len(rays):
        none = Crossings(*(np.empty(0, dtype=k) for k in (int, float, int, int, float, int, float, float)))
        return _road(0, none, np.empty(0, dtype=int))
    cores = os.cpu_count() or 1
    ends = np.linspace(0, len(rays), cores + 1).astype(int) if len(rays) >= _SLICED else np.array([0, len(rays)])
    parts = [rays.part(slice(a, b)) for a, b in pairwise(ends)]
    with ThreadPoolExecutor(cores) as pool:
        roads = list(pool.map(lambda part: _machined(part, sources, cutter), parts))
    return EnvelopeRoad(*(np.concatenate(c) for c in zip(*(road.columns() for road in roads), strict=True)))


def _machined(rays: RayBundle, sources: Sequence[MotionSource], cutter: Profile) -> EnvelopeRoad:
    inside = _least_distance(sources, cutter, rays.origin) < 0.0
    road = _search(rays, sources, cutter, inside, thorough=False)
    again = np.flatnonzero(~road.valid | _passes_a_crossing(rays, sources, cutter, inside, road.deviation))
    if len(again):
        found = _search(rays.part(again), sources, cutter, inside[again], thorough=True)
        for old, new in zip(road.columns(), found.columns(), strict=True):
            old[again] = new
    return road


def _search(
    rays: RayBundle, sources: Sequence[MotionSource], cutter: Profile, inside: NDArray, thorough: bool
) -> EnvelopeRoad:
    found = [all_candidates(rays, source, cutter, thorough) for source in sources]
    path = np.repeat(np.arange(len(sources)), [len(f.ray) for f in found])
    every = Crossings(*(np.concatenate(columns) for columns in zip(*found, strict=True)))
    ahead = np.flatnonzero(_ahead(every, inside))
    every, path = Crossings(*(c[ahead] for c in every)), path[ahead]
    points = rays.origin[every.ray] + every.tau[:, None] * rays.direction[every.ray]
    standing = _least_distance(sources, cutter, points) > -TRIM_TOLERANCE
    chosen = _nearest(every, standing)
    return _road(len(rays), Crossings(*(c[chosen] for c in every)), path[chosen])


def _passes_a_crossing(
    rays: RayBundle, sources: Sequence[MotionSource], cutter: Profile, inside: NDArray, deviation: NDArray
) -> NDArray:
    """Whether points on the way from the origin to the crossing lie in the other state than the origin.

    A crossing behind a missed one leads back: a nanometre before it, too, the state is the other one.
    """
    way = np.abs(np.nan_to_num(deviation))
    passes = np.zeros(len(rays), dtype=bool)
    for share, least in ((0.25, _CHECKED), (0.5, _CHECKED), (0.75, _CHECKED), (1.0, 4.0 * _BEFORE)):
        row = np.flatnonzero(way > least)
        tau = share * deviation[row] - (np.copysign(_BEFORE, deviation[row]) if share == 1.0 else 0.0)
        distance = _least_distance(sources, cutter, rays.origin[row] + tau[:, None] * rays.direction[row])
        passes[row] |= np.where(inside[row], distance > TRIM_TOLERANCE, distance < -TRIM_TOLERANCE)
    return passes


def _least_distance(sources: Sequence[MotionSource], cutter: Profile, points: NDArray) -> NDArray:
    return np.min([path_distance(source, cutter, points, floor=_CLEAR) for source in sources], axis=0)


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
