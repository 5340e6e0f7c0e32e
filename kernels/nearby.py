"""Which samples of a motion lie near points: the nearest poses of circles, and the nearest of a cloud of points."""

import warp as wp

from gearsim.kernels.approach import FAR
from gearsim.kernels.options import OPTIONS

f64 = wp.float64

wp.set_module_options(OPTIONS)


@wp.kernel
def nearest_circles(
    tip: wp.array(dtype=wp.vec3d),
    axis: wp.array(dtype=wp.vec3d),
    radius: wp.array(dtype=f64),
    height: wp.array(dtype=f64),
    points: wp.array(dtype=wp.vec3d),
    reach: wp.array(dtype=f64),
    # out
    pose_out: wp.array2d(dtype=wp.int32),
):
    """For each point (i) and circle about the axis (j) the pose at which it is nearest; -1 where beyond reach."""
    i, j = wp.tid()
    least = reach[i] * reach[i]
    nearest = int(-1)
    for k in range(tip.shape[0]):
        q = points[i] - tip[k]
        z = wp.dot(q, axis[k])
        out = wp.sqrt(wp.max(wp.dot(q, q) - z * z, f64(0.0))) - radius[j]
        up = z - height[j]
        apart = out * out + up * up
        if apart <= least:
            least = apart
            nearest = k
    pose_out[i, j] = nearest


@wp.struct
class Cloud:
    """Points in groups of ``size``, the last ones smaller; group g lies within ``spread[g]`` of ``middle[g]``."""

    points: wp.array(dtype=wp.vec3d)
    size: wp.int32
    middle: wp.array(dtype=wp.vec3d)
    spread: wp.array(dtype=f64)


@wp.func
def nearest_in_group(cloud: Cloud, g: int, p: wp.vec3d, best: wp.vec2d) -> wp.vec2d:
    """The nearer of the nearest known point (distance, number) and those of a group."""
    end = wp.min((g + 1) * cloud.size, cloud.points.shape[0])
    for k in range(g * cloud.size, end):
        d = wp.length(cloud.points[k] - p)
        if d < best[0]:
            best = wp.vec2d(d, f64(k))
    return best


@wp.kernel
def nearest_of_cloud(
    cloud: Cloud,
    points: wp.array(dtype=wp.vec3d),
    reach: wp.array(dtype=f64),
    # out
    nearest_out: wp.array(dtype=wp.int32),
):
    """The nearest point of a cloud within each point's reach, -1 where there is none."""
    i = wp.tid()
    p = points[i]
    first = int(-1)
    least = FAR
    for g in range(cloud.middle.shape[0]):
        d = wp.length(cloud.middle[g] - p)
        if d < least:
            least = d
            first = g
    best = wp.vec2d(reach[i], f64(-1.0))
    if first >= 0:
        best = nearest_in_group(cloud, first, p, best)
    for g in range(cloud.middle.shape[0]):
        if g != first and wp.length(cloud.middle[g] - p) - cloud.spread[g] < best[0]:
            best = nearest_in_group(cloud, g, p, best)
    nearest_out[i] = int(best[1])
