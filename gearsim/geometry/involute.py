"""The involute function and its inverse, without loss of digits near the base circle."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

SERIES_BELOW = 0.15
NEWTON_STEPS = 8


def inv(angle: ArrayLike) -> NDArray:
    """tan(a) - a of pressure angles a [rad], any shape (ISO 21771)."""
    return roll_inv(np.tan(np.asarray(angle, dtype=float)))


def inverse_inv(value: ArrayLike) -> NDArray:
    """The pressure angle [rad] within -90 and 90 degrees whose involute function has the value, any shape."""
    return np.arctan(inverse_roll_inv(value))


def roll_inv(roll: ArrayLike) -> NDArray:
    """xi - atan(xi) of roll angles xi = tan(a) [rad], any shape: the polar angle an involute has turned through.

    The difference loses digits as 3 eps / xi²; below 0.15 its series xi³/3 - xi⁵/5 + ... takes over.
    """
    xi = np.asarray(roll, dtype=float)
    small = np.where(np.abs(xi) < SERIES_BELOW, xi, 0.0)
    square, total = small * small, np.zeros(xi.shape)
    for k in range(11, 0, -1):
        total = 1.0 / (2 * k + 1) - square * total
    return np.where(np.abs(xi) < SERIES_BELOW, small * square * total, xi - np.arctan(xi))


def inverse_roll_inv(value: ArrayLike) -> NDArray:
    """The roll angle xi [rad] with xi - atan(xi) = value, any shape.

    Newton on a function convex for xi > 0, begun at (3v)^(1/3) + 3v/5 or at v + 90 deg, the ends' asymptotes.
    """
    v = np.asarray(value, dtype=float)
    size = np.abs(v)
    xi = np.where(size < 1.5, np.cbrt(3.0 * size) + 0.6 * size, size + 0.5 * np.pi)
    safe = np.where(size > 0.0, xi, 1.0)
    for _ in range(NEWTON_STEPS):
        safe = safe - (roll_inv(safe) - size) * (1.0 + 1.0 / safe**2)
    return np.copysign(np.where(size > 0.0, safe, 0.0), v)
