"""Circular moves: centre and sweep of G2 and G3 from I J K or R."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
OFFSET_LETTERS = {17: "IJ", 18: "KI", 19: "JK"}


class Arcs(NamedTuple):
    """Arcs about ``centre`` (n, 3) [mm] by ``sweep`` (n,) [rad], right-handed about the plane's normal.

    ``miss`` (n,): how far the end lies off the circle [mm]; nan where there is no circle at all.
    """

    centre: NDArray[np.floating]
    sweep: NDArray[np.floating]
    miss: NDArray[np.floating]


def arcs(
    start: NDArray, end: NDArray, words: NDArray, clockwise: NDArray, plane: int, tolerance: float, absolute: bool
) -> Arcs:
    """Arcs from ``start`` to ``end`` (n, 3) with I J K R in ``words`` (n, 4) [mm], nan where absent.

    The end that equals the start in the plane makes a full circle. R > 0 is the arc up to half a circle, R < 0
    the longer one; ``absolute``: I J K are the centre, not its distance from the start.
    """
    a, b, _ = PLANES[plane]
    flat_start, flat_end = start[:, [a, b]], end[:, [a, b]]
    by_radius = ~np.isnan(words[:, 3])
    given = words[:, [a, b]]
    offset = np.where(np.isnan(given), flat_start if absolute else 0.0, given) - (flat_start if absolute else 0.0)
    offset[by_radius] = _from_radius(flat_end - flat_start, words[:, 3], clockwise, tolerance)[by_radius]
    arm, last = -offset, flat_end - flat_start - offset
    turn = np.arctan2(arm[:, 0] * last[:, 1] - arm[:, 1] * last[:, 0], (arm * last).sum(axis=1))
    turn = np.where(turn > 0.0, turn, turn + 2.0 * np.pi)
    sweep = np.where(clockwise, np.where(turn < 2.0 * np.pi, turn, 0.0) - 2.0 * np.pi, turn)
    centre = start.copy()
    centre[:, [a, b]] += offset
    radius = np.hypot(*arm.T)
    miss = np.abs(np.hypot(*last.T) - radius)
    return Arcs(centre, sweep, np.where(radius > 0.0, miss, np.nan))


def _from_radius(chord: NDArray, radius: NDArray, clockwise: NDArray, tolerance: float) -> NDArray:
    """The centre seen from the start; nan where the circle does not reach the end, or the end is the start."""
    half = 0.5 * np.hypot(*chord.T)
    with np.errstate(invalid="ignore", divide="ignore"):
        short = half - np.abs(radius)
        height = np.sqrt(np.where((short > 0.0) & (short <= tolerance), 0.0, radius**2 - half**2))
        side = np.where(clockwise ^ (radius < 0.0), -1.0, 1.0)
        left = np.stack([-chord[:, 1], chord[:, 0]], axis=-1) / (2.0 * half)[:, None]
    return 0.5 * chord + (side * height)[:, None] * left
