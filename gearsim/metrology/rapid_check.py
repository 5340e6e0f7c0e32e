"""Whether rapid moves touch material: the removal road with the rapid moves alone, then in the program's order.

Rays look at the whole blank. Where no rapid touches the uncut blank nothing is left to ask; else what the feeds before
a rapid have removed is taken away first, for a tool may well go down by rapid where it has cut before.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.solid import Solid
from gearsim.metrology.chords import blank_rays, stock_chords
from gearsim.metrology.findings import rapid_cut
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, subtract, whole
from gearsim.simulation.operation import Variant

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_SEEN_MM = 1e-6


@dataclass(frozen=True)
class RapidTouch:
    """The first rapid move that touches material: its step, where [mm] (3,), and how many of the rays it cuts."""

    step: int
    place: NDArray[np.floating]
    rays: int


@dataclass(frozen=True)
class RapidInspection:
    """Whether a variant's rapid moves touch the part's stock, seen by rays through all of it and those of a ``box``.

    Less than a nanometre on a ray does not count. ``move`` says in words how a rapid is called: by ``{line}`` of the
    program it stands in, or by its ``{number}`` among the rapids.
    """

    variant: str
    box: DexelBox
    move: str
    name: str = "rapid moves"

    def steps(self, job: Job) -> Steps[Reading]:
        assert job.part.stock is not None
        variant = job.variant(self.variant)
        rays = join_rays([blank_rays(job.part.stock), *(self.box.rays(axis) for axis in range(3))])
        rapid, line = _in_order(variant)
        touch = yield from rapid_touch(job.part.stock, rays, variant, rapid)
        if touch is None:
            return Reading()
        called = self.move.format(line=line[touch.step], number=int(rapid[: touch.step + 1].sum()))
        blank = next(iter(job.part.surfaces.values())).patch.blank
        return Reading((), (rapid_cut(blank, touch.place, touch.rays, called),))


def _in_order(variant: Variant) -> tuple[NDArray[np.bool_], NDArray[np.integer]]:
    """Of every step of a variant, in the program's order: whether it is a rapid, and its line."""
    steps = 1 + max(int(o.step.max(initial=-1)) for o in variant.operations)
    rapid, line = np.zeros(steps, dtype=bool), np.zeros(steps, dtype=int)
    for o in variant.operations:
        rapid[o.step], line[o.step] = o.rapid, o.line
    return rapid, line


def _ask(chords: RayBundle, variant: Variant, steps: NDArray[np.bool_]) -> Steps[IntervalSet]:
    """What chosen steps of a variant remove from chords."""
    chosen = variant.chosen(lambda _, operation: steps[operation.step])
    removed: IntervalSet = (yield [Cut(chords, chosen)])[0]
    return removed


def rapid_touch(stock: Solid, rays: RayBundle, variant: Variant, rapid: NDArray[np.bool_]) -> Steps[RapidTouch | None]:
    """The first rapid step that removes material from the rays' chords in a blank; None where there is none.

    ``rapid`` (n,) says of every step of the program, in its order, whether it is one.
    """
    chords = stock_chords(stock, rays, _SEEN_MM)
    if not rapid.any() or not len(chords):
        return None
    chords = chords.part(_touched(chords, (yield from _ask(chords, variant, rapid))))
    return (yield from _first(chords, variant, rapid)) if len(chords) else None


def _first(chords: RayBundle, variant: Variant, rapid: NDArray[np.bool_]) -> Steps[RapidTouch | None]:
    """The first run of rapids that cuts what all feeds before it have left."""
    step, left, done = np.arange(len(rapid)), whole(chords), 0
    for begin, end in (yield from _suspects(chords, variant, _runs(rapid), rapid)):
        before = ~rapid & (step >= done) & (step < begin)
        if before.any():
            left = subtract(left, (yield from _ask(chords, variant, before)))
        done = begin
        cut = yield from _ask(chords, variant, rapid & (step >= begin) & (step < end))
        lost = subtract(left, subtract(left, cut))
        seen = np.flatnonzero(lost.hi - lost.lo > _SEEN_MM)
        if len(seen):
            i = seen[0]
            place = chords.origin[lost.ray[i]] + lost.lo[i] * chords.direction[lost.ray[i]]
            return RapidTouch(int(begin), place, len(np.unique(lost.ray[seen])))
    return None


def _suspects(
    chords: RayBundle, variant: Variant, runs: NDArray[np.integer], rapid: NDArray[np.bool_]
) -> Steps[list[NDArray[np.integer]]]:
    """The runs, shape (k, 2), that touch the uncut blank, in order, by halving their number."""
    step = np.arange(len(rapid))
    chosen = rapid & (step >= runs[0, 0]) & (step < runs[-1, 1])
    if not _touched(chords, (yield from _ask(chords, variant, chosen))).any():
        return []
    if len(runs) == 1:
        return [runs[0]]
    half = len(runs) // 2
    first = yield from _suspects(chords, variant, runs[:half], rapid)
    return first + (yield from _suspects(chords, variant, runs[half:], rapid))


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
