"""Solids of revolution bounded by straight lines in the axial half plane: turned blanks and stock."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Turned:
    """The solid swept by a simple polygon (radius, z) [mm], shape (n, 2), revolved about the z axis."""

    polygon: NDArray[np.floating]

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        """Lower and upper corner [mm], shape (3,), of the box along the axes around it."""
        radius, (low, high) = float(self.polygon[:, 0].max()), (self.polygon[:, 1].min(), self.polygon[:, 1].max())
        return np.array([-radius, -radius, low]), np.array([radius, radius, high])

    @property
    def volume(self) -> float:
        """Its volume [mm³]: the frustums under all edges, those that run back taken away."""
        (r0, z0), (r1, z1) = self.polygon.T, np.roll(self.polygon, -1, axis=0).T
        return abs(float(np.pi / 3.0 * ((z1 - z0) * (r0**2 + r0 * r1 + r1**2)).sum()))

    def contains(self, points: NDArray) -> NDArray:
        """Whether points, shape (..., 3), lie inside (even-odd rule in the half plane)."""
        radius, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
        inside = np.zeros(radius.shape, dtype=bool)
        for (r0, z0), (r1, z1) in self._edges():
            if z0 != z1:
                crosses = (z0 > z) != (z1 > z)
                inside ^= crosses & (radius < r0 + (z - z0) * (r1 - r0) / (z1 - z0))
        return inside

    def signed_distance(self, points: NDArray) -> NDArray:
        """Distance [mm] of points, shape (..., 3), from the solid's surface, negative inside."""
        radius, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
        square = np.full(radius.shape, np.inf)
        for start, end in self._edges():
            (dr, dz), off_r, off_z = end - start, radius - start[0], z - start[1]
            share = np.clip((off_r * dr + off_z * dz) / (dr * dr + dz * dz), 0.0, 1.0)
            square = np.minimum(square, (off_r - share * dr) ** 2 + (off_z - share * dz) ** 2)
        nearest = np.sqrt(square)
        return np.where(self.contains(points), -nearest, nearest)

    def normals(self, points: NDArray) -> NDArray:
        """Outward unit normals, shape (n, 3), of the faces that points, shape (n, 3) [mm], are nearest to."""
        radius = np.hypot(points[:, 0], points[:, 1])
        at = np.column_stack([radius, points[:, 2]])
        nearest, normal = np.full(len(points), np.inf), np.empty((len(points), 2))
        r, z = self.polygon.T
        outward = np.sign(r @ np.roll(z, -1) - z @ np.roll(r, -1))
        for start, end in self._edges():
            way, off = end - start, at - start
            if start[0] == end[0] == 0.0:
                continue  # the axis is no face
            share = np.clip(off @ way / (way @ way), 0.0, 1.0)
            away = np.linalg.norm(off - share[:, None] * way, axis=1)
            closer = away < nearest
            nearest[closer] = away[closer]
            normal[closer] = outward * np.array([way[1], -way[0]]) / np.linalg.norm(way)
        out = points[:, :2] / np.where(radius > 0.0, radius, 1.0)[:, None]
        return np.column_stack([normal[:, :1] * out, normal[:, 1]])

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Where rays run inside the solid.

        ``origins``, ``directions``: shape (n, 3), directions of unit length. Returns (ray, start, end):
        ray indices in rising order and the ends of their intervals [mm along the ray], rising per ray.
        """
        hits = [self._edge_hits(origins, directions, *edge) for edge in self._edges()]
        tau = np.sort(np.concatenate(hits, axis=1), axis=1)
        with np.errstate(invalid="ignore"):  # missing hits are +inf; inf - inf is no chord
            middle = 0.5 * (tau[:, :-1] + tau[:, 1:])
            real = np.isfinite(middle) & (tau[:, 1:] > tau[:, :-1])
        at = origins[:, None, :] + np.where(real, middle, 0.0)[..., None] * directions[:, None, :]
        ray, k = np.nonzero(real & self.contains(at))
        return _join(ray, tau[ray, k], tau[ray, k + 1])

    def _edges(self) -> list[tuple[NDArray, NDArray]]:
        return list(zip(self.polygon, np.roll(self.polygon, -1, axis=0), strict=True))

    @staticmethod
    def _edge_hits(origins: NDArray, directions: NDArray, start: NDArray, end: NDArray) -> NDArray:
        """The up to two parameters at which each ray meets the cone (or annulus) of one edge, else inf."""
        (r0, z0), (r1, z1) = start, end
        z, dz = origins[:, 2], directions[:, 2]
        with np.errstate(divide="ignore", invalid="ignore"):
            if z0 == z1:
                tau = ((z0 - z) / dz)[:, None]
                radius = np.hypot(
                    *(origins[:, :2, None] + tau[:, None, :] * directions[:, :2, None]).transpose(1, 0, 2)
                )
                good = np.isfinite(tau) & (radius >= min(r0, r1)) & (radius <= max(r0, r1))
                return np.where(good, tau, np.inf)
            slope = (r1 - r0) / (z1 - z0)
            edge, edge_rate = r0 + slope * (z - z0), slope * dz
            a = (directions[:, :2] ** 2).sum(1) - edge_rate**2
            b = (origins[:, :2] * directions[:, :2]).sum(1) - edge * edge_rate
            c = (origins[:, :2] ** 2).sum(1) - edge**2
            root = np.sqrt(b * b - a * c)
            q = -(b + np.copysign(root, b))
            tau = np.stack([q / a, c / q], axis=1)
        height = z[:, None] + tau * dz[:, None]
        good = np.isfinite(tau) & (height >= min(z0, z1)) & (height <= max(z0, z1))
        tau = np.where(good, tau, 0.0)
        return np.where(good & (edge[:, None] + tau * edge_rate[:, None] >= 0.0), tau, np.inf)


def _join(ray: NDArray, start: NDArray, end: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Join consecutive pieces that share an end (a ray that crosses an edge inside the solid's corner)."""
    if not len(ray):
        return ray, start, end
    opens = np.ones(len(ray), dtype=bool)
    opens[1:] = (ray[1:] != ray[:-1]) | (start[1:] != end[:-1])
    closes = np.append(opens[1:], True)
    return ray[opens], start[opens], end[closes]
