"""Whether rapid moves touch material: the removal road with the rapid moves alone, then in the program's order.

Rays look at the whole blank. Where no rapid touches the uncut blank nothing is left to ask; else what the feeds before
a rapid have removed is taken away first, for a tool may well go down by rapid where it has cut before.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.turned import Turned
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, subtract

_CELLS = 128
_SEEN_MM = 1e-6

Removed = Callable[[RayBundle, NDArray[np.bool_]], IntervalSet]


@dataclass(frozen=True)
class RapidTouch:
    """The first rapid move that touches material: its step, where [mm] (3,), and how many of the rays it cuts."""

    step: int
    place: NDArray[np.floating]
    rays: int


def blank_rays(stock: Turned) -> RayBundle:
    """Rays along x, y and z through a whole blank, 128 cells along its longest edge."""
    radius = float(stock.polygon[:, 0].max())
    low, high = float(stock.polygon[:, 1].min()), float(stock.polygon[:, 1].max())
    lower, upper = np.array([-radius, -radius, low]), np.array([radius, radius, high])
    pitch = min(float((upper - lower).max()) / _CELLS, float((upper - lower).min()))
    box = DexelBox(Rigid(np.eye(3), np.zeros(3)), lower, upper, pitch)
    return join_rays([box.rays(axis) for axis in range(3)])


def rapid_touch(stock: Turned, rays: RayBundle, rapid: NDArray[np.bool_], removed: Removed) -> RapidTouch | None:
    """The first rapid step that removes material from the rays' chords in a blank; None where there is none.

    ``rapid`` (n,) says of every step of the program, in its order, whether it is one; ``removed`` what chosen steps,
    shape (n,), remove from rays. Less than a nanometre on a ray does not count.
    """
    ray, start, end = stock.chords(rays.origin, rays.direction)
    start, end = np.maximum(start, rays.start[ray]), np.minimum(end, rays.end[ray])
    inside = end - start > _SEEN_MM
    ray, start, end = ray[inside], start[inside], end[inside]
    chords = RayBundle(rays.origin[ray], rays.direction[ray], start, end)
    if not rapid.any() or not len(chords):
        return None
    chords = chords.part(_touched(chords, removed(chords, rapid)))
    return _first(chords, rapid, removed) if len(chords) else None


def _first(chords: RayBundle, rapid: NDArray[np.bool_], removed: Removed) -> RapidTouch | None:
    """The first run of rapids that cuts what all feeds before it have left."""
    step, none = np.arange(len(rapid)), np.full(len(chords), -1)
    left, done = IntervalSet(np.arange(len(chords) + 1), chords.start, chords.end, none, none), 0
    for begin, end in _suspects(chords, _runs(rapid), rapid, removed):
        before = ~rapid & (step >= done) & (step < begin)
        if before.any():
            left = subtract(left.ray, left.lo, left.hi, removed(chords, before))
        done = begin
        kept = subtract(left.ray, left.lo, left.hi, removed(chords, rapid & (step >= begin) & (step < end)))
        lost = subtract(left.ray, left.lo, left.hi, kept)
        seen = np.flatnonzero(lost.hi - lost.lo > _SEEN_MM)
        if len(seen):
            i = seen[0]
            place = chords.origin[lost.ray[i]] + lost.lo[i] * chords.direction[lost.ray[i]]
            return RapidTouch(int(begin), place, len(np.unique(lost.ray[seen])))
    return None


def _suspects(
    chords: RayBundle, runs: NDArray[np.integer], rapid: NDArray[np.bool_], removed: Removed
) -> list[NDArray[np.integer]]:  # fmt: skip
    """The runs, shape (k, 2), that touch the uncut blank, in order, by halving their number."""
    step = np.arange(len(rapid))
    chosen = rapid & (step >= runs[0, 0]) & (step < runs[-1, 1])
    if not _touched(chords, removed(chords, chosen)).any():
        return []
    if len(runs) == 1:
        return [runs[0]]
    half = len(runs) // 2
    return [*_suspects(chords, runs[:half], rapid, removed), *_suspects(chords, runs[half:], rapid, removed)]


def _runs(rapid: NDArray[np.bool_]) -> NDArray[np.integer]:
    """First and last step (exclusive) of each run of consecutive rapids, shape (k, 2)."""
    change = np.diff(np.concatenate([[False], rapid, [False]]).astype(int))
    return np.stack([np.flatnonzero(change > 0), np.flatnonzero(change < 0)], axis=1)


def _touched(chords: RayBundle, cut: IntervalSet) -> NDArray[np.bool_]:
    ray = cut.ray
    inside = np.minimum(cut.hi, chords.end[ray]) - np.maximum(cut.lo, chords.start[ray]) > _SEEN_MM
    touched = np.zeros(len(chords), dtype=bool)
    touched[ray[inside]] = True
    return touched
