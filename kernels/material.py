"""Material along rays, and lists of what is not there: the air from the start, and what is cut away."""

import warp as wp

from gearsim.kernels.interval import IntervalLists, covers, insert
from gearsim.kernels.lattice import SIDE, Square
from gearsim.kernels.sweep import STATUS_INTERVALS_OVERFLOW
from gearsim.kernels.tool_ray import FAR, greater, lesser

f64 = wp.float64

OLD = wp.constant(-2)  # tag t of the stock stands as -2 - t in a list, so that rows, from 0 on, are told apart


@wp.struct
class Material:
    """What is left along rays, as of simulation.intervals.IntervalSet; ends carry tags."""

    first: wp.array(dtype=wp.int64)
    lo: wp.array(dtype=f64)
    hi: wp.array(dtype=f64)
    lo_tag: wp.array(dtype=wp.int32)
    hi_tag: wp.array(dtype=wp.int32)


@wp.func
def fill(material: Material, ray: int, lists: IntervalLists, slot: int) -> int:
    """Put the air along a ray into its list; status bits."""
    begin = int(material.first[ray])
    n = int(material.first[ray + 1]) - begin
    lists.count[slot] = 1
    lists.lo[slot, 0] = -FAR
    lists.hi[slot, 0] = FAR
    if n >= lists.slots:
        return STATUS_INTERVALS_OVERFLOW
    for k in range(n):
        lists.hi[slot, k] = material.lo[begin + k]
        lists.hi_segment[slot, k] = OLD - material.lo_tag[begin + k]
        lists.lo[slot, k + 1] = material.hi[begin + k]
        lists.lo_segment[slot, k + 1] = OLD - material.hi_tag[begin + k]
    lists.count[slot] = n + 1
    lists.hi[slot, n] = FAR
    return 0


@wp.func
def copy_list(lists: IntervalLists, source: int, target: int):
    """Give a slot the intervals of another, without who made them."""
    lists.count[target] = lists.count[source]
    for k in range(lists.count[source]):
        lists.lo[target, k] = lists.lo[source, k]
        lists.hi[target, k] = lists.hi[source, k]


@wp.func
def tag_of(made: int, first_tag: int) -> int:
    """The tag of an end: that of the stock, or that of the row that made it."""
    if made < 0:
        return OLD - made
    return first_tag + made


@wp.func
def empty(lists: IntervalLists, slot: int, first_tag: int):
    """Leave what lies between the intervals of a list instead of them."""
    n = wp.max(lists.count[slot] - 1, 0)
    for k in range(n):
        lists.lo[slot, k] = lists.hi[slot, k]
        lists.hi[slot, k] = lists.lo[slot, k + 1]
        lists.lo_segment[slot, k] = tag_of(lists.hi_segment[slot, k], first_tag)
        lists.hi_segment[slot, k] = tag_of(lists.lo_segment[slot, k + 1], first_tag)
    lists.count[slot] = n


@wp.func
def left_of(lists: IntervalLists, square: Square) -> wp.vec2d:
    """From the first to the last of what the lists of a square of rays leave; empty if first > last."""
    first = FAR
    last = -FAR
    for p in range(square.size):
        for q in range(square.size):
            slot = square.slot + p * SIDE + q
            n = lists.count[slot]
            if n > 1:
                first = lesser(first, lists.hi[slot, 0])
                last = greater(last, lists.lo[slot, n - 1])
    return wp.vec2d(first, last)


@wp.func
def put(lists: IntervalLists, slot: int, lo: f64, hi: f64, row: int, join: f64) -> int:
    """Unite an interval with a list; status bits."""
    if covers(lists, slot, lo, hi) or insert(lists, slot, lo, hi, row, row, join):
        return 0
    return STATUS_INTERVALS_OVERFLOW
