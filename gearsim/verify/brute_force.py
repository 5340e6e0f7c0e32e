"""How close a tool on an exact motion comes to points, by values of its signed distance alone.

No envelope condition is used: no velocity meets a normal anywhere. Seen from the tool, a point moves along a
smooth curve Q(t), and the distance F(t) is a function of it that changes by at most |dQ| and, for a convex
tool, is convex. So between samples F cannot fall faster than the tool's fastest point moves, and F + K t²/2
with K >= |Q''| is convex: on [m - h, m + h]
    F >= fm - max(0, fa - fm, fb - fm) - K h²,
from three values of F. Stretches that may still hold a smaller value are halved until none is left.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.motion.sources import MotionSource

_MARGIN = 1.25
_SPACING = 4.0
_NEIGHBOURS = (0.02, 0.006, 0.002)  # mm of the tool's travel: far enough to find the place, near enough to be exact
_CHUNK = 1 << 20
_LIVE = 1 << 18
_LEVELS = 60
_FAR = 1e-6


class Least(NamedTuple):
    """Least signed distance [mm] over a motion, shape (n,): found at t of ``piece``; surely not below ``bound``."""

    distance: NDArray
    bound: NDArray
    piece: NDArray
    t: NDArray


class _Rates(NamedTuple):
    """Bounds on the pose's derivatives by t: |tip'|, |axis'|, |tip''|, |axis''|."""

    travel: NDArray
    spin: NDArray
    bend: NDArray
    swing: NDArray


class _Stretches(NamedTuple):
    """Stretches [centre - half, centre + half] of pieces, each for one point, with the distance at three poses."""

    point: NDArray
    row: NDArray
    centre: NDArray
    half: NDArray
    fa: NDArray
    fm: NDArray
    fb: NDArray


class _Tool(NamedTuple):
    """A tool with a convex section, the farthest of its points from the tip, and the radius of its hole [mm]."""

    profile: Profile
    reach: float
    hole: float


