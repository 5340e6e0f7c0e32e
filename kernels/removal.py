"""The removal kernel: every ray gathers the intervals that the segments near it sweep away."""

import warp as wp

from gearsim.kernels.cull import PAD, Groups, near_stretch
from gearsim.kernels.interval import IntervalLists, covers
from gearsim.kernels.options import OPTIONS
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter, Cutters, convex_part
from gearsim.kernels.standing import MORE_LATER, NOTHING_NEW, standing_of
from gearsim.kernels.sweep import STATUS_GAP_UNDECIDED, cut_by_segment
from gearsim.kernels.tool_ray import greater

f64 = wp.float64

wp.set_module_options(OPTIONS)

CAPSULE_PAD = wp.constant(wp.float32(1.0e-3))
CAPSULE_SHARE = wp.constant(wp.float32(1.0e-6))


@wp.func
def may_cut(
    cutter: Cutter, tip: wp.vec3d, axis: wp.vec3d, spread: f64, origin: wp.vec3d, direction: wp.vec3d,
    window: wp.vec2d, ray: int, lists: IntervalLists,
) -> bool:  # fmt: skip
    """Whether the cutter within ``spread`` [mm] of a pose may meet what the ray's list does not hold yet."""
    near = near_stretch(cutter, tip, axis, spread, origin, direction, window)
    return near[0] <= near[1] and not covers(lists, ray, near[0], near[1])


@wp.func
def extent_of(a: wp.vec3d, b: wp.vec3d) -> f64:
    """Bound of the coordinates [mm] on the way from a to b, three of them added."""
    sum = f64(0.0)
    for i in range(3):
        sum += greater(wp.abs(a[i]), wp.abs(b[i]))
    return sum


@wp.func
def cut_group(
    cutter: Cutter, motion: Motion, groups: Groups, first: int, end: int, step: int, origin: wp.vec3d,
    direction: wp.vec3d, window: wp.vec2d, tolerance: f64, ray: int, lists: IntervalLists,
) -> wp.vec2i:  # fmt: skip
    """Cut a ray by rows of a group, every ``step``-th from ``first`` on: how many were searched, and status bits.

    A row waits while the next one takes more, since few of those from ``held`` on are left to search once that is
    cut; ``front`` is as far as rows have been looked at. Rows that cannot reach what is left of the ray are skipped.
    """
    pairs = int(0)
    status = int(0)
    row = first
    front = first
    held = first
    while row < end:
        now = standing_of(cutter, motion, row, origin, direction, window, tolerance, ray, lists)
        if now.more == MORE_LATER and row == front and row + step < end:
            front += step
            row = front
            continue
        tip = motion.tip[row, 0]
        axis = motion.axis[row, 0]
        if now.more != NOTHING_NEW and may_cut(
            cutter, tip, axis, motion.speed[row], origin, direction, window, ray, lists
        ):
            pairs += 1
            status = status | cut_by_segment(cutter, motion, row, origin, direction, window, tolerance, ray, lists)
        if row == front:
            reach = groups.travel[row] + now.clear - PAD * cutter.size
            while front + step < end and groups.travel[front + step] + motion.speed[front + step] < reach:
                front += step
        if row > held:
            row -= step
        else:
            front += step
            row = front
            held = front
    return wp.vec2i(pairs, status)


@wp.kernel
def cut_rays(
    # cutter
    cutters: Cutters,
    # motion
    motion: Motion,
    groups: Groups,
    bvh: wp.uint64,
    tolerance: f64,
    # in
    first: int,
    origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d),
    tau_min: wp.array(dtype=f64),
    tau_max: wp.array(dtype=f64),
    job: wp.array(dtype=wp.int32),
    coarse: wp.array(dtype=wp.vec2i),
    # out
    lists_out: IntervalLists,
    candidates_out: wp.array(dtype=wp.int32),
    pairs_out: wp.array(dtype=wp.int32),
    status_out: wp.array(dtype=wp.int32),
):
    """Cut each ray by its job's segments whose bounds its window [tau_min, tau_max] meets, a convex part at a time.

    ``coarse`` of a job: its first row, and that every which row comes first, before all; those next to each other cut
    nearly alike, so that most find their part cut already. What a row may have taken too little of is told the last
    time alone, when all are looked at that may take more; what one may have taken too much of is never forgotten.
    """
    ray = first + wp.tid()
    o = origin[ray]
    d = direction[ray]
    window = wp.vec2d(tau_min[ray], tau_max[ray])
    root = wp.bvh_get_group_root(bvh, job[ray])
    if root < 0:
        return
    start = wp.vec3(o + window[0] * d)
    way = wp.vec3((window[1] - window[0]) * d)
    extent = extent_of(o + window[0] * d, o + window[1] * d)
    candidates = int(0)
    pairs = int(0)
    status = int(0)
    for p in range(cutters.job_first[job[ray]], cutters.job_first[job[ray] + 1]):
        part = convex_part(cutters, p, extent)
        pad = CAPSULE_PAD + CAPSULE_SHARE * wp.float32(extent)
        begin = coarse[job[ray]][0]
        step = coarse[job[ray]][1]
        told = int(0)
        while step > 0:
            candidates = int(0)
            told = told & STATUS_GAP_UNDECIDED
            query = wp.bvh_query_capsule(bvh, start, way, pad, root)
            group = int(0)
            while wp.bvh_query_next(query, group, wp.float32(1.0)):
                end = groups.first[group + 1]
                candidates += end - groups.first[group]
                row = begin + (groups.first[group] - begin + step - 1) // step * step
                tip = groups.tip[group]
                axis = groups.axis[group]
                if end - row > step and not may_cut(
                    part, tip, axis, groups.spread[group], o, d, window, ray, lists_out
                ):
                    row = end
                found = cut_group(part, motion, groups, row, end, step, o, d, window, tolerance, ray, lists_out)
                pairs += found[0]
                told = told | found[1]
            step = wp.where(step > 1, 1, 0)
        status = status | told
    candidates_out[ray] = candidates
    pairs_out[ray] = pairs
    status_out[ray] = status
