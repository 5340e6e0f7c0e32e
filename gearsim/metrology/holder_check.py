"""Whether what stands above flutes touches material: what it sweeps, against what stands when it comes by.

Rays look at the whole stock and at the measured surfaces. Where no holder ever comes near them nothing is left to ask;
else the program is halved again and again: a part of it is clear if its holders touch nothing of what stands before it
begins. A single move is held against what stands when it is over, for its own cutter may go ahead of its holder.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.solid import Solid
from gearsim.metrology.chords import blank_rays, stock_chords
from gearsim.metrology.findings import holder_cut
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.indexed import deepest_in, tools_and_holders, where, who
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, subtract, whole
from gearsim.simulation.operation import Operation, Variant

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_SEEN_MM = 1e-3
_MOST, _POINTS, _FEW = 2000, 1000, 32


class Touch(NamedTuple):
    """A holder's first touch: of which operation, by which of its rows, where [mm] (3,), on how many rays.

    ``depth`` [mm]: how far under its surface, at most, it takes in what stands on these, at ``points`` [mm] (n, 3) of
    them; ``body``: which of its bodies.
    """

    operation: Operation
    row: int
    place: NDArray[np.floating]
    rays: int
    depth: float
    body: str
    points: NDArray[np.floating]


@dataclass(frozen=True)
class HolderInspection:
    """Whether what stands above a variant's cutters touches material, seen on the rays of ``grids`` and of the stock.

    ``box``: where the stock's rays lie close. ``stock``: what it is cut from (None: the part's own). Of surfaces
    without a stock the intended material counts. Less than a micrometre on a ray does not: a shank as wide as its
    cutter rubs along the wall. ``copies``: how often the variant is done, the part indexed about its axis. ``turned``:
    what the stock is turned to first.
    """

    variant: str
    grids: tuple[GridInspection, ...]
    box: DexelBox | None = None
    stock: Solid | None = None
    copies: int = 1
    turned: Solid | None = None
    name: str = "holders"

    def steps(self, job: Job) -> Steps[Reading]:
        program = job.variant(self.variant)
        cutters, holders = tools_and_holders(program, self.copies)
        moves = Moves.of(replace(program, operations=cutters), replace(program, operations=holders))
        touch, complete = yield from moves.first_touch(self._chords(job))
        doubts = () if complete else (f"holders come so close to the part that {_MOST} looks at them settled nothing",)
        if touch is None:
            return Reading((), (), doubts)
        blank = next((s.patch.blank for s in job.part.surfaces.values()), None)
        called = f"the {touch.body} of {who(touch.operation, touch.row)}"
        told = where(touch.operation, touch.row, self.copies)
        return Reading((), (holder_cut(blank, touch.place, touch.rays, touch.depth, called, told),), doubts)

    def _chords(self, job: Job) -> RayBundle:
        """Where there is material to begin with."""
        rays, stock = [grid.grid(job).rays() for grid in self.grids], self.stock or job.part.stock
        if stock is None:
            return join_rays([replace(r, end=np.zeros(len(r))) for r in rays])
        box = [self.box.rays(axis) for axis in range(3)] if self.box else []
        every = join_rays([*rays, *box, blank_rays(stock)])
        known = np.isfinite(every.origin).all(axis=1) & np.isfinite(every.direction).all(axis=1)
        chords = stock_chords(stock, every.part(known), _SEEN_MM)
        return chords if self.turned is None else stock_chords(self.turned, chords, _SEEN_MM)


@dataclass(frozen=True)
class Moves:
    """The moves of a program in their order: of every operation's rows, and its holder's, the number of their move."""

    cutters: Variant
    holders: Variant
    cut_moves: tuple[NDArray[np.integer], ...]
    held_moves: tuple[NDArray[np.integer], ...]

    @classmethod
    def of(cls, cutters: Variant, holders: Variant) -> Moves:
        """Moves by step, motion and piece."""
        keys = [np.stack([o.step, o.table.path, o.table.piece], 1) for v in (cutters, holders) for o in v.operations]
        number = np.unique(np.concatenate(keys), axis=0, return_inverse=True)[1].reshape(-1)
        split = np.split(number, np.cumsum([len(k) for k in keys])[:-1])
        n = len(cutters.operations)
        return cls(cutters, holders, tuple(split[:n]), tuple(split[n:]))

    def first_hit(self, chords: RayBundle) -> Steps[Touch | None]:
        """The first touch of chords from which nothing is ever cut; None: there is none.

        Moves are asked for in order, ever more of them at a time, until some touch; these are halved.
        """
        end = 1 + max((int(m.max(initial=-1)) for m in self.held_moves), default=-1)
        begin, many = 0, _FEW
        while begin < end:
            held = _lost(whole(chords), (yield from self._swept(chords, begin, min(begin + many, end))))
            if _seen(held).any():
                return (yield from self._first_of(chords.part(_on(held)), begin, min(begin + many, end)))
            begin, many = begin + many, 2 * many
        return None

    def _first_of(self, chords: RayBundle, begin: int, end: int) -> Steps[Touch | None]:
        """The first of some moves that touch chords."""
        while end - begin > 1:
            middle = (begin + end) // 2
            held = _lost(whole(chords), (yield from self._swept(chords, begin, middle)))
            begin, end = (begin, middle) if _seen(held).any() else (middle, end)
        held = yield from self._swept(chords, begin, end)
        return self._touch(chords, _lost(whole(chords), held), held, begin)

    def first_touch(self, chords: RayBundle) -> Steps[tuple[Touch | None, bool]]:
        """The first touch of material on chords that begin whole (None: there is none), and whether all was seen."""
        spans = [(0, 1 + max((int(m.max(initial=0)) for m in (*self.cut_moves, *self.held_moves)), default=0))]
        chords = chords.part(_on(_lost(whole(chords), (yield from self._swept(chords, *spans[0])))))
        left = whole(chords)
        spans = spans if len(chords) else []
        for _ in range(_MOST):
            if not spans:
                return None, True
            begin, end = spans.pop()
            held, cut = yield [self._held(chords, begin, end), self._cut(chords, begin, end)]
            if not _seen(_lost(left, held)).any():
                left = subtract(left, cut)
            elif end - begin > 1:
                middle = (begin + end) // 2
                spans += [(middle, end), (begin, middle)]
            else:
                left = subtract(left, cut)
                lost = _lost(left, held)
                if _seen(lost).any():
                    return self._touch(chords, lost, held, begin), True
        return None, not spans

    def _swept(self, chords: RayBundle, begin: int, end: int) -> Steps[IntervalSet]:
        found: IntervalSet = (yield [self._held(chords, begin, end)])[0]
        return found

    def _held(self, chords: RayBundle, begin: int, end: int) -> Cut:
        return Cut(chords, _chosen(self.holders, self.held_moves, begin, end))

    def _cut(self, chords: RayBundle, begin: int, end: int) -> Cut:
        return Cut(chords, _chosen(self.cutters, self.cut_moves, begin, end))

    def _touch(self, chords: RayBundle, lost: IntervalSet, held: IntervalSet, move: int) -> Touch:
        seen = _seen(lost)
        i = int(np.argmax(seen))
        place = chords.origin[lost.ray[i]] + lost.lo[i] * chords.direction[lost.ray[i]]
        mine = next(k for k, moves in enumerate(self.held_moves) if (moves == move).any())
        operation, rows = self.holders.operations[mine], np.flatnonzero(self.held_moves[mine] == move)
        points = _points(chords, lost, np.flatnonzero(seen))
        depth, body = deepest_in(operation, rows, points)
        return Touch(operation, int(rows[0]), place, len(np.unique(lost.ray[seen])), depth, body, points)


def _points(chords: RayBundle, lost: IntervalSet, some: NDArray) -> NDArray:
    """Ends and middles (n, 3) of some stretches, of a thousand of them if there are more."""
    some = some[np.linspace(0, len(some) - 1, min(len(some), _POINTS)).astype(int)]
    at = np.concatenate([lost.lo[some], 0.5 * (lost.lo[some] + lost.hi[some]), lost.hi[some]])
    ray = np.tile(lost.ray[some], 3)
    return chords.origin[ray] + at[:, None] * chords.direction[ray]


def _chosen(variant: Variant, moves: Sequence[NDArray], begin: int, end: int) -> Variant:
    return variant.chosen(lambda i, _: (moves[i] >= begin) & (moves[i] < end))


def _lost(left: IntervalSet, held: IntervalSet) -> IntervalSet:
    """What holders would take of what is left."""
    return subtract(left, subtract(left, held))


def _seen(lost: IntervalSet) -> NDArray[np.bool_]:
    return lost.hi - lost.lo > _SEEN_MM


def _on(lost: IntervalSet) -> NDArray[np.bool_]:
    """The chords on which anything is lost that can be seen."""
    chords = np.zeros(len(lost.first) - 1, dtype=bool)
    chords[lost.ray[_seen(lost)]] = True
    return chords
