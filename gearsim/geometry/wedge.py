"""A sector of a body of revolution: what lies between two half planes through the z axis."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.turned import Turned


@dataclass(frozen=True)
class Wedge:
    """The part of a turned body within ``half`` [rad], at most a quarter turn, on either side of ``middle`` [rad]."""

    solid: Turned
    middle: float
    half: float

    @property
    def planes(self) -> NDArray:
        """Unit normals, shape (2, 3), out of the sector's two sides."""
        angles = self.middle + np.array([-self.half, self.half])
        ways = np.array([1.0, -1.0])
        return np.stack([ways * np.sin(angles), -ways * np.cos(angles), 0.0 * angles], axis=1)

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        """Of the sector as it lies about +x, its middle turned there."""
        lower, upper = self.solid.box
        radius = self.solid.polygon[:, 0]
        side = float(radius.max()) * np.sin(self.half)
        return (
            np.array([float(radius.min()) * np.cos(self.half), -side, lower[2]]),
            np.array([float(radius.max()), side, upper[2]]),
        )

    @property
    def volume(self) -> float:
        return self.solid.volume * self.half / np.pi

    def contains(self, points: NDArray) -> NDArray:
        below, above = np.moveaxis(points @ self.planes.T, -1, 0)
        return self.solid.contains(points) & (below <= 0.0) & (above < 0.0)

    def signed_distance(self, points: NDArray) -> NDArray:
        """Exact beside a face, no more than the true distance outside an edge."""
        return np.maximum(self.solid.signed_distance(points), (points @ self.planes.T).max(axis=-1))

    def normals(self, points: NDArray) -> NDArray:
        off = points @ self.planes.T
        distance = np.column_stack([np.abs(self.solid.signed_distance(points)), np.abs(off)])
        face = np.argmin(distance, axis=1)
        return np.where((face == 0)[:, None], self.solid.normals(points), self.planes[np.maximum(face - 1, 0)])

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        start, end = np.full(len(origins), -np.inf), np.full(len(origins), np.inf)
        for number, plane in enumerate(self.planes):
            off, rate = origins @ plane, directions @ plane
            beside = rate == 0.0
            at = -off / np.where(beside, 1.0, rate)
            start = np.where(~beside & (rate < 0.0), np.maximum(start, at), start)
            end = np.where(~beside & (rate > 0.0), np.minimum(end, at), end)
            outside = off > 0.0 if number == 0 else off >= 0.0
            end = np.where(beside & outside, -np.inf, end)
        ray, lo, hi = self.solid.chords(origins, directions)
        lo, hi = np.maximum(lo, start[ray]), np.minimum(hi, end[ray])
        inside = hi > lo
        return ray[inside], lo[inside], hi[inside]
