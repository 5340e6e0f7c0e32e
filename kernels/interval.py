"""Sorted lists of disjoint intervals, one per ray, in global memory."""

import warp as wp

from gearsim.kernels.tool_ray import FAR

f64 = wp.float64


@wp.struct
class IntervalLists:
    """``lo``, ``hi`` [mm along the ray] and the segment that made each end, shape (rays, slots)."""

    lo: wp.array2d(dtype=f64)
    hi: wp.array2d(dtype=f64)
    lo_segment: wp.array2d(dtype=wp.int32)
    hi_segment: wp.array2d(dtype=wp.int32)
    count: wp.array(dtype=wp.int32)
    slots: wp.int32


@wp.func
def covers(lists: IntervalLists, ray: int, lo: f64, hi: f64) -> bool:
    """Whether one interval of the list already holds [lo, hi]."""
    k = int(0)
    end = lists.count[ray]
    while end - k > 1:
        middle = (k + end) // 2
        if lists.lo[ray, middle] <= lo:
            k = middle
        else:
            end = middle
    return k < end and lists.lo[ray, k] <= lo and hi <= lists.hi[ray, k]


@wp.func
def hull(lists: IntervalLists, ray: int, lo: f64, hi: f64) -> wp.vec2d:
    """From the start of the first to the end of the last interval that meets [lo, hi]; (FAR, -FAR) if none."""
    start = FAR
    end = -FAR
    for k in range(lists.count[ray]):
        if lists.lo[ray, k] <= hi and lo <= lists.hi[ray, k]:
            start = wp.min(start, lists.lo[ray, k])
            end = wp.max(end, lists.hi[ray, k])
    return wp.vec2d(start, end)


@wp.func
def free_stretch(lists: IntervalLists, ray: int, lo: f64, hi: f64, margin: f64) -> wp.vec2d:
    """The first stretch of [lo, hi] farther than ``margin`` from every interval of the list; empty as (1, 0)."""
    for k in range(lists.count[ray]):
        if lists.lo[ray, k] - margin > lo:
            return wp.vec2d(lo, wp.min(hi, lists.lo[ray, k] - margin))
        lo = wp.max(lo, lists.hi[ray, k] + margin)
    if lo > hi:
        return wp.vec2d(f64(1.0), f64(0.0))
    return wp.vec2d(lo, hi)


@wp.func
def insert(lists: IntervalLists, ray: int, lo: f64, hi: f64, lo_segment: int, hi_segment: int, join: f64) -> bool:
    """Unite [lo, hi] with the list, closing gaps up to ``join``; False where no slot is left."""
    n = lists.count[ray]
    first = int(0)
    beyond = n
    while first < beyond:
        middle = (first + beyond) // 2
        if lists.hi[ray, middle] < lo - join:
            first = middle + 1
        else:
            beyond = middle
    last = first
    while last < n and lists.lo[ray, last] <= hi + join:
        if lists.lo[ray, last] < lo:
            lo = lists.lo[ray, last]
            lo_segment = lists.lo_segment[ray, last]
        if lists.hi[ray, last] > hi:
            hi = lists.hi[ray, last]
            hi_segment = lists.hi_segment[ray, last]
        last += 1
    merged = last - first
    if merged == 0 and n == lists.slots:
        return False
    if merged == 0:
        k = n
        while k > first:
            copy(lists, ray, k - 1, k)
            k -= 1
    elif merged > 1:
        k = last
        while k < n:
            copy(lists, ray, k, k - merged + 1)
            k += 1
    lists.count[ray] = n + 1 - merged
    lists.lo[ray, first] = lo
    lists.hi[ray, first] = hi
    lists.lo_segment[ray, first] = lo_segment
    lists.hi_segment[ray, first] = hi_segment
    return True


@wp.func
def copy(lists: IntervalLists, ray: int, source: int, target: int):
    """Move one slot of a ray's list."""
    lists.lo[ray, target] = lists.lo[ray, source]
    lists.hi[ray, target] = lists.hi[ray, source]
    lists.lo_segment[ray, target] = lists.lo_segment[ray, source]
    lists.hi_segment[ray, target] = lists.hi_segment[ray, source]
