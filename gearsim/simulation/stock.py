"""Stock: what is left of a whole part's blank along the rays of a tri-dexel, operation after operation."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.solid import Solid
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, concatenate, stretches, subtract
from gearsim.simulation.operation import Operation
from gearsim.simulation.workshop import Workshop

BLANK = -1
AXES = (0, 1, 2)
_TILE = 1 << 19
Bundles = tuple[IntervalSet, IntervalSet, IntervalSet]


@dataclass(frozen=True)
class Done:
    """An operation that a stock has undergone: its ``rows`` are told by tags from ``first_tag`` on.

    ``turned``: it turned the blank to an outline, no tool's rows did.
    """

    name: str
    rows: int
    first_tag: int
    turned: bool = False


@dataclass(frozen=True)
class Stock:
    """Material left along the three bundles of a box, at rest.

    ``lo_segment`` and ``hi_segment`` of ``left`` are tags: -1 for an end of the blank itself, else the number of the
    row that made it, counted through all operations ``done``. A ray with one interval takes 32 bytes; the rays
    themselves are the box's and are not kept.
    """

    box: DexelBox
    left: Bundles
    done: tuple[Done, ...] = ()

    @property
    def next_tag(self) -> int:
        """The first tag of the next operation."""
        return self.done[-1].first_tag + self.done[-1].rows if self.done else 0

    @property
    def volumes(self) -> tuple[float, float, float]:
        """Volume [mm³] by each bundle; their spread tells of the grid's error."""
        x, y, z = (self.box.cell_area(axis) * k.length for axis, k in zip(AXES, self.left, strict=True))
        return x, y, z

    @property
    def nbytes(self) -> int:
        """What it takes in memory [bytes]."""
        columns = ("first", "lo", "hi", "lo_segment", "hi_segment")
        return sum(getattr(bundle, name).nbytes for bundle in self.left for name in columns)

    def operation_of(self, tags: NDArray[np.integer]) -> NDArray[np.integer]:
        """Which of the operations done made ends of these tags; -1: none, they are the blank's."""
        first = np.array([d.first_tag for d in self.done], dtype=int)
        return np.where(tags < 0, BLANK, np.searchsorted(first, tags, side="right") - 1)

    def cut(self, tags: NDArray[np.integer]) -> NDArray[np.bool_]:
        """Whether a tool's rows made ends of these tags: not the blank itself, nor turning it to an outline."""
        given = np.array([*(d.turned for d in self.done), True])
        own: NDArray[np.bool_] = ~given[self.operation_of(tags)]  # BLANK is the last one
        return own


def blank_stock(box: DexelBox, blank: Solid) -> Stock:
    """A blank's whole material along the rays of a box; what of it lies outside the box is not seen."""
    return Stock(box, _bundles([concatenate(list(_blank_tiles(box.rays(axis), blank))) for axis in AXES]))


def _blank_tiles(rays: RayBundle, blank: Solid) -> Iterator[IntervalSet]:
    for begin in range(0, len(rays), _TILE):
        part = rays.part(slice(begin, begin + _TILE))
        ray, lo, hi = blank.chords(part.origin, part.direction)
        lo, hi = np.clip(lo, part.start[ray], part.end[ray]), np.clip(hi, part.start[ray], part.end[ray])
        yield stretches(len(part), ray, lo, hi, BLANK)


def cut_stock(stock: Stock, operations: Sequence[Operation], workshop: Workshop) -> Stock:
    """What operations leave of a stock, one after the other.

    Raises NumericalError where a status forbids trust.
    """
    for operation in operations:
        stock = after(stock, [_cut(stock, axis, operation, workshop) for axis in AXES], operation)
    return stock


def after(stock: Stock, left: Sequence[IntervalSet], operation: Operation) -> Stock:
    """The stock of which an operation has left this, its ends tagged from the stock's next tag on."""
    return Stock(stock.box, _bundles(left), (*stock.done, Done(operation.name, len(operation), stock.next_tag)))


def _cut(stock: Stock, axis: int, operation: Operation, workshop: Workshop) -> IntervalSet:
    """What an operation leaves of one bundle."""
    if operation.cutter.is_ring:
        return _cut_by_ring(stock, axis, operation, workshop)
    return workshop.cut_bundle(stock.box, axis, stock.left[axis], operation, stock.next_tag)


def _cut_by_ring(stock: Stock, axis: int, operation: Operation, workshop: Workshop) -> IntervalSet:
    """The same of a ring: rays with material alone are asked for, as far as it reaches."""
    left, rays = stock.left[axis], stock.box.rays(axis)
    tiles = []
    for begin in range(0, len(rays), _TILE):
        end = min(begin + _TILE, len(rays))
        here = left.part(begin, end, 0)
        full = np.flatnonzero(np.diff(here.first))
        first, last = here.first[full], here.first[full + 1] - 1
        bundle = rays.part(begin + full)
        asked = RayBundle(bundle.origin, bundle.direction, here.lo[first], here.hi[last])
        (removed,) = workshop.cut([(asked, [operation])])
        tiles.append(without(here, full, removed, stock.next_tag))
    return concatenate(tiles)


def without(left: IntervalSet, full: NDArray, removed: IntervalSet, first_tag: int) -> IntervalSet:
    """Material less what was removed from its rays ``full``, the ends that were made told by tags."""
    spread = np.zeros(len(left.first) - 1, dtype=int)
    spread[full] = np.diff(removed.first)
    lo, hi = (np.where(row >= 0, row + first_tag, BLANK) for row in (removed.lo_segment, removed.hi_segment))
    cut = IntervalSet(np.concatenate([[0], np.cumsum(spread)]), removed.lo, removed.hi, lo, hi)
    return subtract(left, cut)


def material_rays(stock: Stock, axis: int) -> RayBundle:
    """A bundle's rays, each with the window in which there is material; without any its window is a point."""
    rays, left = stock.box.rays(axis), stock.left[axis]
    some = np.flatnonzero(np.diff(left.first))
    start, end = np.zeros(len(rays)), np.zeros(len(rays))
    start[some], end[some] = left.lo[left.first[some]], left.hi[left.first[some + 1] - 1]
    return RayBundle(rays.origin, rays.direction, start, end)


def turn_stock(stock: Stock, kept: Solid, name: str) -> Stock:
    """What is left within a solid: turning to its outline, as one operation of one row."""
    tag = stock.next_tag
    left = [subtract(k, _outside(stock.box.rays(axis), kept, tag)) for axis, k in zip(AXES, stock.left, strict=True)]
    return replace(stock, left=_bundles(left), done=(*stock.done, Done(name, 1, tag, turned=True)))


def _outside(rays: RayBundle, kept: Solid, tag: int) -> IntervalSet:
    """Where rays run outside a solid, from minus to plus infinity."""
    ray, start, end = kept.chords(rays.origin, rays.direction)
    every = np.arange(len(rays))
    owner = np.concatenate([every, ray])
    lo, hi = np.concatenate([np.full(len(rays), -np.inf), end]), np.concatenate([np.full(len(rays), np.inf), start])
    starts, ends = np.lexsort((lo, owner)), np.lexsort((hi, owner))
    return stretches(len(rays), owner[starts], lo[starts], hi[ends], tag)


def _bundles(left: Sequence[IntervalSet]) -> Bundles:
    x, y, z = (
        replace(k, lo_segment=k.lo_segment.astype(np.int32), hi_segment=k.hi_segment.astype(np.int32)) for k in left
    )
    return x, y, z
