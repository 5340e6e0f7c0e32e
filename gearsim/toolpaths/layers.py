"""Roughing in layers from one direction: straight lines at one height, wherever the part lets the tool go as deep."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import across
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.solid import Solid, box_corners
from gearsim.toolpaths.counts import check_count
from gearsim.toolpaths.drop_cutter import underside
from gearsim.toolpaths.straight import Move

_CELLS = 24
"""Cells of the height map under the tool's radius."""
_OVER_MM = 0.5
"""How far over the layer before a rapid down ends."""


class HeightMap(NamedTuple):
    """How low the tip may go at places of a grid ``x`` (m,), ``y`` (n,) [mm] of a frame whose third axis is the tool's.

    ``frame``: its axes in the part, as rows. ``lowest`` (m, n) is -inf where nothing of the part is near.
    """

    frame: NDArray[np.floating]
    x: NDArray[np.floating]
    y: NDArray[np.floating]
    lowest: NDArray[np.floating]


def layers(
    part: Solid, blank: Solid, cutter: Profile, direction: NDArray, depth: float, stepover: float, allowance: float,
    clear: float,
) -> list[Move]:  # fmt: skip
    """Moves of the tip, its axis along the unit ``direction``: layers of at most ``depth`` [mm] down from the blank.

    Lines run over the whole blank and beyond, ``stepover`` [mm] apart; at least ``allowance`` [mm] stays on the
    part, along the axis and across it. Rapids run ``clear`` [mm] over the blank, and down to the layer before it,
    where the tool has been. The last layer is the lowest at which the tool stands over anything of the part: what the
    blank holds beside the part goes no deeper.

    Raises InputError for a cutter that is not convex, and where there is nothing to take away.
    """
    if not cutter.is_convex:
        raise InputError(f"cutter {cutter.name!r} is not convex: lowered, it may hook under the part")
    heights = height_map(part, blank, cutter, direction, allowance)
    top = float((box_corners(blank) @ heights.frame[2]).max())
    floor = float(heights.lowest[np.isfinite(heights.lowest)].min())
    if not floor < top:
        raise InputError(f"in layers from {direction} nothing is to be taken away; lower allowance_mm")
    check_count(top - floor, depth, what="depth_mm")
    count = ceil((top - floor) / depth - 1e-9)
    levels = np.linspace(top, floor, count + 1)
    lines = _lines(heights, box_corners(blank) @ heights.frame[1], stepover)
    moves: list[Move] = []
    for before, level in pairwise(levels):
        for move in _layer(heights, lines, float(before), float(level), top + clear):
            if moves and move.rapid and (moves[-1].tips[-1] != move.tips[0]).any():
                moves.append(Move(np.array([moves[-1].tips[-1], move.tips[0]]), True))
            moves.append(move)
    return [Move(move.tips @ heights.frame, move.rapid) for move in moves]


def height_map(part: Solid, blank: Solid, cutter: Profile, direction: NDArray, allowance: float) -> HeightMap:
    """Where the tip may go: over the part's rays along the axis, every one as wide as its cell and its neighbours."""
    sideways = across(direction)
    frame = np.stack([sideways, np.cross(direction, sideways), direction])
    corners, radius = box_corners(blank) @ frame.T, cutter.max_radius
    cell = radius / _CELLS
    low, high = corners.min(axis=0) - radius - 2.0 * cell, corners.max(axis=0) + radius + 2.0 * cell
    check_count(float((high - low)[:2].max()), cell, what="the height map's cell")
    x, y = (np.linspace(a, b, ceil((b - a) / cell) + 1) for a, b in zip(low[:2], high[:2], strict=True))
    rays = np.stack([*np.meshgrid(x, y, indexing="ij"), np.full((len(x), len(y)), low[2] - 1.0)], axis=-1)
    origins = rays.reshape(-1, 3) @ frame
    ray, _, end = part.chords(origins, np.broadcast_to(direction, origins.shape))
    height = np.full(len(origins), -np.inf)
    np.maximum.at(height, ray, low[2] - 1.0 + end)
    wide = _CELLS + 2 + ceil(allowance / cell)
    offsets = cell * np.arange(-wide, wide + 1)
    away = np.maximum(np.hypot(*np.meshgrid(offsets, offsets, indexing="ij")) - 1.5 * cell - allowance, 0.0)
    below = underside(cutter, away)
    under = np.isfinite(below)
    from scipy.ndimage import grey_dilation  # slow to load, and few programs have layers

    lifted = grey_dilation(height.reshape(len(x), len(y)), footprint=under, structure=np.where(under, -below, 0.0),
                           mode="constant", cval=-np.inf)  # fmt: skip
    return HeightMap(frame, x, y, lifted + allowance)


def _lines(heights: HeightMap, sides: NDArray, stepover: float) -> NDArray[np.integer]:
    """Columns of the height map along which lines run, from one side of the blank to the other."""
    y = heights.y
    first, last = np.searchsorted(y, sides.min()), np.searchsorted(y, sides.max())
    count = ceil((y[last] - y[first]) / stepover - 1e-9) + 1
    return np.unique(np.linspace(first, last, max(2, count)).astype(int))


def _layer(heights: HeightMap, lines: NDArray, before: float, level: float, clear: float) -> Iterator[Move]:
    """Every stretch of every line on which the tip may be as low as the layer."""
    for k, line in enumerate(lines):
        free = np.concatenate([[False], heights.lowest[:, line] <= level, [False]])
        change = np.flatnonzero(np.diff(free.astype(int)))
        for first, last in zip(change[::2], change[1::2] - 1, strict=True):
            if last > first:
                ends = heights.x[[first, last]][:: -1 if k % 2 else 1]
                (a, b), y = ends, heights.y[line]
                down = min(before + _OVER_MM, clear)
                yield Move(np.array([[a, y, clear], [a, y, down]]), True)
                yield Move(np.array([[a, y, down], [a, y, level], [b, y, level]]), False)
                yield Move(np.array([[b, y, level], [b, y, clear]]), True)
