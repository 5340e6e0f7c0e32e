"""Closed forms of a ray seen from a tool at rest: against a frustum, a ball, a disc rounded by a ball."""

import warp as wp

f64 = wp.float64

FAR = wp.constant(f64(1.0e30))
TINY = wp.constant(f64(1.0e-14))
# what is less than this divides to beyond FAR; between it and TINY a rate still counts over a long tool
NOTHING = wp.constant(f64(1.0e-60))
NEWTON_STEPS = wp.constant(60)


@wp.func
def lesser(a: f64, b: f64) -> f64:
    """The lesser of two numbers; wp.min also weighs what to do with nan, at twice the price."""
    return wp.where(a < b, a, b)


@wp.func
def greater(a: f64, b: f64) -> f64:
    """The greater of two numbers."""
    return wp.where(a > b, a, b)


@wp.struct
class ToolRay:
    """A ray seen from the tool: x - tip = z l + w, with z = z0 + tau dz and w = w0 + tau w1.

    tau counts from the ray's point ``shift``, which is closest to the tool's middle: far origins cost no
    digits. |w|² = base + 2 tau half + tau² square.
    """

    shift: f64
    z0: f64
    dz: f64
    w0: wp.vec3d
    w1: wp.vec3d
    base: f64
    half: f64
    square: f64


@wp.func
def tool_ray(tip: wp.vec3d, axis: wp.vec3d, middle: f64, origin: wp.vec3d, direction: wp.vec3d) -> ToolRay:
    """The ray seen from a tool at rest, whose middle is ``middle`` [mm] from its tip."""
    q = origin - tip
    ray = ToolRay()
    ray.dz = wp.dot(direction, axis)
    ray.shift = middle * ray.dz - wp.dot(q, direction)
    q = q + ray.shift * direction
    ray.z0 = wp.dot(q, axis)
    ray.w0 = q - ray.z0 * axis
    ray.w1 = direction - ray.dz * axis
    ray.base = wp.dot(ray.w0, ray.w0)
    ray.half = wp.dot(ray.w0, ray.w1)
    ray.square = wp.dot(ray.w1, ray.w1)
    return ray


@wp.func
def line_interval(ray: ToolRay, radius: f64, slope: f64, z_base: f64, lo: f64, hi: f64) -> wp.vec2d:
    """Part of [lo, hi] with |w| <= radius + slope (z - z_base); empty as (1, 0)."""
    edge = radius + slope * (ray.z0 - z_base)
    edge_rate = slope * ray.dz
    a = ray.square - edge_rate * edge_rate
    b = ray.half - edge * edge_rate
    c = ray.base - edge * edge
    if wp.abs(a) < NOTHING:
        a = NOTHING
    disc = b * b - a * c
    if disc <= f64(0.0):
        if a > f64(0.0):
            return wp.vec2d(f64(1.0), f64(0.0))
        return wp.vec2d(lo, hi)
    root = wp.sqrt(disc)
    q = -(b + root)
    if b < f64(0.0):
        q = root - b
    t1 = q / a
    t2 = f64(0.0)
    if q != f64(0.0):
        t2 = c / q
    first = lesser(t1, t2)
    last = greater(t1, t2)
    if a > f64(0.0):
        return wp.vec2d(greater(lo, first), lesser(hi, last))
    if edge_rate < f64(0.0):
        return wp.vec2d(lo, lesser(hi, first))
    return wp.vec2d(greater(lo, last), hi)


@wp.func
def cone_interval(ray: ToolRay, radius: f64, slope: f64, z_base: f64, lo: f64, hi: f64) -> wp.vec2d:
    """As ``line_interval``, keeping all digits near the apex if (radius, z_base) is the frustum's end on that side."""
    near = ray
    shift = f64(0.0)
    edge = radius + slope * (ray.z0 - z_base)
    if greater(ray.base, edge * edge) > f64(16.0) * radius * radius and slope != f64(0.0):
        shift = (z_base - ray.z0) * ray.dz - ray.half
        near.z0 = ray.z0 + shift * ray.dz
        near.w0 = ray.w0 + shift * ray.w1
        near.base = wp.dot(near.w0, near.w0)
        near.half = wp.dot(near.w0, near.w1)
    part = line_interval(near, radius, slope, z_base, lo - shift, hi - shift)
    if part[0] > part[1]:
        return part
    first = wp.where(part[0] == lo - shift, lo, part[0] + shift)
    last = wp.where(part[1] == hi - shift, hi, part[1] + shift)
    return wp.vec2d(first, last)


