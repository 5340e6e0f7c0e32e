"""The machined surface along rays: the closed-form crossing that survives trimming."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.candidates import Crossings, Kind, all_candidates
from gearsim.envelope.trim import path_distance
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource

TRIM_TOLERANCE = 1e-9


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

    def share(self) -> dict[str, float]:
        """Fraction of the rays in each class."""
        return {k.name.lower(): float(np.mean(self.kind == k)) for k in Kind}


def machined_along(rays: RayBundle, sources: Sequence[MotionSource], cutter: Profile) -> EnvelopeRoad:
    """Where rays whose material lies behind their origin meet the surface machined by some motions.

    From an origin that no pose reaches, outward to the first surviving crossing; from one inside the cut,
    inward to it. A candidate survives if no pose of any exact motion holds it deeper than 1e-9 mm.
    """
    found = [all_candidates(rays, source, cutter) for source in sources]
    path = np.repeat(np.arange(len(sources)), [len(f.ray) for f in found])
    every = Crossings(*(np.concatenate(columns) for columns in zip(*found, strict=True)))
    points = rays.origin[every.ray] + every.tau[:, None] * rays.direction[every.ray]
    standing = _least_distance(sources, cutter, points) > -TRIM_TOLERANCE
    inside = _least_distance(sources, cutter, rays.origin) < 0.0
    chosen = _nearest(every, standing & _ahead(every, inside))
    return _road(len(rays), Crossings(*(c[chosen] for c in every)), path[chosen])


def _least_distance(sources: Sequence[MotionSource], cutter: Profile, points: NDArray) -> NDArray:
    return np.min([path_distance(source, cutter, points) for source in sources], axis=0)


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
