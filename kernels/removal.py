"""The removal kernel: every ray gathers the intervals that the segments near it sweep away."""

import warp as wp

from gearsim.kernels.contact import may_meet
from gearsim.kernels.interval import IntervalLists, covers
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter, convex_part
from gearsim.kernels.sweep import cut_by_segment

f64 = wp.float64

wp.set_module_options({"enable_backward": False})

CAPSULE_PAD = wp.constant(wp.float32(1.0e-3))


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
    """Cut each ray by all segments whose bounds its window [tau_min, tau_max] meets, a convex part at a time."""
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
        for k in range(cutter.parts):
            part = convex_part(cutter, k)
            near = may_meet(part, motion, row, o, d)
            near_lo = wp.max(near[0], lo)
            near_hi = wp.min(near[1], hi)
            if near[0] <= near[1] and near_lo <= near_hi and not covers(lists_out, ray, near_lo, near_hi):
                pairs += 1
                status = status | cut_by_segment(part, motion, row, o, d, tolerance, bound, ray, lists_out)
    candidates_out[ray] = candidates
    pairs_out[ray] = pairs
    status_out[ray] = status
