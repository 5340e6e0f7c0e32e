"""Solids for tests whose rays and normals are known in closed form."""

from __future__ import annotations

import numpy as np


class Ball:
    def __init__(self, centre, radius):
        self.centre, self.radius = np.array(centre, dtype=float), radius

    @property
    def volume(self):
        return 4.0 / 3.0 * np.pi * self.radius**3

    def chords(self, origins, directions):
        to = self.centre - origins
        along = np.einsum("ij,ij->i", to, directions)
        half = self.radius**2 - ((to - along[:, None] * directions) ** 2).sum(axis=1)
        ray = np.flatnonzero(half > 0.0)
        half = np.sqrt(half[ray])
        return ray, along[ray] - half, along[ray] + half

    def normals(self, points):
        return (points - self.centre) / np.linalg.norm(points - self.centre, axis=1)[:, None]


class Faceted:
    """What lies below planes: normal . p <= height."""

    def __init__(self, normals, heights):
        self.planes, self.heights = np.array(normals, dtype=float), np.array(heights, dtype=float)
        self.planes /= np.linalg.norm(self.planes, axis=1, keepdims=True)

    def over(self, points):
        return points @ self.planes.T - self.heights

    def chords(self, origins, directions):
        rate, room = directions @ self.planes.T, -self.over(origins)
        with np.errstate(divide="ignore", invalid="ignore"):
            tau = room / rate
        start, end = np.where(rate < 0.0, tau, -np.inf).max(axis=1), np.where(rate > 0.0, tau, np.inf).min(axis=1)
        ray = np.flatnonzero((end > start) & ~((rate == 0.0) & (room < 0.0)).any(axis=1))
        return ray, start[ray], end[ray]

    def normals(self, points):
        return self.planes[np.abs(self.over(points)).argmin(axis=1)]
