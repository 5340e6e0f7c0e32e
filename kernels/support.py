"""How far a plane keeps the cutter at one pose from a ray, and the plane that keeps it farthest.

For a unit vector n, a point p and the support function H of the cutter, n . (p - tip) - H(n . axis) is no more than
the distance of p to the cutter.
"""

import warp as wp

from gearsim.kernels.pose import Pose, perpendicular
from gearsim.kernels.profile import LINE, Cutter
from gearsim.kernels.tool_ray import FAR, TINY, greater, lesser

f64 = wp.float64

TURNS = wp.constant(60)
HALF_TURN = wp.constant(f64(3.141592653589793))


@wp.func
def support_point(cutter: Cutter, across: f64, along: f64) -> wp.vec2d:
    """The part's point (r, z) that is farthest in a direction with these components across and along the axis."""
    best = -FAR
    at_r = f64(0.0)
    at_z = f64(0.0)
    scale = f64(1.0) / greater(wp.sqrt(across * across + along * along), TINY)
    for k in range(cutter.first, cutter.end):
        z0 = cutter.slabs[k, 0]
        z1 = cutter.slabs[k, 1]
        r = cutter.slabs[k, 2]
        z = z0
        if cutter.slabs[k, 5] == LINE:
            upper = r + cutter.slabs[k, 3] * (z1 - z0)
            if upper * across + z1 * along > r * across + z0 * along:
                r = upper
                z = z1
        else:
            rho = cutter.slabs[k, 4]
            z = wp.clamp(cutter.slabs[k, 3] + rho * along * scale, z0, z1)
            rise = z - cutter.slabs[k, 3]
            r = greater(r + wp.sqrt(greater(rho * rho - rise * rise, f64(0.0))), f64(0.0))
        far = r * across + z * along
        if far > best:
            best = far
            at_r = r
            at_z = z
    return wp.vec2d(at_r, at_z)


@wp.struct
class Facing:
    """How far a ray passes the cutter in the direction at ``angle`` from the axis as seen along the ray [mm], and
    that distance's derivative.

    The distance is concave where it is positive. Where it is not, only the derivative's sign counts: it shows
    the way to where it is, if that is anywhere.
    """

    angle: f64
    value: f64
    slope: f64


@wp.func
def facing(cutter: Cutter, ahead: f64, aside: f64, lean: f64, rise: f64, angle: f64) -> Facing:
    """See Facing. The ray is at (ahead, aside) from the tip along the axis and across it, as seen along the ray;
    ``lean`` and ``rise`` are the sine and cosine between ray and axis.

    A direction in which the ray passes the whole cutter leads from every point of it towards the ray: where
    the farthest point lies farther aside than the ray does, only ahead or behind of it.
    """
    cosine = wp.cos(angle)
    sine = wp.sin(angle)
    along = lean * cosine
    across = greater(wp.sqrt(sine * sine + rise * rise * cosine * cosine), TINY)
    p = support_point(cutter, across, along)
    f = Facing()
    f.angle = angle
    f.value = ahead * cosine + aside * sine - p[0] * across - p[1] * along
    turn = lean * sine
    f.slope = aside * cosine - ahead * sine + p[1] * turn - p[0] * turn * along / across
    if f.value <= f64(0.0) and aside * across < p[0] * sine:
        far_ahead = p[1] * lean + p[0] * cosine * rise * rise / across
        f.slope = wp.where(ahead > far_ahead, -wp.abs(f.slope), wp.abs(f.slope) + TINY)
    return f


@wp.func
def between(a: Facing, b: Facing, turn: int) -> f64:
    """Where to look next for the maximum between a, where it rises, and b, where it falls."""
    width = b.angle - a.angle
    angle = f64(0.5) * (a.angle + b.angle)
    if turn % 3 == 0:
        angle = a.angle + (b.value - a.value - b.slope * width) / greater(a.slope - b.slope, TINY)
    elif turn % 3 == 1:
        angle = a.angle + width * a.slope / greater(a.slope - b.slope, TINY)
    if angle <= a.angle or angle >= b.angle:
        angle = f64(0.5) * (a.angle + b.angle)
    return angle


@wp.func
def apart(cutter: Cutter, pose: Pose, origin: wp.vec3d, direction: wp.vec3d) -> wp.vec3d:
    """Unit vector across a ray that misses the cutter, along which the two are farthest apart.

    Seen along the ray, the cutter is a convex figure and the ray a point. Two tangents to a concave function
    close in on its maximum, in one step where that is a corner.
    """
    q = origin - pose.tip
    rise = wp.dot(pose.axis, direction)
    upright = pose.axis - rise * direction
    lean = wp.length(upright)
    if lean < TINY:
        upright = perpendicular(direction)
    upright = wp.normalize(upright)
    upright = wp.normalize(upright - wp.dot(upright, direction) * direction)
    sideways = wp.cross(direction, upright)
    ahead = wp.dot(q, upright)
    aside = wp.dot(q, sideways)
    if aside < f64(0.0):
        aside = -aside
        sideways = -sideways
    a = facing(cutter, ahead, aside, lean, rise, f64(0.0))
    b = facing(cutter, ahead, aside, lean, rise, HALF_TURN)
    best = a
    if b.value > a.value:
        best = b
    step = int(0)
    while step < TURNS:
        f = facing(cutter, ahead, aside, lean, rise, between(a, b, step))
        if f.value > best.value:
            best = f
        if f.slope > f64(0.0):
            a = f
        else:
            b = f
        top = FAR
        if a.value > f64(0.0):
            top = a.value + a.slope * (b.angle - a.angle)
        if b.value > f64(0.0):
            top = lesser(top, b.value - b.slope * (b.angle - a.angle))
        if b.angle - a.angle < f64(1.0e-15) or top - best.value < f64(1.0e-15) * cutter.size:
            break
        step += 1
    n = wp.cos(best.angle) * upright + wp.sin(best.angle) * sideways
    return wp.normalize(n - wp.dot(n, direction) * direction)


@wp.func
def from_axis(cutter: Cutter, pose: Pose, origin: wp.vec3d, direction: wp.vec3d) -> wp.vec3d:
    """Unit vector across a ray, from where the cutter's axis is closest to it: ``apart`` but for slopes and rims."""
    bottom = cutter.slabs[cutter.first, 0]
    if cutter.slabs[cutter.first, 5] != LINE:
        bottom = cutter.slabs[cutter.first, 3]
    rise = wp.dot(pose.axis, direction)
    q = origin - pose.tip
    q = q - wp.dot(q, direction) * direction
    upright = pose.axis - rise * direction
    z = wp.dot(q, upright) / greater(wp.dot(upright, upright), TINY)
    q = q - wp.clamp(z, bottom, cutter.slabs[cutter.end - 1, 1]) * upright
    size = wp.length(q)
    if size < TINY:
        return perpendicular(direction)
    return q / size


@wp.func
def clearance(cutter: Cutter, place: Pose, point: wp.vec3d, n: wp.vec3d) -> f64:
    """How far the cutter stays behind the plane through a point with unit normal n [mm].

    The table's axis has length 1 but for the table's error; lengths are divided by it as in ``tool_ray``.
    """
    along = wp.dot(n, place.axis) / wp.dot(place.axis, place.axis)
    across = wp.length(n - along * place.axis)
    p = support_point(cutter, across, along)
    return wp.dot(n, point - place.tip) - p[0] * across - p[1] * along
