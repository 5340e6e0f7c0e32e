"""How close points come to a cutter over a motion, from samples, in NumPy: the twin of kernels/approach.py."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import NumericalError
from gearsim.motion.sources import MotionSource

_CHUNK = 1 << 19
_LEVELS = 100
_MOST = 20_000_000
_TOLERANCE = 1e-11
_CURVATURE_MARGIN = 1.3


class _Stretches(NamedTuple):
    """Stretches [a, b] of a piece, each for one point: distance and rate at both ends, curvature bound."""

    point: NDArray
    piece: NDArray
    a: NDArray
    b: NDArray
    fa: NDArray
    fb: NDArray
    ra: NDArray
    rb: NDArray
    curvature: NDArray


def distance_rate(
    cutter: Profile, points: NDArray, tip: NDArray, axis: NDArray, tip_rate: NDArray, axis_rate: NDArray
) -> tuple[NDArray, NDArray]:
    """Signed distance [mm] of points to the cutter at poses, and its derivative by the motion's parameter.

    All vectors broadcast to shape (..., 3).
    """
    q = points - tip
    z = _dot(q, axis)
    w = q - z[..., None] * axis
    r = np.sqrt(_dot(w, w))
    distance, nr, nz = cutter.distance_gradient(r, z)
    sideways = _dot(w, axis_rate)
    with np.errstate(invalid="ignore", divide="ignore"):
        r_rate = np.where(r > 0.0, -(_dot(w, tip_rate) + z * sideways) / r, 0.0)
    return distance, nr * r_rate + nz * (sideways - _dot(tip_rate, axis))


def path_distance(
    source: MotionSource, cutter: Profile, points: NDArray, spacing: float = 0.25, floor: float = np.inf
) -> NDArray:  # fmt: skip
    """Least signed distance [mm] over the whole motion, shape (n,), of points, shape (n, 3), to 1e-11 mm.

    Above ``floor`` [mm] it is only that: what slides past a tool's end at some distance takes long to tell exactly.

    Inside a tool with undercuts it is the depth below a part's surface, which can be less than the tool's;
    beyond half the radius of a ring's hole from the ring it is to about 1e-3 mm. Starts from samples between
    which no tool point moves more than about ``spacing`` [mm].
    """
    return np.min([_part_distance(source, part, points, spacing, floor) for part in cutter.parts], axis=0)


def _part_distance(
    source: MotionSource, cutter: Profile, points: NDArray, spacing: float, floor: float
) -> NDArray:  # fmt: skip
    """The same for a convex cutter or a ring."""
    piece, t, curvature = _samples(source, cutter, spacing)
    tip, axis = (s.derivatives() for s in source.pose(piece, t, 1))
    inner = np.flatnonzero(piece[1:] == piece[:-1])
    width = t[inner + 1] - t[inner]
    least = np.empty(len(points))
    step = max(1, _CHUNK // len(t))
    for begin in range(0, len(points), step):
        chunk = points[begin : begin + step]
        f, rate = _sampled(cutter, chunk, tip, axis, spacing)
        lowest = f.min(axis=1)
        with np.errstate(invalid="ignore"):
            bound = _bound(width, f[:, inner], f[:, inner + 1], rate[:, inner], rate[:, inner + 1], curvature[inner])
        known = np.isfinite(f[:, inner]) & np.isfinite(f[:, inner + 1])
        point, k = np.nonzero(known & (bound < np.minimum(lowest - _TOLERANCE, floor)[:, None]))
        i = inner[k]
        stretches = _Stretches(
            point, piece[i], t[i], t[i + 1], f[point, i], f[point, i + 1], rate[point, i], rate[point, i + 1],
            curvature[i],
        )  # fmt: skip
        least[begin : begin + step] = _refine(source, cutter, chunk, lowest, stretches, floor)
    return least


def _sampled(
    cutter: Profile, points: NDArray, tip: tuple[NDArray, ...], axis: tuple[NDArray, ...], spacing: float
) -> tuple[NDArray, NDArray]:
    """Distance and rate, shape (points, samples), where a sample may matter; inf and 0 where it cannot.

    A sample farther than the least known distance by more than ``spacing`` cannot hide less beside it.
    """
    f, rate = np.full((len(points), len(tip[0])), np.inf), np.zeros((len(points), len(tip[0])))
    coarse = slice(None, None, 8)
    f[:, coarse], rate[:, coarse] = distance_rate(
        cutter, points[:, None], tip[0][coarse], axis[0][coarse], tip[1][coarse], axis[1][coarse]
    )
    known = f.min(axis=1)
    far = _cone_distance(cutter, points, tip[0], axis[0]) > known[:, None] + spacing
    i, k = np.nonzero(~far & ~np.isfinite(f))
    f[i, k], rate[i, k] = distance_rate(cutter, points[i], tip[0][k], axis[0][k], tip[1][k], axis[1][k])
    return f, rate


def _cone_distance(cutter: Profile, points: NDArray, tip: NDArray, axis: NDArray) -> NDArray:
    """Lower bound of the distance of points to the cutter at poses: to a cone around it, its ends, its hole."""
    corners = np.array([(e.box[1], z) for e in cutter.elements for z in e.box[2:]])
    _, _, bottom, top = cutter.box
    slope = (corners[-1, 0] - corners[0, 0]) / (top - bottom)
    base = float((corners[:, 0] - slope * corners[:, 1]).max())
    z = points @ axis.T - (tip * axis).sum(1)
    q2 = (points**2).sum(1)[:, None] - 2.0 * points @ tip.T + (tip**2).sum(1)
    r = np.sqrt(np.maximum(q2 - z * z, 0.0)) - 1e-6
    ends = np.maximum(bottom - z, z - top)
    hull = np.maximum((r - base - slope * z) / np.hypot(1.0, slope), ends)
    return np.maximum(hull, cutter.min_radius - r - 2e-6) if cutter.is_ring else hull


def _samples(source: MotionSource, cutter: Profile, spacing: float) -> tuple[NDArray, NDArray, NDArray]:
    """Pieces, parameters and curvature bounds of the samples; both ends of every piece are among them."""
    piece = np.repeat(np.arange(source.pieces), 9)
    tip, axis = source.pose(piece, np.tile(np.linspace(0.0, 1.0, 9), source.pieces), 2)
    (travel, bending), (spin, swing) = ([np.linalg.norm(d, axis=1) for d in s.derivatives()[1:]] for s in (tip, axis))
    reach = cutter.reach
    speed = (travel + reach * spin).reshape(-1, 9).max(axis=1)
    curvature = (bending + reach * swing + spin * (2.0 * travel + spin * reach)).reshape(-1, 9).max(axis=1)
    bound = _CURVATURE_MARGIN * curvature
    if cutter.is_ring:
        bound += 2.0 * (_CURVATURE_MARGIN * speed) ** 2 / cutter.min_radius
    count = np.maximum(1, np.ceil(speed / spacing).astype(int)) + 1
    index = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    return (
        np.repeat(np.arange(source.pieces), count),
        index / np.repeat(count - 1, count),
        np.repeat(bound, count),
    )


def _bound(width: NDArray, fa: NDArray, fb: NDArray, ra: NDArray, rb: NDArray, curvature: NDArray) -> NDArray:
    """Lower bound of the distance on stretches: where the two parabolas from the ends cross."""
    half = 0.5 * curvature * width
    with np.errstate(invalid="ignore", divide="ignore"):
        s = (fb - fa - (rb + half) * width) / (ra - rb - 2.0 * half)
    s = np.clip(np.nan_to_num(s, nan=0.0), 0.0, width)
    return np.minimum(np.minimum(fa, fb), fa + ra * s - 0.5 * curvature * s * s)


def _refine(
    source: MotionSource, cutter: Profile, points: NDArray, least: NDArray, live: _Stretches, floor: float
) -> NDArray:  # fmt: skip
    """Least distance per point after splitting every stretch that may hold less.

    Raises NumericalError where there are too many: the tool slides along points.
    """
    for level in range(_LEVELS):
        if not len(live.point):
            break
        if len(live.point) > _MOST:
            count = len(np.unique(live.point))
            raise NumericalError(
                f"the envelope road cannot tell how near {count} points come to the tool: they lie in a surface along "
                "which it slides for a while (the plane of its end?); move the samples a little"
            )
        x = 0.5 * (live.a + live.b) if level % 2 else _secant(live)
        tip, axis = (s.derivatives() for s in source.pose(live.piece, x, 1))
        f, rate = distance_rate(cutter, points[live.point], tip[0], axis[0], tip[1], axis[1])
        np.minimum.at(least, live.point, f)
        halves = [live._replace(b=x, fb=f, rb=rate), live._replace(a=x, fa=f, ra=rate)]
        live = _Stretches(*(np.concatenate(columns) for columns in zip(*halves, strict=True)))
        bound = _bound(live.b - live.a, live.fa, live.fb, live.ra, live.rb, live.curvature)
        keep = bound < np.minimum(least[live.point] - _TOLERANCE, floor)
        live = _Stretches(*(column[keep] for column in live))
    return least


def _secant(live: _Stretches) -> NDArray:
    """Near the minimum that the rates point to if they straddle zero, else the middle of each stretch."""
    width = live.b - live.a
    with np.errstate(invalid="ignore", divide="ignore"):
        secant = (live.a * live.rb - live.b * live.ra) / (live.rb - live.ra)
    straddle = (live.ra < 0.0) & (live.rb > 0.0)
    near = np.clip(secant, live.a + 0.1 * width, live.b - 0.1 * width)
    return np.where(straddle, near, 0.5 * (live.a + live.b))


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
