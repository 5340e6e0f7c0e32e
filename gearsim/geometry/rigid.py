"""Rigid motions of the workpiece frame, proper or mirrored."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class Rigid:
    """x -> rotation @ x + translation. ``rotation`` (3, 3) is orthogonal, ``translation`` (3,) in mm."""

    rotation: NDArray[np.floating]
    translation: NDArray[np.floating]

    def point(self, points: NDArray) -> NDArray:
        """Move points, shape (..., 3) [mm]."""
        return points @ self.rotation.T + self.translation

    def direction(self, directions: NDArray) -> NDArray:
        """Turn directions, shape (..., 3)."""
        return directions @ self.rotation.T

    def inverse(self) -> Rigid:
        """The motion that undoes this one."""
        return Rigid(self.rotation.T, -self.rotation.T @ self.translation)


def frame(origin: NDArray, x: NDArray, z: NDArray) -> Rigid:
    """The motion from a local frame (origin, x, y = z cross x, z; unit, orthogonal) to the workpiece."""
    return Rigid(np.column_stack([x, np.cross(z, x), z]), np.asarray(origin, dtype=float))
