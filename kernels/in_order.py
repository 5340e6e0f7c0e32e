"""The removal kernel that keeps a program's order: what every row takes from what the rows before it have left."""

import warp as wp

from gearsim.kernels.cull import Groups
from gearsim.kernels.interval import IntervalLists
from gearsim.kernels.material import Material
from gearsim.kernels.options import OPTIONS
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutters, convex_part
from gearsim.kernels.removal import CAPSULE_PAD, CAPSULE_SHARE, extent_of, may_cut
from gearsim.kernels.sweep import cut_by_segment

f64 = wp.float64
f32 = wp.float32

wp.set_module_options(OPTIONS)

SEEN = wp.constant(f64(4.0))  # ends within tolerance: what two of them differ by is nothing taken


@wp.struct
class RowTree:
    """Groups of rows under boxes of boxes, a binary tree written down before its branches, the earlier branch first.

    A node's branches follow it up to the node ``after``; ``group`` of a leaf is its group, -1 elsewhere. Boxes [mm] are
    those of the tool all along the rows, float32, rounded outward.
    """

    lower: wp.array(dtype=wp.vec3)
    upper: wp.array(dtype=wp.vec3)
    after: wp.array(dtype=wp.int32)
    group: wp.array(dtype=wp.int32)


@wp.func
def meets_box(tree: RowTree, node: int, start: wp.vec3, way: wp.vec3, pad: f32) -> bool:
    """Whether the straight way from a start comes within ``pad`` of a node's box; in doubt it does."""
    low = f32(0.0)
    high = f32(1.0)
    for k in range(3):
        below = tree.lower[node][k] - pad - start[k]
        above = tree.upper[node][k] + pad - start[k]
        if wp.abs(way[k]) <= pad:
            if below > pad or above < -pad:
                return False
        else:
            a = below / way[k]
            b = above / way[k]
            low = wp.max(low, wp.min(a, b))
            high = wp.min(high, wp.max(a, b))
    return low <= high + f32(1.0e-5)


@wp.func
def taken(lists: IntervalLists, material: Material, ray: int) -> f64:
    """Length [mm] of what a ray's list takes from its material."""
    sum = f64(0.0)
    for j in range(int(material.first[ray]), int(material.first[ray + 1])):
        for k in range(lists.count[ray]):
            lo = wp.max(lists.lo[ray, k], material.lo[j])
            hi = wp.min(lists.hi[ray, k], material.hi[j])
            sum += wp.max(hi - lo, f64(0.0))
    return sum


@wp.kernel
def cut_in_order(
    # cutter
    cutters: Cutters,
    # motion
    motion: Motion,
    groups: Groups,
    tree: RowTree,
    tolerance: f64,
    # in
    first: int,
    worker: int,
    origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d),
    tau_min: wp.array(dtype=f64),
    tau_max: wp.array(dtype=f64),
    material: Material,
    # out
    lists_out: IntervalLists,
    length_out: wp.array2d(dtype=f64),
    status_out: wp.array(dtype=wp.int32),
):
    """Cut each ray by one cutter's rows, first to last, in its window [tau_min, tau_max].

    ``length_out``, shape (workers, rows): length [mm] of material, all rays together, that a row is the first to take.
    """
    ray = first + wp.tid()
    o = origin[ray]
    d = direction[ray]
    window = wp.vec2d(tau_min[ray], tau_max[ray])
    if window[0] >= window[1]:
        return
    start = wp.vec3(o + window[0] * d)
    way = wp.vec3((window[1] - window[0]) * d)
    extent = extent_of(o + window[0] * d, o + window[1] * d)
    pad = CAPSULE_PAD + CAPSULE_SHARE * f32(extent)
    before = f64(0.0)
    status = int(0)
    node = int(0)
    while node < tree.after[0]:
        if not meets_box(tree, node, start, way, pad):
            node = tree.after[node]
            continue
        group = tree.group[node]
        node += 1
        if group < 0:
            continue
        near = int(0)
        for p in range(cutters.job_first[0], cutters.job_first[1]):
            part = convex_part(cutters, p, extent)
            spread = groups.spread[group]
            if may_cut(part, groups.tip[group], groups.axis[group], spread, o, d, window, ray, lists_out):
                near = 1
        if near == 0:
            continue
        for row in range(groups.first[group], groups.first[group + 1]):
            tip = motion.tip[row, 0]
            axis = motion.axis[row, 0]
            for p in range(cutters.job_first[0], cutters.job_first[1]):
                part = convex_part(cutters, p, extent)
                if may_cut(part, tip, axis, motion.speed[row], o, d, window, ray, lists_out):
                    status = status | cut_by_segment(part, motion, row, o, d, window, tolerance, ray, lists_out)
            now = taken(lists_out, material, ray)
            if now > before + SEEN * tolerance:
                wp.atomic_add(length_out, worker, row, now - before)
                before = now
    status_out[ray] = status
