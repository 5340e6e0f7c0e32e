"""Circular moves: centre and sweep of G2 and G3 from I J K or R."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.programs.gcode.arc_rules import ArcRules

PLANES = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}
OFFSET_LETTERS = {17: "IJ", 18: "KI", 19: "JK"}
_HALF_CIRCLE = 1e-12  # a chord nearer to the diameter is the diameter: the root would make 1e-6 of 1e-12


class Arcs(NamedTuple):
    """Arcs about ``centre`` (n, 3) [mm] by ``sweep`` (n,) [rad], right-handed about the plane's normal.

    ``miss`` (n,): how far the end lies off the circle through the start, or how far R is short of half the chord
    [mm]; nan where there is no circle at all. ``runs`` (n,): whether the control runs the arc.
    """

    centre: NDArray[np.floating]
    sweep: NDArray[np.floating]
    miss: NDArray[np.floating]
    runs: NDArray[np.bool_]


def arcs(
    start: NDArray, end: NDArray, words: NDArray, clockwise: NDArray, plane: int, scale: float, absolute: bool,
    rules: ArcRules,
) -> Arcs:  # fmt: skip
    """Arcs from ``start`` to ``end`` (n, 3) with I J K R in ``words`` (n, 5) [mm], nan where absent, and P turns.

    The end that equals the start in the plane makes a full circle. R > 0 is the arc up to half a circle, R < 0
    the longer one; ``absolute``: I J K are the centre, not its distance from the start. A unit has ``scale`` [mm].
    """
    a, b, _ = PLANES[plane]
    flat_start, flat_end = start[:, [a, b]], end[:, [a, b]]
    by_radius = ~np.isnan(words[:, 3])
    given = words[:, [a, b]]
    offset = given - flat_start if absolute else np.where(np.isnan(given), 0.0, given)
    from_radius, short = _from_radius(flat_start, flat_end, words[:, 3], clockwise)
    offset[by_radius] = from_radius[by_radius]
    arm, last = -offset, flat_end - flat_start - offset
    radius, other = np.hypot(*arm.T), np.hypot(*last.T)
    turn = np.arctan2(arm[:, 0] * last[:, 1] - arm[:, 1] * last[:, 0], (arm * last).sum(axis=1))
    with np.errstate(divide="ignore", invalid="ignore"):
        same = np.maximum(rules.same_angle, rules.same_distance / radius)
    forward = np.where(clockwise, -turn, turn)
    is_full = np.abs(turn) <= same
    forward = np.where((forward <= 0.0) | is_full, forward + 2.0 * np.pi, forward) + 2.0 * np.pi * (words[:, 4] - 1.0)
    centre = start.copy()
    centre[:, [a, b]] += offset
    miss = np.where(by_radius, short, np.abs(other - radius))
    least = rules.smallest(scale) * scale
    exists = np.where(
        by_radius, np.isfinite(turn) & ~is_full & (words[:, 3] != 0.0), np.minimum(radius, other) >= least
    )
    allowed = np.where(
        by_radius, short <= rules.radius(scale) * scale, _is_near(miss, np.maximum(radius, other), scale, rules)
    )
    miss = np.where(exists, miss, np.nan)
    return Arcs(centre, np.where(clockwise, -forward, forward), miss, exists & allowed)


def _is_near(miss: NDArray, radius: NDArray, scale: float, rules: ArcRules) -> NDArray[np.bool_]:
    """Whether a control takes ends whose radii differ by ``miss`` [mm] for ends of one arc."""
    least = rules.centre(scale) * scale
    return (miss <= least) | ((miss <= rules.share * radius) & (miss <= rules.largest * least))


def _from_radius(start: NDArray, end: NDArray, radius: NDArray, clockwise: NDArray) -> tuple[NDArray, NDArray]:
    """The centre seen from the start, nan where the end is the start; how far the radius is short of half the chord.

    A radius that is too short gives half a circle about the chord's middle.
    """
    chord, size = end - start, np.abs(radius)
    half = np.hypot(*(0.5 * (end + start) - end).T)
    with np.errstate(invalid="ignore", divide="ignore"):
        is_half = half > (1.0 - _HALF_CIRCLE) * size
        height = np.sqrt(np.where(is_half, 0.0, (size - half) * (size + half)))
        side = np.where(clockwise ^ (radius < 0.0), -1.0, 1.0)
        left = np.stack([-chord[:, 1], chord[:, 0]], axis=-1) / (2.0 * half)[:, None]
    return 0.5 * chord + (side * height)[:, None] * left, half - size