def section(
    source: MotionSource, points: NDArray, piece: NDArray, t: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Points, shape (n, 3), as the tool sees them at poses: r, z [mm], unit radial vectors, axes."""
    pose = source.pose(piece, t, 0)
    tip, axis = pose.tip.value, pose.axis.value
    q = points - tip
    z = np.einsum("ij,ij->i", q, axis)
    w = q - z[:, None] * axis
    r = np.sqrt(np.einsum("ij,ij->i", w, w))
    return r, z, w / np.where(r > 0.0, r, 1.0)[:, None], axis


def distance_at(source: MotionSource, cutter: Profile, points: NDArray, piece: NDArray, t: NDArray) -> NDArray:
    """Signed distance [mm] of points, shape (n, 3), to the tool at poses; negative inside it."""
    r, z, _, _ = section(source, points, piece, t)
    return cutter.signed_distance(r, z)


def gradient_at(source: MotionSource, cutter: Profile, points: NDArray, piece: NDArray, t: NDArray) -> NDArray:
    """Direction in which the distance to the tool grows: out of the tool, shape (n, 3)."""
    r, z, u, axis = section(source, points, piece, t)
    _, nr, nz = cutter.distance_gradient(r, z)
    return nr[:, None] * u + nz[:, None] * axis


def least_distance(source: MotionSource, cutter: Profile, points: NDArray, tolerance: float = 1e-10) -> Least:
    """Least signed distance of points, shape (n, 3), to the tool over its whole motion.

    ``bound`` is ``tolerance`` [mm] below ``distance``, or 1e-6 of it where that is more; lower still where the
    distance stays nearly constant over so long a stretch that the search was given up.
    """
    found = [_part_least(source, _tool(part), points, tolerance) for part in cutter.parts]
    nearest = np.argmin([f.distance for f in found], axis=0)
    pick = [np.choose(nearest, [f[i] for f in found]) for i in range(4)]
    return Least(pick[0], np.min([f.bound for f in found], axis=0), pick[2], pick[3])


def settled_pose(source: MotionSource, cutter: Profile, points: NDArray, least: Least) -> NDArray:
    """The t of the least distance, sharpened by the parabola through neighbouring values where there is one."""
    t = least.t.copy()
    tip, axis = (s.derivatives()[1] for s in source.pose(least.piece, t, 1))
    speed = np.linalg.norm(tip, axis=1) + cutter.reach * np.linalg.norm(axis, axis=1)
    for neighbour in _NEIGHBOURS:
        step = np.minimum(neighbour / np.maximum(speed, 1e-12), 0.5 * np.minimum(t, 1.0 - t))
        f = [distance_at(source, cutter, points, least.piece, t + k * step) for k in (-2.0, -1.0, 0.0, 1.0, 2.0)]
        slope = (8.0 * (f[3] - f[1]) - (f[4] - f[0])) / 12.0
        bend = (16.0 * (f[3] + f[1]) - (f[4] + f[0]) - 30.0 * f[2]) / 12.0
        with np.errstate(invalid="ignore", divide="ignore"):
            shift = -slope / bend
        t += step * np.where((bend > 0.0) & (np.abs(shift) < 1.0), shift, 0.0)
    return t


def _tool(profile: Profile) -> _Tool:
    inward = [e for e in profile.elements if min(e.at(np.linspace(0.0, e.length, 9)).nr) < -1e-12]
    return _Tool(profile, profile.reach, min((e.box[0] for e in inward), default=np.inf))


def _part_least(source: MotionSource, tool: _Tool, points: NDArray, tolerance: float) -> Least:
    piece, centre, half, rates = _stations(source, tool)
    step = max(1, _CHUNK // (2 * len(centre)))
    chunks = [points[i : i + step] for i in range(0, len(points), step)] or [points]
    found = [_search(source, tool, c, piece, centre, half, rates, tolerance) for c in chunks]
    return Least(*(np.concatenate(column) for column in zip(*found, strict=True)))


def _stations(source: MotionSource, tool: _Tool) -> tuple[NDArray, NDArray, NDArray, _Rates]:
    """Stretches on which no tool point moves farther than the spacing: piece, centre, half width, rates."""
    probe = np.linspace(0.0, 1.0, 17)
    rates = _rates(source, np.repeat(np.arange(source.pieces), 17), np.tile(probe, source.pieces))
    speed = (rates.travel + tool.reach * rates.spin).reshape(-1, 17).max(axis=1)
    count = np.maximum(1, np.ceil(_MARGIN * speed / _SPACING).astype(int))
    piece, each = np.repeat(np.arange(source.pieces), count), np.repeat(count, count)
    half = 0.5 / each
    centre = (2 * (np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)) + 1) * half
    around = _rates(source, np.tile(piece, 3), np.concatenate([centre + k * half for k in (-1, 0, 1)]))
    return piece, centre, half, _Rates(*(_MARGIN * c.reshape(3, -1).max(axis=0) for c in around))


def _rates(source: MotionSource, piece: NDArray, t: NDArray) -> _Rates:
    tip, axis = (s.derivatives() for s in source.pose(piece, t, 2))
    return _Rates(*(np.linalg.norm(d, axis=1) for d in (tip[1], axis[1], tip[2], axis[2])))


def _search(
    source: MotionSource, tool: _Tool, points: NDArray, piece: NDArray, centre: NDArray, half: NDArray,
    rates: _Rates, tolerance: float,
) -> Least:  # fmt: skip
    """Branch and bound from common stretches to the least value of every point."""
    n, m = len(points), len(centre)
    point, row = np.repeat(np.arange(n), m), np.tile(np.arange(m), n)
    best = Least(np.full(n, np.inf), np.full(n, np.inf), np.zeros(n, dtype=int), np.zeros(n))

    def value(point: NDArray, row: NDArray, t: NDArray) -> NDArray:
        f = distance_at(source, tool.profile, points[point], piece[row], t)
        np.minimum.at(best.distance, point, f)
        hit = f == best.distance[point]
        best.piece[point[hit]], best.t[point[hit]] = piece[row[hit]], t[hit]
        return f

    def slack() -> NDArray:
        return np.maximum(tolerance, _FAR * np.abs(best.distance))

    three = value(np.tile(point, 3), np.tile(row, 3), np.concatenate([(centre + k * half)[row] for k in (-1, 0, 1)]))
    live = _Stretches(point, row, centre[row], half[row], *three.reshape(3, -1))
    for _ in range(_LEVELS):
        bound = _bound(live, rates, tool)
        keep = bound < (best.distance - slack())[live.point]
        live, bound = _Stretches(*(c[keep] for c in live)), bound[keep]
        if len(live.point) > _LIVE or not len(live.point):
            break
        live = _halved(live, value)
    else:
        bound = _bound(live, rates, tool)
    best.bound[:] = best.distance - slack()
    np.minimum.at(best.bound, live.point, bound)
    return best


def _halved(live: _Stretches, value: Callable[[NDArray, NDArray, NDArray], NDArray]) -> _Stretches:
    quarter = 0.5 * live.half
    point, row = np.tile(live.point, 2), np.tile(live.row, 2)
    centre = np.concatenate([live.centre - quarter, live.centre + quarter])
    middle = value(point, row, centre)
    start, end = np.concatenate([live.fa, live.fm]), np.concatenate([live.fm, live.fb])
    return _Stretches(point, row, centre, np.tile(quarter, 2), start, middle, end)


def _bound(live: _Stretches, rates: _Rates, tool: _Tool) -> NDArray:
    """Lower bound of the distance on stretches, from values and bounds on the motion alone."""
    travel, spin, bend, swing = (c[live.row] for c in rates)
    fa, fm, fb, half = live.fa, live.fm, live.fb, live.half
    fastest = travel + tool.reach * spin
    lowest = np.minimum(np.minimum(fa, fm), fb)
    straight = 0.5 * (fm + np.minimum(fa, fb) - fastest * half)
    farthest = np.maximum(np.maximum(np.maximum(fa, fm), fb) + fastest * half, 0.0)
    lever = tool.reach + farthest
    curvature = bend + 2.0 * spin * travel + lever * (swing + spin**2)
    if np.isfinite(tool.hole):  # seen from a hole's wall, distance bends down by 1/r
        with np.errstate(divide="ignore"):
            curvature = curvature + (travel + lever * spin) ** 2 / np.maximum(tool.hole - farthest, 0.0)
    bent = fm - np.maximum(np.maximum(fa, fb) - fm, 0.0) - curvature * half**2
    return np.minimum(lowest, np.maximum(straight, bent))
