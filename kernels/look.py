"""What one pose of a cutter shows of a stretch of a ray: a hit, or a plane that keeps the two apart."""

import warp as wp

from gearsim.kernels.distance import surface_distance
from gearsim.kernels.pose import Motion, Pose, place_at
from gearsim.kernels.profile import Cutter, cutter_interval
from gearsim.kernels.support import apart, clearance, support_point
from gearsim.kernels.tool_ray import FAR, TINY, lesser, tool_ray

f64 = wp.float64


@wp.struct
class Look:
    """What one pose shows: a hit, or the normal n of a plane, how far that keeps the cutter from both ends of the
    stretch, and how far from its tip these are [mm].
    """

    hit: wp.int32
    x: f64
    axis: wp.vec3d
    n: wp.vec3d
    first: f64
    last: f64
    first_arm: f64
    last_arm: f64


@wp.func
def normal_towards(cutter: Cutter, pose: Pose, point: wp.vec3d) -> wp.vec3d:
    """Unit normal of the cutter's surface where it is nearest to a point outside it."""
    q = point - pose.tip
    z = wp.dot(q, pose.axis)
    w = q - z * pose.axis
    r = wp.length(w)
    d = surface_distance(cutter, r, z)
    if r < TINY:
        return pose.axis * wp.where(d[2] < f64(0.0), f64(-1.0), f64(1.0))
    out = w / r
    out = wp.normalize(out - (wp.dot(out, pose.axis) / wp.dot(pose.axis, pose.axis)) * pose.axis)
    return wp.normalize(d[1] * out + d[2] * pose.axis)


@wp.func
def nearest_along(cutter: Cutter, pose: Pose, n: wp.vec3d, origin: wp.vec3d, direction: wp.vec3d) -> f64:
    """Where along a ray the cutter's farthest point in direction n is."""
    along = wp.dot(n, pose.axis)
    across = n - along * pose.axis
    size = wp.length(across)
    p = support_point(cutter, size, along)
    q = pose.tip + p[1] * pose.axis - origin
    if size > TINY:
        q = q + (p[0] / size) * across
    return wp.dot(q, direction)


@wp.func
def look_at(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, stretch: wp.vec2d, x: f64,
    misses: int,
) -> Look:  # fmt: skip
    """See Look. ``misses`` 1: it is known that the ray does there."""
    pose = place_at(motion, row, x)
    look = look_along(pose, x, origin, direction, stretch)
    middle = FAR
    if misses == 0:
        ray = tool_ray(pose.tip, pose.axis, cutter.middle, origin, direction)
        chord = cutter_interval(cutter, ray)
        if chord.found == 1:
            if chord.lo + ray.shift <= stretch[1] and chord.hi + ray.shift >= stretch[0]:
                look.hit = 1
                return look
            middle = chord.lo + ray.shift
    look = with_plane(cutter, pose, origin, direction, stretch, look, apart(cutter, pose, origin, direction))
    if middle == FAR:
        middle = nearest_along(cutter, pose, look.n, origin, direction)
    end = wp.clamp(middle, stretch[0], stretch[1])
    if end == middle:
        return look
    n = normal_towards(cutter, pose, origin + end * direction)
    return with_plane(cutter, pose, origin, direction, stretch, look, n)


@wp.func
def glance_at(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, stretch: wp.vec2d, x: f64,
    n: wp.vec3d,
) -> Look:  # fmt: skip
    """The same with a plane that is given, and no word on whether the cutter is hit."""
    pose = place_at(motion, row, x)
    look = look_along(pose, x, origin, direction, stretch)
    return with_plane(cutter, pose, origin, direction, stretch, look, n)


@wp.func
def look_along(pose: Pose, x: f64, origin: wp.vec3d, direction: wp.vec3d, stretch: wp.vec2d) -> Look:
    """A look without a plane."""
    look = Look()
    look.x = x
    look.axis = pose.axis
    look.first = -FAR
    look.last = -FAR
    look.first_arm = wp.length(origin + stretch[0] * direction - pose.tip)
    look.last_arm = wp.length(origin + stretch[1] * direction - pose.tip)
    return look


@wp.func
def with_plane(
    cutter: Cutter, pose: Pose, origin: wp.vec3d, direction: wp.vec3d, stretch: wp.vec2d, look: Look, n: wp.vec3d
) -> Look:  # fmt: skip
    """The look, or the same with another plane if that keeps the cutter farther away."""
    first = clearance(cutter, pose, origin + stretch[0] * direction, n)
    last = first + (stretch[1] - stretch[0]) * wp.dot(n, direction)
    if lesser(first, last) > lesser(look.first, look.last):
        look.n = n
        look.first = first
        look.last = last
    return look
