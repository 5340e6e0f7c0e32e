"""The poses that come closest to rays, and those that hold the machined surface on them: where to start looking."""

import warp as wp

from gearsim.kernels.approach import distance_at, distance_rate
from gearsim.kernels.crossing import Rays
from gearsim.kernels.exact_pose import ExactMotion, exact_pose
from gearsim.kernels.meridian import Meridian, meridian_distance

f64 = wp.float64

HALVINGS = wp.constant(40)
GRAZES = wp.constant(f64(0.05))
TINY = wp.constant(f64(1.0e-300))
FAR = wp.constant(f64(1.0e300))

wp.set_module_options({"enable_backward": False})


@wp.struct
class Samples:
    """Poses of a motion: tip, axis, and where they are, ``piece`` and ``t``; they lie ``apart`` in t."""

    tip: wp.array(dtype=wp.vec3d)
    axis: wp.array(dtype=wp.vec3d)
    piece: wp.array(dtype=wp.int32)
    t: wp.array(dtype=f64)
    apart: f64


@wp.func
def closest_sample(meridian: Meridian, samples: Samples, point: wp.vec3d) -> int:
    """The sampled pose whose tool is closest to a point."""
    nearest = int(0)
    least = FAR
    for k in range(samples.piece.shape[0]):
        distance = distance_at(meridian, point, samples.tip[k], samples.axis[k])
        if distance < least:
            least = distance
            nearest = k
    return nearest


@wp.func
def closest_moment(motion: ExactMotion, meridian: Meridian, point: wp.vec3d, piece: int, t: f64, apart: f64) -> f64:
    """When on its piece, within ``apart`` of t, the tool comes closest to a point: where its approach ends."""
    early = wp.max(t - apart, f64(0.0))
    late = wp.min(t + apart, f64(1.0))
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
    samples: Samples,
    rays: Rays,
    turns: int,
    # out
    first_out: wp.array(dtype=wp.int32),
    piece_out: wp.array(dtype=wp.int32),
    t_out: wp.array(dtype=f64),
    tau_out: wp.array(dtype=f64),
):
    """The sample closest to each ray's origin; the pose that holds the machined surface on it, and where [mm]."""
    i = wp.tid()
    origin = rays.origin[i]
    direction = rays.direction[i]
    tau = f64(0.0)
    nearest = closest_sample(meridian, samples, origin)
    first_out[i] = nearest
    tip = samples.tip[nearest]
    axis = samples.axis[nearest]
    t = samples.t[nearest]
    for _ in range(turns - 1):
        tau += way_left(meridian, origin + tau * direction, direction, tip, axis)
        tau = wp.clamp(tau, rays.start[i], rays.end[i])
        point = origin + tau * direction
        nearest = closest_sample(meridian, samples, point)
        t = closest_moment(motion, meridian, point, samples.piece[nearest], samples.t[nearest], samples.apart)
        pose = exact_pose(motion, samples.piece[nearest], t)
        tip = pose.tip
        axis = pose.axis
    piece_out[i] = samples.piece[nearest]
    t_out[i] = t
    tau_out[i] = tau
