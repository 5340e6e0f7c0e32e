"""The removal kernel: every ray gathers the intervals that the segments near it sweep away."""

import warp as wp
from gearsim.kernels.interval import IntervalLists, covers, insert
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter
from gearsim.kernels.sweep import (
    Chord,
    chord_at,
    earliest_entry,
    hidden_hit,
    may_meet,
    overlap,
    separating_pose,
    side_of,
)

f64 = wp.float64

wp.set_module_options({"enable_backward": False})

STATUS_INTERVALS_OVERFLOW = wp.constant(1)
STATUS_NOT_CONVERGED = wp.constant(2)

MAX_RUNS = wp.constant(12)
CAPSULE_PAD = wp.constant(wp.float32(1.0e-3))


@wp.struct
class Sweep:
    """The interval removed by one run of hits, and the part [from_x, to_x] of its bracket it accounts for."""

    lo: f64
    hi: f64
    from_x: f64
    to_x: f64
    gap: wp.int32
    converged: wp.int32


@wp.func
def sweep_run(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    left: Chord, right: Chord, tolerance: f64,
) -> Sweep:  # fmt: skip
    """Interval removed between two poses of which at least one hits."""
    sweep = Sweep()
    sweep.converged = 1
    sweep.from_x = left.entry.x
    sweep.to_x = right.entry.x
    for side in range(2):
        a = side_of(left, side)
        b = side_of(right, side)
        end = earliest_entry(cutter, motion, row, origin, direction, side, a, b, tolerance)
        if side == 0:
            sweep.lo = end.tau
        else:
            sweep.hi = -end.tau
        sweep.from_x = wp.max(sweep.from_x, end.from_x)
        sweep.to_x = wp.min(sweep.to_x, end.to_x)
        sweep.gap = wp.max(sweep.gap, end.gap)
        sweep.converged = wp.min(sweep.converged, end.converged)
    return sweep


@wp.func
def cut_by_segment(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    tolerance: f64, bound: f64, ray: int, lists: IntervalLists,
) -> int:  # fmt: skip
    """Unite what one segment removes from one ray with the ray's list; status bits.

    Takes one run of hits after the other out of the bracket [left, right], until both ends miss and
    nothing is hidden between them.
    """
    left = chord_at(cutter, motion, row, origin, direction, f64(-1.0))
    right = chord_at(cutter, motion, row, origin, direction, f64(1.0))
    status = int(0)
    runs = int(0)
    while left.entry.x < right.entry.x:
        end = right
        if left.entry.found == 0 and right.entry.found == 0:
            end = hidden_hit(cutter, motion, row, origin, direction, bound, left, right)
            if end.entry.found == 0:
                return status
        elif left.entry.found == 1 and right.entry.found == 1 and not overlap(left, right):
            end = separating_pose(cutter, motion, row, origin, direction, left, right)
        if runs == MAX_RUNS:
            return status | STATUS_NOT_CONVERGED
        sweep = sweep_run(cutter, motion, row, origin, direction, left, end, tolerance)
        runs += 1
        if sweep.gap == 1:
            end = chord_at(cutter, motion, row, origin, direction, sweep.to_x)
            sweep = sweep_run(cutter, motion, row, origin, direction, left, end, tolerance)
        if sweep.converged == 0:
            status = status | STATUS_NOT_CONVERGED
        if not insert(lists, ray, sweep.lo, sweep.hi, row, row, tolerance):
            status = status | STATUS_INTERVALS_OVERFLOW
        if end.entry.x < right.entry.x:
            left = end
        elif left.entry.found == 0:
            right = chord_at(cutter, motion, row, origin, direction, sweep.from_x)
        elif right.entry.found == 0:
            left = chord_at(cutter, motion, row, origin, direction, sweep.to_x)
        else:
            left = right
    return status


@wp.kernel
def cut_rays(
    # cutter
    cutter: Cutter,
    bound: f64,
    # motion
    motion: Motion,
    bvh: wp.uint64,
    tolerance: f64,
    # in
    first: int,
    origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d),
    tau_min: wp.array(dtype=f64),
    tau_max: wp.array(dtype=f64),
    # out
    lists_out: IntervalLists,
    candidates_out: wp.array(dtype=wp.int32),
    pairs_out: wp.array(dtype=wp.int32),
    status_out: wp.array(dtype=wp.int32),
):
    """Cut each ray by all segments whose bounds its window [tau_min, tau_max] meets."""
    ray = first + wp.tid()
    o = origin[ray]
    d = direction[ray]
    lo = tau_min[ray]
    hi = tau_max[ray]
    query = wp.bvh_query_capsule(bvh, wp.vec3(o + lo * d), wp.vec3((hi - lo) * d), CAPSULE_PAD)
    row = int(0)
    candidates = int(0)
    pairs = int(0)
    status = int(0)
    while wp.bvh_query_next(query, row, wp.float32(1.0)):
        candidates += 1
        near = may_meet(cutter, motion, row, o, d)
        near_lo = wp.max(near[0], lo)
        near_hi = wp.min(near[1], hi)
        if near[0] <= near[1] and near_lo <= near_hi and not covers(lists_out, ray, near_lo, near_hi):
            pairs += 1
            status = status | cut_by_segment(cutter, motion, row, o, d, tolerance, bound, ray, lists_out)
    candidates_out[ray] = candidates
    pairs_out[ray] = pairs
    status_out[ray] = status
