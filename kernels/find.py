"""Whether the cutter meets a stretch of a ray anywhere between two poses of a row: a pose that does, or the certainty
that none does.

The poses are walked through from one end to the other, step by step. Wherever the cutter misses, a plane with
normal n keeps it away from both ends p of the stretch, by n . (p - tip) - H(n), H being the cutter's support
function. Over a step let n change evenly from that of its one end to that of the other. H is convex in n as the tool
sees it, so in between the clearance is above what lies evenly between that of the two ends, less
C (x - x1) (x2 - x) / 2. With the rates v of the tip and w of the axis, and the cutter's reach R, C is
    |n . tip''| + 2 |n' . tip'| + R (w² + |axis''| + 2 w |n'|)            where n changes evenly in space, or
    |tip''| + 2 w v + |p - tip| (w² + |axis''|) + 2 |n'| (v + w |p - tip|)  where it does as the tool sees it,
whichever proves more. A step of which that is not certain is halved, and the next one is twice as long. It holds at
kinks (edges, flat faces) too, and the clearance may have any number of minima, touch zero, or stay there.
"""

import warp as wp

from gearsim.kernels.distance import surface_distance
from gearsim.kernels.pose import Motion, Pose, pose_at
from gearsim.kernels.profile import Cutter, cutter_interval
from gearsim.kernels.support import apart, clearance, support_point
from gearsim.kernels.tool_ray import FAR, TINY, greater, lesser, tool_ray

f64 = wp.float64

FIND_LOOKS = wp.constant(10000)
NARROWEST = wp.constant(f64(1.0e-14))
NONE = wp.constant(0)
HIT = wp.constant(1)
LOST = wp.constant(2)


@wp.struct
class Find:
    """Outcome of a search (NONE, HIT, LOST: looks used up) and the pose that hits."""

    outcome: wp.int32
    x: f64


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
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, stretch: wp.vec2d, x: f64
) -> Look:  # fmt: skip
    """See Look."""
    pose = pose_at(motion, row, x)
    ray = tool_ray(pose.tip, pose.axis, cutter.middle, origin, direction)
    chord = cutter_interval(cutter, ray)
    look = Look()
    look.x = x
    look.axis = pose.axis
    look.first_arm = wp.length(origin + stretch[0] * direction - pose.tip)
    look.last_arm = wp.length(origin + stretch[1] * direction - pose.tip)
    if chord.found == 1 and chord.lo + ray.shift <= stretch[1] and chord.hi + ray.shift >= stretch[0]:
        look.hit = 1
        return look
    look.first = -FAR
    look = with_plane(cutter, pose, origin, direction, stretch, look, apart(cutter, pose, origin, direction))
    nearest = nearest_along(cutter, pose, look.n, origin, direction)
    if chord.found == 1:
        nearest = chord.lo + ray.shift
    end = wp.clamp(nearest, stretch[0], stretch[1])
    if end == nearest:
        return look
    n = normal_towards(cutter, pose, origin + end * direction)
    return with_plane(cutter, pose, origin, direction, stretch, look, n)


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


@wp.func
def least_of(first: f64, last: f64, sag: f64) -> f64:
    """Least value of a parabola between two values, which ``sag`` takes off their mean in the middle."""
    change = last - first
    if wp.abs(change) >= f64(4.0) * sag:
        return lesser(first, last)
    return f64(0.5) * (first + last) - change * change / (f64(16.0) * sag) - sag


@wp.func
def least_of_both(a: Look, b: Look, first_sag: f64, last_sag: f64) -> f64:
    """Lower bound over a step for both ends of the stretch, which one plane must keep the cutter from."""
    return lesser(least_of(a.first, b.first, first_sag), least_of(a.last, b.last, last_sag))


@wp.func
def turned(v: wp.vec3d, a: wp.vec3d, b: wp.vec3d) -> wp.vec3d:
    """A vector turned as the shortest turn from unit vector a to b does, less than half a turn."""
    return v - (wp.dot(v, a + b) / (f64(1.0) + wp.dot(a, b))) * (a + b) + f64(2.0) * wp.dot(v, a) * b


@wp.func
def least_clearance(cutter: Cutter, motion: Motion, row: int, a: Look, b: Look) -> f64:
    """Certain lower bound of the cutter's clearance from a stretch between two poses; see above."""
    width = b.x - a.x
    reach = f64(0.5) * cutter.size
    spin = motion.spin[row]
    v = motion.speed[row] - spin * reach
    n_rate = (b.n - a.n) / width
    seen_rate = wp.length(turned(b.n, b.axis, a.axis) - a.n) / width
    turning = spin * spin
    in_space = f64(0.0)
    seen = f64(2.0) * v * (spin + seen_rate)
    for k in range(1, 6):
        tip = motion.tip[row, k]
        bend = f64(k * (k - 1))
        turning += bend * wp.length(motion.axis[row, k])
        seen += bend * wp.length(tip)
        in_space += bend * greater(wp.abs(wp.dot(a.n, tip)), wp.abs(wp.dot(b.n, tip)))
        in_space += f64(2 * k) * wp.abs(wp.dot(n_rate, tip))
    in_space += reach * (turning + f64(2.0) * spin * wp.length(n_rate))
    turning += f64(2.0) * spin * seen_rate
    part = f64(0.125) * width * width
    first_arm = lesser(a.first_arm, b.first_arm) + v * width
    last_arm = lesser(a.last_arm, b.last_arm) + v * width
    fixed = least_of_both(a, b, part * in_space, part * in_space)
    return greater(fixed, least_of_both(a, b, part * (seen + first_arm * turning), part * (seen + last_arm * turning)))


@wp.func
def find_pose(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    from_x: f64, to_x: f64, stretch: wp.vec2d,
) -> Find:  # fmt: skip
    """A pose in [from_x, to_x] at which the cutter meets a stretch of a ray, or the certainty that there is none.

    What is passed over as a miss is cut no deeper than a few times the rounding of the coordinates.
    """
    find = Find()
    here = Look()
    x = from_x
    looks = int(0)
    while looks < FIND_LOOKS:
        ahead = look_at(cutter, motion, row, origin, direction, stretch, x)
        looks += 1
        if ahead.hit == 1:
            find.outcome = HIT
            find.x = x
            return find
        if looks == 1:
            here = ahead
            x = to_x
            continue
        width = ahead.x - here.x
        if least_clearance(cutter, motion, row, here, ahead) >= f64(-2.0) * cutter.skin:
            if ahead.x >= to_x:
                return find
            here = ahead
            x = wp.min(to_x, ahead.x + f64(2.0) * width)
        else:
            x = f64(0.5) * (here.x + ahead.x)
            if width < NARROWEST:
                break
    find.outcome = LOST
    return find
