"""Closed forms of a ray against a convex cutter's profile at rest: no motion, no index, no scene.

A cutter is one convex part or the union of several, of which one at a time is looked at. A part is cut
into slabs, one for each line or arc of its profile that rises along the axis; every slab is convex (a
frustum; or a disc rounded by a ball, or a spindle, between two planes), so a ray meets each in one
interval, and the part in the hull of those.
"""

import warp as wp

f64 = wp.float64

LINE = wp.constant(f64(0.0))
ARC = wp.constant(f64(1.0))

FAR = wp.constant(f64(1.0e30))
TINY = wp.constant(f64(1.0e-14))
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
class Cutters:
    """The cutters of all jobs: job j has the parts ``job_first[j]`` to ``job_first[j + 1]``, part p the slabs
    ``part_first[p]`` to ``part_first[p + 1]``; lengths in mm, tool frame.

    ``slabs`` row, from the tip up: z0, z1, then radius at z0, slope dr/dz, sqrt(1 + slope²), LINE or centre r,
    centre z, radius, ARC (a centre beyond the axis makes a spindle). ``part_size`` is more than a part's largest
    extent.
    """

    slabs: wp.array2d(dtype=f64)
    part_first: wp.array(dtype=wp.int32)
    part_size: wp.array(dtype=f64)
    job_first: wp.array(dtype=wp.int32)


@wp.struct
class Cutter:
    """One convex part: the slabs ``first`` to ``end``, the height of its middle, and more than its size."""

    slabs: wp.array2d(dtype=f64)
    first: wp.int32
    end: wp.int32
    middle: f64
    size: f64


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


@wp.struct
class Hit:
    """Interval of a ray inside the cutter; ``face`` is 2 k for slab k's flank, else 2 k + 1 for its disc."""

    found: wp.int32
    lo: f64
    hi: f64
    lo_face: wp.int32
    hi_face: wp.int32


@wp.func
def convex_part(cutters: Cutters, part: int) -> Cutter:
    """One part of a cutter."""
    one = Cutter()
    one.slabs = cutters.slabs
    one.first = cutters.part_first[part]
    one.end = cutters.part_first[part + 1]
    one.middle = f64(0.5) * (one.slabs[one.first, 0] + one.slabs[one.end - 1, 1])
    one.size = cutters.part_size[part]
    return one


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
    if wp.abs(a) < TINY:
        a = TINY
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
    if first > lo:
        return wp.vec2d(lo, lesser(hi, first))
    return wp.vec2d(greater(lo, last), hi)


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
def puck_end(ray: ToolRay, centre_r: f64, centre_z: f64, radius: f64, start: f64, stop: f64) -> f64:
    """First tau from ``start`` towards ``stop`` inside the puck, or FAR; Newton from outside is monotone."""
    tau = start
    forward = f64(1.0)
    if stop < start:
        forward = f64(-1.0)
    step = int(0)
    while step < NEWTON_STEPS:
        d = puck_distance(ray, centre_r, centre_z, radius, tau)
        if d[0] <= TINY:
            return tau
        rate = d[1] * forward
        if rate >= f64(0.0):
            return FAR
        move = -d[0] / rate
        tau += forward * move
        if (stop - tau) * forward < f64(0.0):
            return FAR
        if move < TINY:
            return tau
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
def arc_interval(ray: ToolRay, centre_r: f64, centre_z: f64, radius: f64, lo: f64, hi: f64) -> wp.vec2d:
    """Part of [lo, hi] inside the puck of an arc; empty as (1, 0)."""
    ball = centre_r + radius
    if centre_r < f64(0.0):
        ball = wp.sqrt(radius * radius - centre_r * centre_r)
    near = ball_interval(ray, centre_z, ball, lo, hi)
    start = near[0]
    stop = near[1]
    if start > stop:
        return wp.vec2d(f64(1.0), f64(0.0))
    first = puck_end(ray, centre_r, centre_z, radius, start, stop)
    if first == FAR:
        return wp.vec2d(f64(1.0), f64(0.0))
    last = puck_end(ray, centre_r, centre_z, radius, stop, start)
    if last == FAR:
        last = first
    return wp.vec2d(first, last)


@wp.func
def cutter_interval(cutter: Cutter, ray: ToolRay) -> Hit:
    """Interval of a unit-speed ray inside the cutter."""
    hit = Hit()
    hit.found = 0
    hit.lo = FAR
    hit.hi = -FAR
    for k in range(cutter.first, cutter.end):
        z0 = cutter.slabs[k, 0]
        z1 = cutter.slabs[k, 1]
        lo = -FAR
        hi = FAR
        if wp.abs(ray.dz) > TINY:
            ta = (z0 - ray.z0) / ray.dz
            tb = (z1 - ray.z0) / ray.dz
            lo = lesser(ta, tb)
            hi = greater(ta, tb)
        elif ray.z0 < z0 or ray.z0 > z1:
            continue
        part = wp.vec2d(f64(1.0), f64(0.0))
        if cutter.slabs[k, 5] == LINE:
            part = line_interval(ray, cutter.slabs[k, 2], cutter.slabs[k, 3], z0, lo, hi)
        else:
            part = arc_interval(ray, cutter.slabs[k, 2], cutter.slabs[k, 3], cutter.slabs[k, 4], lo, hi)
        if part[0] > part[1]:
            continue
        hit.found = 1
        if part[0] < hit.lo:
            hit.lo = part[0]
            hit.lo_face = 2 * k
            if part[0] == lo and end_slab(cutter, k, ray.dz):
                hit.lo_face = 2 * k + 1
        if part[1] > hit.hi:
            hit.hi = part[1]
            hit.hi_face = 2 * k
            if part[1] == hi and end_slab(cutter, k, -ray.dz):
                hit.hi_face = 2 * k + 1
    return hit


@wp.func
def end_slab(cutter: Cutter, k: int, dz: f64) -> bool:
    """Whether a ray that rises with ``dz`` enters slab k through an end of the whole part."""
    return (k == cutter.first and dz > f64(0.0)) or (k == cutter.end - 1 and dz < f64(0.0))


@wp.func
def face_normal(cutter: Cutter, face: int, r: f64, z: f64) -> wp.vec2d:
    """Outward normal (nr, nz) of the cutter's face at a point on it."""
    k = face // 2
    if face % 2 == 1:
        if z > cutter.middle:
            return wp.vec2d(f64(0.0), f64(1.0))
        return wp.vec2d(f64(0.0), f64(-1.0))
    if cutter.slabs[k, 5] == LINE:
        scale = f64(1.0) / cutter.slabs[k, 4]
        return wp.vec2d(scale, -cutter.slabs[k, 3] * scale)
    return wp.vec2d(greater(r - cutter.slabs[k, 2], f64(0.0)), z - cutter.slabs[k, 3]) / cutter.slabs[k, 4]