@wp.func
def puck_distance(ray: ToolRay, centre_r: f64, centre_z: f64, radius: f64, tau: f64) -> wp.vec2d:
    """Distance of the ray's point to a disc rounded by a ball, and its derivative; convex along the ray.

    A centre beyond the axis (centre_r < 0) gives the spindle that the arc's turning about the axis encloses.
    """
    w = ray.w0 + tau * ray.w1
    r = wp.length(w)
    z = ray.z0 + tau * ray.dz - centre_z
    out = r - centre_r
    if out <= f64(0.0):
        rate = ray.dz
        if z < f64(0.0):
            rate = -ray.dz
        return wp.vec2d(wp.abs(z) - radius, rate)
    length = wp.sqrt(out * out + z * z)
    if length < TINY:
        return wp.vec2d(length - radius, f64(0.0))
    if r < TINY:
        return wp.vec2d(length - radius, z * ray.dz / length)
    return wp.vec2d(length - radius, (out * wp.dot(w, ray.w1) / r + z * ray.dz) / length)


@wp.func
def puck_end(
    ray: ToolRay, centre_r: f64, centre_z: f64, radius: f64, start: f64, stop: f64, close: f64
) -> f64:  # fmt: skip
    """First tau from ``start`` on within ``close`` of the puck, or FAR; Newton's method from outside is monotone."""
    tau = start
    forward = f64(1.0)
    if stop < start:
        forward = f64(-1.0)
    step = int(0)
    while step < NEWTON_STEPS:
        d = puck_distance(ray, centre_r, centre_z, radius, tau)
        if d[0] <= close:
            return tau
        rate = d[1] * forward
        if rate >= f64(0.0):
            return FAR
        move = -d[0] / rate
        if tau + forward * move == tau:
            return tau
        tau += forward * move
        if (stop - tau) * forward < f64(0.0):
            return FAR
        step += 1
    return tau


@wp.func
def ball_interval(ray: ToolRay, centre_z: f64, radius: f64, lo: f64, hi: f64) -> wp.vec2d:
    """Part of [lo, hi] inside a ball on the axis; empty as (1, 0)."""
    z = ray.z0 - centre_z
    b = ray.half + z * ray.dz
    disc = b * b - (ray.base + z * z - radius * radius)
    if disc < f64(0.0):
        return wp.vec2d(f64(1.0), f64(0.0))
    root = wp.sqrt(disc)
    return wp.vec2d(greater(lo, -b - root), lesser(hi, root - b))


@wp.func
def centred_ball_interval(ray: ToolRay, centre_z: f64, radius: f64, lo: f64, hi: f64) -> wp.vec2d:
    """The same, with all digits wherever the ball is: from the ray's point closest to its centre."""
    z = ray.z0 - centre_z
    middle = -ray.half - z * ray.dz
    w = ray.w0 + middle * ray.w1
    z += middle * ray.dz
    disc = radius * radius - (wp.dot(w, w) + z * z)
    if disc < f64(0.0):
        return wp.vec2d(f64(1.0), f64(0.0))
    root = wp.sqrt(disc)
    return wp.vec2d(greater(lo, middle - root), lesser(hi, middle + root))


@wp.func
def arc_interval(
    ray: ToolRay, centre_r: f64, centre_z: f64, radius: f64, lo: f64, hi: f64, close: f64
) -> wp.vec2d:  # fmt: skip
    """Part of [lo, hi] inside the puck of an arc, its ends within ``close`` of it; empty as (1, 0)."""
    if centre_r == f64(0.0):
        return centred_ball_interval(ray, centre_z, radius, lo, hi)
    ball = centre_r + radius
    if centre_r < f64(0.0):
        ball = wp.sqrt(radius * radius - centre_r * centre_r)
    # far from the tool's middle the ball's quadratic has fewer digits, and Newton's method must begin outside
    ball += f64(1.0e-7) * (ball + wp.abs(ray.z0 - centre_z))
    near = ball_interval(ray, centre_z, ball, lo, hi)
    start = near[0]
    stop = near[1]
    if start > stop:
        return wp.vec2d(f64(1.0), f64(0.0))
    first = puck_end(ray, centre_r, centre_z, radius, start, stop, close)
    if first == FAR:
        return wp.vec2d(f64(1.0), f64(0.0))
    last = puck_end(ray, centre_r, centre_z, radius, stop, start, close)
    if last == FAR:
        last = first
    return wp.vec2d(first, last)
