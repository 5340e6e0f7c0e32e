"""Squares of parallel rays and their lists: which may be cut deeper by a branch, and chords at single poses cut off."""

import warp as wp

from gearsim.kernels.branches import Reach
from gearsim.kernels.interval import IntervalLists, covers
from gearsim.kernels.lattice import RAYS, SIDE, Lattice, Square, start_of
from gearsim.kernels.material import put
from gearsim.kernels.profile import Cutter, cutter_interval
from gearsim.kernels.tool_ray import FAR, greater, lesser, tool_ray

f64 = wp.float64

ALL = wp.constant(wp.uint64(0xFFFFFFFFFFFFFFFF))


@wp.func
def steps_in(square: Square, lattice: Lattice) -> wp.vec2d:
    """How far it is from one ray of a square to the next, both ways, where it is 2 from the first to the last."""
    i = wp.min(square.size, lattice.first.shape[0] - square.i) - 1
    j = wp.min(square.size, lattice.second.shape[0] - square.j) - 1
    return wp.vec2d(f64(2.0) / f64(wp.max(i, 1)), f64(2.0) / f64(wp.max(j, 1)))


@wp.func
def bit_of(square: Square, whole: Square, p: int, q: int) -> wp.uint64:
    """The bit that stands for a ray of a square in its tile."""
    return wp.uint64(1) << wp.uint64(square.slot - whole.slot + p * SIDE + q)


@wp.func
def mask_of(code: int) -> wp.uint64:
    """The rays of a part of a tile."""
    size = code // (SIDE * SIDE)
    one = (wp.uint64(1) << wp.uint64(size)) - wp.uint64(1)
    mask = wp.uint64(0)
    for p in range(size):
        mask = mask | (one << wp.uint64(p * SIDE))
    return mask << wp.uint64(code % (SIDE * SIDE))


@wp.func
def open_rays(
    reach: Reach, lattice: Lattice, whole: Square, square: Square, rays: wp.uint64, margin: f64,
    lists: IntervalLists,
) -> wp.uint64:  # fmt: skip
    """Those of a square's rays of which a branch may take more than their lists hold, by more than a margin."""
    found = wp.uint64(0)
    steps = steps_in(square, lattice)
    for p in range(square.size):
        at = f64(p) * steps[0] - f64(1.0)
        lo_p = reach.early[0] + at * reach.early[1] - reach.early[2]
        hi_p = reach.late[0] + at * reach.late[1] - reach.late[2]
        lo_q = steps[1] * reach.early[2]
        hi_q = steps[1] * reach.late[2]
        for q in range(square.size):
            bit = bit_of(square, whole, p, q)
            slot = square.slot + p * SIDE + q
            if (rays & bit) != wp.uint64(0) and lists.count[slot] > 1:
                lo = greater(lo_p + f64(q) * lo_q, reach.first) + margin
                hi = lesser(hi_p + f64(q) * hi_q, reach.last) - margin
                if lo <= hi and not covers(lists, slot, lo, hi):
                    found = found | bit
    return found


@wp.func
def chord_of(reach: Reach, sag: f64) -> Reach:
    """About what the cutter holds of a tile's rays at a branch's pose."""
    chord = Reach()
    chord.first = -FAR
    chord.last = FAR
    chord.early = wp.vec3d(reach.lo + sag, reach.early[1], reach.early[2])
    chord.late = wp.vec3d(reach.hi - sag, reach.late[1], reach.late[2])
    return chord


@wp.func
def cut_chords(
    cutter: Cutter, tip: wp.vec3d, axis: wp.vec3d, row: int, lattice: Lattice, whole: Square, square: Square,
    rays: wp.uint64, join: f64, lists: IntervalLists,
) -> int:  # fmt: skip
    """Cut from rays of a square what the cutter holds of them at a pose of a row; status bits."""
    status = int(0)
    for p in range(square.size):
        for q in range(square.size):
            slot = square.slot + p * SIDE + q
            if (rays & bit_of(square, whole, p, q)) != wp.uint64(0) and lists.count[slot] > 1:
                o = start_of(lattice, square.i + p, square.j + q)
                ray = tool_ray(tip, axis, cutter.middle, o, lattice.direction)
                hit = cutter_interval(cutter, ray)
                if hit.found == 1:
                    status = status | put(lists, slot, hit.lo + ray.shift, hit.hi + ray.shift, row, join)
    return status


@wp.func
def cut_common(
    cutter: Cutter, tip: wp.vec3d, axis: wp.vec3d, row: int, lattice: Lattice, square: Square, join: f64,
    lists: IntervalLists,
) -> int:  # fmt: skip
    """Cut from all rays of a square the stretch that a convex cutter holds of its four corners; status bits."""
    i = wp.min(square.size, lattice.first.shape[0] - square.i) - 1
    j = wp.min(square.size, lattice.second.shape[0] - square.j) - 1
    lo = -FAR
    hi = FAR
    for k in range(4):
        o = start_of(lattice, square.i + k // 2 * i, square.j + k % 2 * j)
        ray = tool_ray(tip, axis, cutter.middle, o, lattice.direction)
        hit = cutter_interval(cutter, ray)
        if hit.found == 0:
            return 0
        lo = greater(lo, hit.lo + ray.shift)
        hi = lesser(hi, hit.hi + ray.shift)
    status = int(0)
    if lo < hi:
        for k in range(RAYS):
            if lists.count[square.slot + k] > 1:
                status = status | put(lists, square.slot + k, lo, hi, row, join)
    return status
