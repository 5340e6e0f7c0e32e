"""Where a face is looked at: lines of its parameters close enough by arc length and by the turn of the normal.

Knots part the lines: between two of them at least a few, so that no span is stepped over, and at those over which
curvature or normal may jump both sides are looked at.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.face import Face
from gearsim.surfaces.nurbs import NurbsSurface

TURN = np.radians(4.0)
"""Largest turn [rad] of the normal from line to line."""
_SPAN = 5
"""Fewest lines between two knots."""
_CROSS = 25
"""Most lines across, along which spacing and turn are measured."""
_ROUNDS = 45
_PLANE = 40
"""Lines across a plane."""
_MOST = 4
"""Most lines for each of the grid asked for."""
_CREASE = 1e-7
"""Part of the surface's size within which a turn that stays is a crease."""
_BEND = 1e-4
"""Turn [rad] of the normal that counts as a crease."""


@dataclass(frozen=True)
class Lines:
    """Lines in u and in v: ``at`` (n,) off the breaks, ``breaks`` (m, 2) just before and behind each, borders too.

    ``ranges``: what is looked at of u and of v.

    ``spacing`` [mm] and ``turn`` [rad]: the largest from line to line.
    """

    at: tuple[NDArray, NDArray]
    breaks: tuple[NDArray, NDArray]
    ranges: tuple[tuple[float, float], tuple[float, float]]
    spacing: float
    turn: float


def face_lines(face: Face, step: float, grid: int, margin: float = 0.0) -> Lines:
    """Lines not farther apart than ``step`` [mm], at most 4 ``grid`` of them in each direction; a plane needs few.

    ``margin``: the share of the domain left out at every border.
    """
    if is_plane(face.surface):
        step = max(step, face.surface.size / _PLANE)
    found = [_along(face, axis, step, grid, margin) for axis in (0, 1)]
    return Lines(
        (found[0][0], found[1][0]),
        (found[0][1], found[1][1]),
        _ranges(face, margin),
        max(f[2] for f in found),
        max(f[3] for f in found),
    )


def _ranges(face: Face, margin: float) -> tuple[tuple[float, float], tuple[float, float]]:
    ends = [_knots(face, axis, margin)[[0, -1]].tolist() for axis in (0, 1)]
    return (ends[0][0], ends[0][1]), (ends[1][0], ends[1][1])


def is_plane(surface: NurbsSurface) -> bool:
    """Whether all control points lie in one plane, to rounding."""
    sizes = np.linalg.svd(surface.points.reshape(-1, 3) - surface.points.mean(axis=(0, 1)), compute_uv=False)
    return bool(sizes[2] <= 1e-13 * max(sizes[0], np.abs(surface.points).max()))


def longest_line(face: Face) -> float:
    """Length [mm] of the face's longest line of parameters."""
    longest = 0.0
    for axis in (0, 1):
        t = _spread(_knots(face, axis, 0.0), 4 * _SPAN)
        points, _ = _cross_jets(face, axis, t, _cross_lines(face, axis, 0.0))
        longest = max(longest, float(np.linalg.norm(np.diff(points, axis=0), axis=2).sum(axis=0).max()))
    return longest


