"""The machined surface along rays: the closed-form crossing that survives trimming."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.candidates import Crossings, Kind, all_candidates
from gearsim.envelope.trim import path_distance
from gearsim.motion.sources import MotionSource
from gearsim.simulation.rays import RayBundle

TRIM_TOLERANCE = 1e-9


@dataclass(frozen=True)
class EnvelopeRoad:
    """Deviation of the machined surface by the envelope road, per ray, each field of shape (n,).

    ``deviation`` [mm] along the ray's direction, nan where no class reaches the window; ``kind`` the
    class there (0: none); ``piece`` and ``t`` the pose; ``element``, ``s``, ``branch`` the profile point
    where the class is ENVELOPE.
    """

    deviation: NDArray
    kind: NDArray
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


def machined_along(rays: RayBundle, source: MotionSource, cutter: Profile) -> EnvelopeRoad:
    """Where rays whose material lies behind their origin meet the machined surface.

    From an origin that no pose reaches, outward to the first surviving crossing; from one inside the cut,
    inward to it. A candidate survives if no pose of the exact motion holds it deeper than 1e-9 mm.
    """
    found = all_candidates(rays, source, cutter)
    points = rays.origin[found.ray] + found.tau[:, None] * rays.direction[found.ray]
    standing = path_distance(source, cutter, points) > -TRIM_TOLERANCE
    inside = path_distance(source, cutter, rays.origin) < 0.0
    return _select(len(rays), Crossings(*(c[standing] for c in found)), inside)


def _select(n: int, found: Crossings, inside: NDArray) -> EnvelopeRoad:
    """The nearest crossing in the right direction; ties go to the first class."""
    inward = inside[found.ray]
    ahead = np.where(inward, found.tau <= TRIM_TOLERANCE, found.tau >= -TRIM_TOLERANCE)
    rows = np.flatnonzero(ahead)
    rows = rows[np.lexsort((found.kind[rows], np.abs(found.tau[rows]), found.ray[rows]))]
    ray, first = np.unique(found.ray[rows], return_index=True)
    rows = rows[first]
    deviation, s = np.full(n, np.nan), np.full(n, np.nan)
    kind, piece, element = np.zeros(n, dtype=int), np.full(n, -1), np.full(n, -1)
    t, branch = np.full(n, np.nan), np.zeros(n)
    deviation[ray], kind[ray], piece[ray], t[ray] = (
        found.tau[rows], found.kind[rows], found.piece[rows], found.t[rows],
    )  # fmt: skip
    element[ray], s[ray], branch[ray] = found.element[rows], found.s[rows], found.branch[rows]
    return EnvelopeRoad(deviation, kind, piece, t, element, s, branch)
