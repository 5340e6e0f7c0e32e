"""The poses that come closest to rays, and those that hold the machined surface on them: where to start looking."""

import warp as wp

from gearsim.kernels.approach import DEEP, FAR, Stretches, distance_at, distance_rate
from gearsim.kernels.crossing import Rays
from gearsim.kernels.exact_pose import ExactMotion, exact_pose
from gearsim.kernels.meridian import Meridian, meridian_distance
from gearsim.kernels.options import OPTIONS

f64 = wp.float64

HALVINGS = wp.constant(40)
GRAZES = wp.constant(f64(0.05))
TINY = wp.constant(f64(1.0e-300))
STILL = wp.constant(f64(1.0e-10))

wp.set_module_options(OPTIONS)


@wp.func
def closest_leaf(meridian: Meridian, stretches: Stretches, point: wp.vec3d) -> int:
    """The stretch in whose middle the tool is closest to a point."""
    node = wp.zeros(shape=(DEEP,), dtype=wp.int32)
    bound = wp.zeros(shape=(DEEP,), dtype=f64)
    leaves = stretches.piece.shape[0]
    nearest = int(0)
    least = FAR
    node[0] = 1
    bound[0] = -FAR
    top = int(1)
    while top > 0:
        top -= 1
        i = node[top]
        if bound[top] >= least:
            continue
        if i >= leaves:
            distance = distance_at(meridian, point, stretches.tip[i], stretches.axis[i])
            if distance < least:
                least = distance
                nearest = i - leaves
            continue
        near = int(2 * i)
        far = near + 1
        near_bound = distance_at(meridian, point, stretches.tip[near], stretches.axis[near]) - stretches.spread[near]
        far_bound = distance_at(meridian, point, stretches.tip[far], stretches.axis[far]) - stretches.spread[far]
        node[top] = far
        bound[top] = far_bound
        node[top + 1] = near
        bound[top + 1] = near_bound
        if far_bound < near_bound:  # the nearer one is looked at first
            node[top] = near
            bound[top] = near_bound
            node[top + 1] = far
            bound[top + 1] = far_bound
        top += 2
    return nearest


@wp.func
def closest_moment(
    motion: ExactMotion, meridian: Meridian, point: wp.vec3d, piece: int, middle_t: f64, apart: f64
) -> f64:  # fmt: skip
    """When on its piece, within ``apart`` of a moment, the tool comes closest to a point: where its approach ends."""
    early = wp.max(middle_t - apart, f64(0.0))
    late = wp.min(middle_t + apart, f64(1.0))
    for _ in range(HALVINGS):
        middle = f64(0.5) * (early + late)
        rate = distance_rate(meridian, point, exact_pose(motion, piece, middle))
        if rate[1] < f64(0.0):
            early = middle
        else:
            late = middle
    return f64(0.5) * (early + late)


@wp.func
def way_left(meridian: Meridian, point: wp.vec3d, direction: wp.vec3d, tip: wp.vec3d, axis: wp.vec3d) -> f64:
    """How far along the ray the surface should be by the distance and its slope; the distance where it grazes."""
    q = point - tip
    z = wp.dot(q, axis)
    w = q - z * axis
    r = wp.length(w)
    out = meridian_distance(meridian, r, z)
    slope = wp.dot(out[1] / wp.max(r, TINY) * w + out[2] * axis, direction)
    if slope < -GRAZES:
        return -out[0] / slope
    return out[0]


@wp.kernel
def pursue(
    motion: ExactMotion,
    meridian: Meridian,
    stretches: Stretches,
    rays: Rays,
    turns: int,
    # out
    first_piece_out: wp.array(dtype=wp.int32),
    first_t_out: wp.array(dtype=f64),
    piece_out: wp.array(dtype=wp.int32),
    t_out: wp.array(dtype=f64),
    tau_out: wp.array(dtype=f64),
):
    """Roughly the pose closest to each ray's origin; the one that holds the machined surface on it, and where [mm]."""
    i = wp.tid()
    origin = rays.origin[i]
    direction = rays.direction[i]
    tau = f64(0.0)
    leaf = closest_leaf(meridian, stretches, origin)
    t = f64(0.5) * (stretches.start[leaf] + stretches.end[leaf])
    first_piece_out[i] = stretches.piece[leaf]
    first_t_out[i] = t
    pose = exact_pose(motion, stretches.piece[leaf], t)
    moved = f64(1.0)
    turn = int(1)
    while turn < turns and moved > STILL:
        onward = tau + way_left(meridian, origin + tau * direction, direction, pose.tip, pose.axis)
        onward = wp.clamp(onward, rays.start[i], rays.end[i])
        moved = wp.abs(onward - tau)
        tau = onward
        point = origin + tau * direction
        leaf = closest_leaf(meridian, stretches, point)
        apart = stretches.end[leaf] - stretches.start[leaf]
        middle = stretches.start[leaf] + f64(0.5) * apart
        t = closest_moment(motion, meridian, point, stretches.piece[leaf], middle, apart)
        pose = exact_pose(motion, stretches.piece[leaf], t)
        turn += 1
    piece_out[i] = stretches.piece[leaf]
    t_out[i] = t
    tau_out[i] = tau
