"""The signed distance from a ray's points to a moving ring: a face-mill head, whose body is not convex.

The ring's section M in the (r, z) half plane is convex. The signed distance to a convex set is the largest of
its supporting half-planes' distances, max over unit normals n of n . p - h(n); over the normals of one vertex
or arc that is the distance from its centre less its radius. So no nearest element has to be found.
"""

import warp as wp

from gearsim.kernels.pose import Motion, pose_at
from gearsim.kernels.tool_ray import FAR, TINY, line_interval, tool_ray

f64 = wp.float64

ROUNDING = wp.constant(f64(7.2e-15))  # 32 eps


@wp.struct
class Ring:
    """Section of a ring; lengths in mm, tool frame.

    ``lines`` row: normal (r, z) and its height over the origin. ``arcs`` row: centre (r, z), radius, first
    and last normal (r, z); vertices are arcs of no radius. The body lies within ``radius`` of the axis,
    between ``bottom`` and ``top``, and within ``reach`` of the origin. The moving tool's coordinates stay below
    ``extent``.
    """

    lines: wp.array2d(dtype=f64)
    arcs: wp.array2d(dtype=f64)
    radius: f64
    bottom: f64
    top: f64
    reach: f64
    extent: f64


@wp.struct
class Gap:
    """Signed distance f of the ray's point tau to the ring at pose x, with its derivatives push = F_x and
    steep = F_tau.

    ``out_x``, ``along_x`` and ``across_x`` are the point's rates away from the axis, along it and around it by x,
    as the tool sees them; ``out_tau``, ``along_tau`` and ``across_tau`` those by tau. r is its distance from the
    axis, z its height over the tip, size its distance from the tip, nr the radial part of the gradient.
    """

    x: f64
    tau: f64
    f: f64
    push: f64
    steep: f64
    out_x: f64
    out_tau: f64
    along_x: f64
    along_tau: f64
    across_x: f64
    across_tau: f64
    r: f64
    z: f64
    size: f64
    nr: f64


@wp.func
def rounding_of(ring: Ring, origin: wp.vec3d, lo: f64, hi: f64) -> f64:
    """Bound of what float64 makes of the distances [mm] from the points [lo, hi] of a ray, by all coordinates' size."""
    size = wp.max(wp.max(wp.abs(origin[0]), wp.abs(origin[1])), wp.abs(origin[2]))
    return ROUNDING * (ring.extent + size + wp.max(wp.abs(lo), wp.abs(hi)))


@wp.func
def section_distance(ring: Ring, r: f64, z: f64) -> wp.vec3d:
    """Signed distance of (r, z) to the section, and its gradient."""
    best = -FAR
    nr = f64(0.0)
    nz = f64(0.0)
    for i in range(ring.lines.shape[0]):
        over = ring.lines[i, 0] * r + ring.lines[i, 1] * z - ring.lines[i, 2]
        if over > best:
            best = over
            nr = ring.lines[i, 0]
            nz = ring.lines[i, 1]
    for i in range(ring.arcs.shape[0]):
        dr = r - ring.arcs[i, 0]
        dz = z - ring.arcs[i, 1]
        after_first = ring.arcs[i, 3] * dz - ring.arcs[i, 4] * dr
        before_last = ring.arcs[i, 6] * dr - ring.arcs[i, 5] * dz
        if after_first >= f64(0.0) and before_last >= f64(0.0):
            size = wp.sqrt(dr * dr + dz * dz)
            if size - ring.arcs[i, 2] > best:
                best = size - ring.arcs[i, 2]
                nr = dr / wp.max(size, TINY)
                nz = dz / wp.max(size, TINY)
    return wp.vec3d(best, nr, nz)


@wp.func
def gap_of(ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, x: f64, tau: f64) -> Gap:
    """The ring's distance at pose x to the ray's point tau, with all that bounds it nearby."""
    pose = pose_at(motion, row, x)
    q = origin + tau * direction - pose.tip
    z = wp.dot(q, pose.axis)
    w = q - z * pose.axis
    g = Gap()
    g.x = x
    g.tau = tau
    g.r = wp.max(wp.length(w), TINY)
    g.z = z
    g.size = wp.sqrt(g.r * g.r + z * z)
    d = section_distance(ring, g.r, z)
    g.f = d[0]
    g.nr = d[1]
    out = w / g.r
    around = wp.cross(pose.axis, out)
    rate = pose.tip_rate + z * pose.axis_rate
    g.out_x = -wp.dot(out, rate)
    g.out_tau = wp.dot(out, direction)
    g.along_x = wp.dot(w, pose.axis_rate) - wp.dot(pose.tip_rate, pose.axis)
    g.along_tau = wp.dot(pose.axis, direction)
    g.push = d[1] * g.out_x + d[2] * g.along_x
    g.steep = d[1] * g.out_tau + d[2] * g.along_tau
    g.across_x = -wp.dot(around, rate)
    g.across_tau = wp.dot(around, direction)
    return g


@wp.func
def over_line(ring: Ring, g: Gap, i: int) -> Gap:
    """The same point's distance to the half plane of line i, which is never more than that to the ring."""
    nz = ring.lines[i, 1]
    over = g
    over.nr = ring.lines[i, 0]
    over.f = over.nr * g.r + nz * g.z - ring.lines[i, 2]
    over.push = over.nr * g.out_x + nz * g.along_x
    over.steep = over.nr * g.out_tau + nz * g.along_tau
    return over


@wp.func
def window_of(ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d) -> wp.vec2d:
    """Interval of the ray inside the mid-pose ring's cylinder grown by the segment's displacement; empty (1, 0)."""
    ray = tool_ray(motion.tip[row, 0], motion.axis[row, 0], f64(0.0), origin, direction)
    grown = motion.speed[row] * f64(1.0001)
    lo = -FAR
    hi = FAR
    if wp.abs(ray.dz) > TINY:
        ta = (ring.bottom - grown - ray.z0) / ray.dz
        tb = (ring.top + grown - ray.z0) / ray.dz
        lo = wp.min(ta, tb)
        hi = wp.max(ta, tb)
    elif ray.z0 < ring.bottom - grown or ray.z0 > ring.top + grown:
        return wp.vec2d(f64(1.0), f64(0.0))
    part = line_interval(ray, ring.radius + grown, f64(0.0), f64(0.0), lo, hi)
    return part + wp.vec2d(ray.shift, ray.shift)
