"""The rows of a table halved again and again, for the kernels to turn away whole branches of them."""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.kernels.branches import Branches
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.tools import padded

_LEVELS = 8


@dataclass(frozen=True)
class Level:
    """The branches of one level, as of kernels/branches.py."""

    tip: NDArray[np.floating]
    axis: NDArray[np.floating]
    stroke: NDArray[np.floating]
    swing: NDArray[np.floating]
    rest: NDArray[np.floating]
    sway: NDArray[np.floating]
    turn: NDArray[np.floating]


def rows_alone(table: SegmentTable) -> Level:
    """Every row as a branch, at its middle pose."""
    tip, axis = (np.sqrt(np.einsum("nkc,nkc->nk", c, c)) for c in (table.tip, table.axis))
    rest, sway, turn = (np.einsum("nk->n", c) for c in (tip[:, 2:], axis[:, 2:], axis[:, 1:]))
    return Level(table.tip[:, 0], table.axis[:, 0], table.tip[:, 1], table.axis[:, 1], rest, sway, turn)


def halved(table: SegmentTable, reach: float) -> list[Level]:
    """Levels of branches, from rows alone upward; ``reach`` [mm] is what a turn of the axis counts beside travel."""
    sign = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    begins = [np.einsum("k,nkc->nc", sign, c) for c in (table.tip, table.axis)]
    ends = [np.einsum("nkc->nc", c) for c in (table.tip, table.axis)]
    made = [rows_alone(table)]
    for level in range(1, _LEVELS):
        begin = np.arange(-(-len(table) // (1 << level))) << level
        end = np.minimum(begin + (1 << level), len(table))
        middle = (begin + end) // 2
        tip, axis = (c[middle] for c in begins)
        stroke, swing = (0.5 * (last[end - 1] - first[begin]) for first, last in zip(begins, ends, strict=True))
        made.append(_united(made[-1], tip, axis, stroke, swing, reach))
    return made


def _united(below: Level, tip: NDArray, axis: NDArray, stroke: NDArray, swing: NDArray, reach: float) -> Level:
    """The branches of two of ``below`` each, of the last perhaps one, with given poses, strokes and swings."""
    rest, sway, turn = np.zeros((3, len(tip)))
    square = np.maximum(_dot(stroke, stroke) + reach**2 * _dot(swing, swing), 1e-300)
    first = 2 * np.arange(len(tip))
    for child in (first, np.minimum(first + 1, len(below.rest) - 1)):
        for sign in (-1.0, 1.0):
            tip_off = below.tip[child] + sign * below.stroke[child] - tip
            axis_off = below.axis[child] + sign * below.swing[child] - axis
            s = np.clip((_dot(tip_off, stroke) + reach**2 * _dot(axis_off, swing)) / square, -1.0, 1.0)[:, None]
            rest = np.maximum(rest, _length(tip_off - s * stroke) + below.rest[child])
            sway = np.maximum(sway, _length(axis_off - s * swing) + below.sway[child])
            turn = np.maximum(turn, _length(axis_off) + below.sway[child])
    return Level(tip, axis, stroke, swing, rest, sway, turn)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("nc,nc->n", a, b)


def _length(a: NDArray) -> NDArray:
    return np.sqrt(_dot(a, a))


def roots_of(levels: list[Level], cutter: Profile) -> tuple[NDArray, NDArray, NDArray]:
    """The largest branches over which the tool travels no more than its diameter, and rows that travel more.

    As (level, number), shape (n, 2), and float32 boxes around all that the tool sweeps there.
    """
    _, radius, _, _ = cutter.box
    travel = [_length(k.stroke) + k.rest + k.turn * cutter.reach for k in levels]
    small = [t <= 2.0 * radius for t in travel]
    small[0][:] = True
    for level in range(1, len(levels)):
        first = 2 * np.arange(len(small[level]))
        for child in (first, np.minimum(first + 1, len(small[level - 1]) - 1)):
            small[level] &= small[level - 1][child]
    roots, boxes = [], []
    for level, ok in enumerate(small):
        above = small[level + 1] if level + 1 < len(small) else np.zeros(len(ok), dtype=bool)
        chosen = np.flatnonzero(ok & ~np.repeat(above, 2)[: len(ok)])
        roots.append(np.stack([np.full(len(chosen), level), chosen], axis=1))
        at = levels[level]
        boxes.append(_boxes(Level(*(getattr(at, f.name)[chosen] for f in fields(Level))), cutter))
    lower, upper = (np.concatenate([box[k] for box in boxes]) for k in range(2))
    return np.concatenate(roots), lower, upper


def _boxes(level: Level, cutter: Profile) -> tuple[NDArray, NDArray]:
    """Float32 boxes, lower and upper corners of shape (n, 3), around all that the tool sweeps in branches.

    Along a coordinate a circle of radius r about the axis reaches r sqrt(1 - axis²) beyond its centre, and that
    changes by no more than r times what the axis does.
    """
    spread = np.sqrt(np.clip(1.0 - level.axis**2, 0.0, 1.0)) + level.turn[:, None]
    lower, upper = np.full(level.tip.shape, np.inf), np.full(level.tip.shape, -np.inf)
    for e in cutter.elements:
        _, radius, *heights = e.box
        for z in heights:
            centre = level.tip + z * level.axis
            half = np.abs(level.stroke + z * level.swing) + radius * spread
            half += (level.rest + abs(z) * level.sway)[:, None]
            lower, upper = np.minimum(lower, centre - half), np.maximum(upper, centre + half)
    return padded(lower, upper)


def branch_data(levels: list[Level], roots: NDArray, device: str) -> Branches:
    """Branches on a device."""
    data = Branches()
    first = np.cumsum([0, *(len(level.rest) for level in levels)])
    data.level = wp.array(first, dtype=wp.int32, device=device)
    for field in fields(Level):
        column = np.concatenate([getattr(level, field.name) for level in levels])
        kind = wp.vec3d if column.ndim == 2 else wp.float64
        setattr(data, field.name, wp.array(column, dtype=kind, device=device))
    data.roots = wp.array(roots, dtype=wp.vec2i, device=device)
    return data