def _along(face: Face, axis: int, step: float, grid: int, margin: float) -> tuple[NDArray, NDArray, float, float]:
    knots, jumps = _knots(face, axis, margin), _jumps(face.surface, axis)
    inner = jumps[(jumps > knots[0]) & (jumps < knots[-1])]
    t = np.union1d(_spread(knots, _SPAN), np.nextafter(inner, -np.inf))
    across, size = _cross_lines(face, axis, margin), face.surface.size
    points, normals = _cross_jets(face, axis, t, across)
    most = max(_MOST * grid, 2 * len(t))
    for _ in range(_ROUNDS):
        length, turn, hidden = _gaps(points, normals, size)
        parts = np.ceil(np.maximum(length / step, np.where(hidden, 0.0, turn / TURN)) - 1e-6)
        parts = np.where(np.diff(t) > 1e-13 * (t[-1] - t[0]), np.clip(parts, 1, most), 1).astype(int)
        parts[np.cumsum(parts) > most] = 1
        if parts.max() == 1:
            break
        steps = [np.arange(1, n) / n for n in parts]
        new = np.concatenate([a + s * (b - a) for a, b, s in zip(t[:-1], t[1:], steps, strict=True)])
        at = np.searchsorted(t, new)
        new_points, new_normals = _cross_jets(face, axis, new, across)
        t, points, normals = (
            np.insert(t, at, new),
            np.insert(points, at, new_points, 0),
            np.insert(normals, at, new_normals, 0),
        )
    length, turn, hidden = _gaps(points, normals, size)
    breaks = _breaks(face.surface, axis, jumps, [(t[k], t[k + 1]) for k in np.flatnonzero(hidden)])
    on = np.any((t[:, None] >= breaks[None, :, 0]) & (t[:, None] <= breaks[None, :, 1]), axis=1)
    return t[~on], breaks, float(length.max()), float(turn[~hidden].max(initial=0.0))


def _jumps(surface: NurbsSurface, axis: int) -> NDArray:
    """Knots inside the domain where fewer than two derivatives go on smoothly."""
    basis = surface.along[axis]
    low, high = basis.domain
    values, times = np.unique(basis.knots, return_counts=True)
    return values[(values > low) & (values < high) & (times >= basis.degree - 1)]


def _breaks(surface: NurbsSurface, axis: int, jumps: NDArray, creases: list[tuple[float, float]]) -> NDArray:
    """Borders, jumps, and creases made by control points that meet: just before and just behind each, (m, 2)."""
    low, high = surface.domain[axis]
    rows = [(low, low), *((np.nextafter(x, -np.inf), x) for x in jumps), (high, high)]
    rows += [c for c in creases if not np.any((jumps >= c[0]) & (jumps <= c[1]))]
    return np.array(sorted(rows))


def _knots(face: Face, axis: int, margin: float) -> NDArray:
    """Ends of the range that is looked at, and the knots inside it."""
    low, high = face.surface.domain[axis]
    if face.loops:
        mine = face.outline[0][:, axis]
        first, last = max(low, float(mine.min())), min(high, float(mine.max()))
    else:
        first, last = low, high
    first, last = first + margin * (last - first), last - margin * (last - first)
    knots = np.unique(face.surface.along[axis].knots)
    return np.array([first, *knots[(knots > first) & (knots < last)], last])


def _spread(knots: NDArray, count: int) -> NDArray:
    """Each span between two knots in ``count`` + 1 equal steps, with its ends."""
    share = np.linspace(0.0, 1.0, count + 2)[:-1]
    return np.append((knots[:-1, None] + np.diff(knots)[:, None] * share).ravel(), knots[-1])


def _cross_lines(face: Face, axis: int, margin: float) -> NDArray:
    t = _spread(_knots(face, 1 - axis, margin), 3)
    return t[np.unique(np.linspace(0, len(t) - 1, min(len(t), _CROSS)).astype(int))]


def _cross_jets(face: Face, axis: int, t: NDArray, across: NDArray) -> tuple[NDArray, NDArray]:
    """Points and normals where lines t cross others, shape (n, m, 3)."""
    a, b = (x.ravel() for x in np.meshgrid(t, across, indexing="ij"))
    jet = face.surface.jet(*((a, b) if axis == 0 else (b, a)))
    shape = (len(t), len(across), 3)
    return jet.r.reshape(shape), jet.normal.reshape(shape)


def _gaps(points: NDArray, normals: NDArray, size: float) -> tuple[NDArray, NDArray, NDArray]:
    """From each line to the next: the largest distance [mm], turn of the normal [rad], and whether it is a crease."""
    length = np.linalg.norm(np.diff(points, axis=0), axis=2).max(axis=1)
    chord = np.linalg.norm(np.diff(normals, axis=0), axis=2)
    turn = (2.0 * np.arcsin(np.clip(0.5 * np.nan_to_num(chord), 0.0, 1.0))).max(axis=1)
    return length, turn, (turn > _BEND) & (length <= _CREASE * size)
