"""The removal kernel for rings, in a module of its own: other tools need not wait for it to compile."""

import warp as wp

from gearsim.kernels.interval import IntervalLists, free_stretch, insert
from gearsim.kernels.options import OPTIONS
from gearsim.kernels.pose import Motion
from gearsim.kernels.removal import CAPSULE_PAD, CAPSULE_SHARE, extent_of
from gearsim.kernels.ring import Ring, rounding_of, window_of
from gearsim.kernels.ring_chase import chase
from gearsim.kernels.ring_search import HIT, LOST, find_hit
from gearsim.kernels.sweep import STATUS_INTERVALS_OVERFLOW, STATUS_NOT_CONVERGED

f64 = wp.float64

wp.set_module_options(OPTIONS)

MAX_SWEEPS = wp.constant(64)
# Rows next to each other cut nearly alike: every 64th first, so that most of the others find their part cut already.
STRIDE = wp.constant(64)
STEP = wp.constant(8)


@wp.func
def cut_by_ring(
    ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, lo: f64, hi: f64,
    tolerance: f64, ray: int, lists: IntervalLists,
) -> int:  # fmt: skip
    """Unite what one segment of a ring's motion removes from [lo, hi] of a ray with the ray's list; status bits.

    What the list covers is not looked at again; the rest is searched until no hit deeper than rounding is left.
    """
    slack = rounding_of(ring, origin, lo, hi)
    status = int(0)
    sweeps = int(0)
    from_tau = lo
    while from_tau < hi:
        free = free_stretch(lists, ray, from_tau, hi, tolerance)
        if free[0] > free[1]:
            return status
        find = find_hit(ring, motion, row, origin, direction, free[0], free[1], slack)
        from_tau = free[0]
        if find.outcome == HIT:
            start = chase(ring, motion, row, origin, direction, find.hit, f64(-1.0), slack)
            end = chase(ring, motion, row, origin, direction, find.hit, f64(1.0), slack)
            sweeps += 1
            if not insert(lists, ray, start, end, row, row, tolerance):
                return status | STATUS_INTERVALS_OVERFLOW
            if sweeps == MAX_SWEEPS:
                return status | STATUS_NOT_CONVERGED
        else:
            if find.outcome == LOST:
                status = status | STATUS_NOT_CONVERGED
            from_tau = free[1]
    return status


@wp.kernel
def cut_rays_by_ring(
    # cutter
    ring: Ring,
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
    """Cut each ray by all segments whose bounds its window [tau_min, tau_max] meets, distant ones first."""
    ray = first + wp.tid()
    o = origin[ray]
    d = direction[ray]
    lo = tau_min[ray]
    hi = tau_max[ray]
    pad = CAPSULE_PAD + CAPSULE_SHARE * wp.float32(extent_of(o + lo * d, o + hi * d))
    candidates = int(0)
    pairs = int(0)
    status = int(0)
    stride = STRIDE
    while stride > 0:
        query = wp.bvh_query_capsule(bvh, wp.vec3(o + lo * d), wp.vec3((hi - lo) * d), pad)
        row = int(0)
        while wp.bvh_query_next(query, row, wp.float32(1.0)):
            if row % stride == 0 and (stride == STRIDE or row % (STEP * stride) != 0):
                candidates += 1
                near = window_of(ring, motion, row, o, d)
                near_lo = wp.max(near[0], lo)
                near_hi = wp.min(near[1], hi)
                if near[0] <= near[1] and near_lo <= near_hi:
                    pairs += 1
                    status = status | cut_by_ring(ring, motion, row, o, d, near_lo, near_hi, tolerance, ray, lists_out)
        stride = stride // STEP
    candidates_out[ray] = candidates
    pairs_out[ray] = pairs
    status_out[ray] = status
