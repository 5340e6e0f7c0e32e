"""Solid bodies that stock is made of: what any of them can be asked, and the block."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError


class Solid(Protocol):
    """A closed body in the part's frame; points on its surface count as inside on one side and outside on the other."""

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        """Lower and upper corner [mm], shape (3,), of the smallest box along the axes around it."""
        ...

    @property
    def volume(self) -> float:
        """Its volume [mm³]."""
        ...

    def contains(self, points: NDArray) -> NDArray:
        """Whether points [mm], shape (..., 3), lie inside."""
        ...

    def signed_distance(self, points: NDArray) -> NDArray:
        """Distance [mm] of points, shape (..., 3), from its surface, negative inside."""
        ...

    def normals(self, points: NDArray) -> NDArray:
        """Outward unit normals, shape (n, 3), of the faces that points [mm], shape (n, 3), are nearest to."""
        ...

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """Where rays, both shape (n, 3), run inside: ray indices in rising order, starts and ends [mm], rising per ray.

        Directions are of unit length.
        """
        ...


def box_corners(solid: Solid) -> NDArray[np.floating]:
    """The corners [mm], shape (8, 3), of a solid's own box."""
    box = np.array(solid.box, dtype=float)
    return np.stack(np.meshgrid(*box.T, indexing="ij"), axis=-1).reshape(-1, 3)


@dataclass(frozen=True)
class Block:
    """A box along the axes from ``lower`` to ``upper`` [mm], shape (3,). Raises InputError where it has no inside."""

    lower: NDArray[np.floating]
    upper: NDArray[np.floating]

    def __post_init__(self) -> None:
        if not np.all(self.upper > self.lower):
            raise InputError(f"block from {self.lower} to {self.upper} mm: every upper coordinate must be the larger")

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        return self.lower, self.upper

    @property
    def volume(self) -> float:
        return float(np.prod(self.upper - self.lower))

    def contains(self, points: NDArray) -> NDArray:
        return np.all((points >= self.lower) & (points < self.upper), axis=-1)

    def signed_distance(self, points: NDArray) -> NDArray:
        out = np.maximum(self.lower - points, points - self.upper)
        return np.linalg.norm(np.maximum(out, 0.0), axis=-1) + np.minimum(out.max(axis=-1), 0.0)

    def normals(self, points: NDArray) -> NDArray:
        face = np.argmin(np.abs(np.column_stack([points - self.lower, points - self.upper])), axis=1)
        return np.concatenate([-np.eye(3), np.eye(3)])[face]

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        beside = directions == 0.0
        per = 1.0 / np.where(beside, 1.0, directions)
        ends = np.sort([(self.lower - origins) * per, (self.upper - origins) * per], axis=0)
        within = (origins >= self.lower) & (origins < self.upper)
        start = np.where(beside, np.where(within, -np.inf, np.inf), ends[0]).max(axis=1)
        end = np.where(beside, np.inf, ends[1]).min(axis=1)
        ray = np.flatnonzero(end > start)
        return ray, start[ray], end[ray]


@dataclass(frozen=True)
class Shifted:
    """A solid moved by a vector [mm], shape (3,)."""

    solid: Solid
    by: NDArray[np.floating]

    @property
    def box(self) -> tuple[NDArray, NDArray]:
        lower, upper = self.solid.box
        return lower + self.by, upper + self.by

    @property
    def volume(self) -> float:
        return self.solid.volume

    def contains(self, points: NDArray) -> NDArray:
        return self.solid.contains(points - self.by)

    def signed_distance(self, points: NDArray) -> NDArray:
        return self.solid.signed_distance(points - self.by)

    def normals(self, points: NDArray) -> NDArray:
        return self.solid.normals(points - self.by)

    def chords(self, origins: NDArray, directions: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        return self.solid.chords(origins - self.by, directions)
