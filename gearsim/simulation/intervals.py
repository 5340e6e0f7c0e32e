"""Intervals along rays: what a motion removes, and what is left of the stock."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle


@dataclass(frozen=True)
class IntervalSet:
    """Disjoint rising intervals per ray, stored compactly: ray i owns rows first[i] to first[i + 1].

    ``lo``, ``hi`` [mm along the ray]; ``lo_segment``, ``hi_segment`` say which segment made an end
    (-1: none, an end of the stock itself).
    """

    first: NDArray[np.integer]
    lo: NDArray[np.floating]
    hi: NDArray[np.floating]
    lo_segment: NDArray[np.integer]
    hi_segment: NDArray[np.integer]

    @property
    def ray(self) -> NDArray:
        """The ray each interval belongs to."""
        return np.repeat(np.arange(len(self.first) - 1), np.diff(self.first))

    @property
    def length(self) -> float:
        """Length of all intervals together [mm]."""
        return float((self.hi - self.lo).sum())

    def part(self, begin: int, end: int, row: int) -> IntervalSet:
        """The intervals of the rays begin to end, segments counted from ``row``."""
        own = slice(self.first[begin], self.first[end])
        return IntervalSet(
            self.first[begin : end + 1] - self.first[begin], self.lo[own], self.hi[own],
            self.lo_segment[own] - row, self.hi_segment[own] - row,
        )  # fmt: skip


def chosen(intervals: IntervalSet, rays: NDArray[np.integer]) -> IntervalSet:
    """The intervals of some rays, in the order of these."""
    count = np.diff(intervals.first)[rays]
    first = np.concatenate([[0], np.cumsum(count)])
    place = np.repeat(intervals.first[rays] - first[:-1], count) + np.arange(first[-1])
    columns = (getattr(intervals, k)[place] for k in ("lo", "hi", "lo_segment", "hi_segment"))
    return IntervalSet(first, *columns)


def nothing(rays: int) -> IntervalSet:
    """No interval on any of some rays."""
    none = np.empty(0)
    return IntervalSet(np.zeros(rays + 1, dtype=int), none, none, none.astype(int), none.astype(int))


def stretches(rays: int, ray: NDArray, lo: NDArray, hi: NDArray, made: int = -1) -> IntervalSet:
    """Stretches that have a length, all made by one; ``ray`` (n,) rises, as Solid.chords gives it."""
    real = hi > lo
    first = np.concatenate([[0], np.cumsum(np.bincount(ray[real], minlength=rays))])
    by = np.full(int(real.sum()), made, dtype=np.int32)
    return IntervalSet(first, lo[real], hi[real], by, by)


def whole(rays: RayBundle) -> IntervalSet:
    """Every ray's window."""
    n = len(rays)
    none = np.full(n, -1)
    return IntervalSet(np.arange(n + 1), rays.start, rays.end, none, none)


def concatenate(sets: Sequence[IntervalSet]) -> IntervalSet:
    """The rays of several sets, one after the other."""
    offsets = np.cumsum([0] + [len(s.lo) for s in sets])
    first = [s.first[:-1] + offset for s, offset in zip(sets, offsets, strict=False)]
    columns = (np.concatenate([getattr(s, k) for s in sets]) for k in ("lo", "hi", "lo_segment", "hi_segment"))
    return IntervalSet(np.concatenate([*first, offsets[-1:]]), *columns)


def from_lists(count: NDArray, lo: NDArray, hi: NDArray, lo_segment: NDArray, hi_segment: NDArray) -> IntervalSet:
    """Compact interval lists of fixed slots, shape (rays, slots), ``count`` used in each."""
    first = np.concatenate([[0], np.cumsum(count)])
    within = np.arange(first[-1]) - np.repeat(first[:-1], count)
    place = np.repeat(lo.shape[1] * np.arange(len(count)), count) + within
    return IntervalSet(first, *(column.ravel()[place] for column in (lo, hi, lo_segment, hi_segment)))


def unite(sets: Sequence[IntervalSet]) -> IntervalSet:
    """The union of what several motions remove from the same rays."""
    if len(sets) == 1:
        return sets[0]
    ray = np.concatenate([s.ray for s in sets])
    lo, hi, lo_made, hi_made = (
        np.concatenate([getattr(s, k) for s in sets]) for k in ("lo", "hi", "lo_segment", "hi_segment")
    )
    rays, at, made = np.concatenate([ray, ray]), np.concatenate([lo, hi]), np.concatenate([lo_made, hi_made])
    opens = np.repeat([1, -1], len(ray))
    order = np.lexsort((-opens, at, rays))  # where one ends and another begins they are one
    rays, at, made, depth = rays[order], at[order], made[order], np.cumsum(opens[order])
    ends = np.flatnonzero(depth == 0)
    starts = np.concatenate([[0], ends[:-1] + 1]).astype(int)[: len(ends)]
    count = np.bincount(rays[ends], minlength=len(sets[0].first) - 1)
    return IntervalSet(np.concatenate([[0], np.cumsum(count)]), at[starts], at[ends], made[starts], made[ends])


def subtract(left: IntervalSet, removed: IntervalSet) -> IntervalSet:
    """What is left of stretches of material after removal from the same rays; ends keep who made them.

    Sorts all interval ends along each ray and keeps the stretches that are in the material and in no cut.
    """
    n, m = len(left.lo), len(removed.lo)
    own, other = left.ray, removed.ray
    rays = np.concatenate([own, own, other, other])
    at = np.concatenate([left.lo, left.hi, removed.lo, removed.hi])
    stock = np.concatenate([np.ones(n), -np.ones(n), np.zeros(2 * m)]).astype(int)
    cut = np.concatenate([np.zeros(2 * n), np.ones(m), -np.ones(m)]).astype(int)
    made = np.concatenate([left.lo_segment, left.hi_segment, removed.lo_segment, removed.hi_segment])
    order = np.lexsort((at, rays))
    rays, at, made = rays[order], at[order], made[order]
    alive = (np.cumsum(stock[order]) > 0) & (np.cumsum(cut[order]) == 0)
    row = np.flatnonzero(alive[:-1] & (rays[1:] == rays[:-1]) & (at[1:] > at[:-1]))
    count = np.bincount(rays[row], minlength=len(removed.first) - 1)
    first = np.concatenate([[0], np.cumsum(count)])
    return IntervalSet(first, at[row], at[row + 1], made[row], made[row + 1])
