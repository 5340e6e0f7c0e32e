"""The surface that a moving tool leaves, at points where it was the last to touch: its normal there.

A tool is the union of convex parts, or one ring; a part's section in the (r, z) half plane is convex, the set below
all its faces' half planes. Let F(x) be the largest of a point's heights over those, at pose x of a row: no more than
its signed distance to the part, and 0 on its surface. The pose that made the point is where F is least, 0. There F has
slope 0, or the row ends. Where it has a kink (the point is on a sharp edge of the tool), the mean of the normals on
both sides, weighted so that the slope is 0, is normal to the edge and to its velocity.
"""

import warp as wp

from gearsim.kernels.options import OPTIONS
from gearsim.kernels.pose import Motion, pose_at
from gearsim.kernels.tool_ray import FAR, TINY

f64 = wp.float64
wp.set_module_options(OPTIONS)

FEW_POSES = wp.constant(16)
MANY_POSES = wp.constant(256)
HALVINGS = wp.constant(38)
NEAR = wp.constant(f64(1.0e-8))
ON_AXIS = wp.constant(f64(1.0e-9))


@wp.struct
class Sections:
    """The convex sections of all parts of all tools; lengths in mm, tool frame.

    ``faces`` row: centre (r, z), radius, first and last normal (r, z); a straight one has one of its points for a
    centre, and no radius. Part p has the rows ``first[p]`` to ``first[p + 1]``.
    """

    faces: wp.array2d(dtype=f64)
    first: wp.array(dtype=wp.int32)


@wp.struct
class Touch:
    """How far a point lies over a part at pose x, how that changes with x, and the normal of the face it is over."""

    x: f64
    f: f64
    push: f64
    normal: wp.vec3d


@wp.func
def over_face(sections: Sections, k: int, r: f64, z: f64) -> wp.vec3d:
    """Largest height of (r, z) over the half planes of face k, and the normal of that one."""
    dr = r - sections.faces[k, 0]
    dz = z - sections.faces[k, 1]
    radius = sections.faces[k, 2]
    first = wp.vec2d(sections.faces[k, 3], sections.faces[k, 4])
    last = wp.vec2d(sections.faces[k, 5], sections.faces[k, 6])
    if radius > f64(0.0):
        if first[0] * dz >= first[1] * dr and last[1] * dr >= last[0] * dz:
            size = wp.sqrt(dr * dr + dz * dz)
            return wp.vec3d(size - radius, dr / wp.max(size, TINY), dz / wp.max(size, TINY))
    over_first = first[0] * dr + first[1] * dz
    over_last = last[0] * dr + last[1] * dz
    if over_first >= over_last:
        return wp.vec3d(over_first - radius, first[0], first[1])
    return wp.vec3d(over_last - radius, last[0], last[1])


@wp.func
def touch_at(sections: Sections, part: int, motion: Motion, row: int, point: wp.vec3d, x: f64) -> Touch:
    """A point as a part sees it at pose x of a row."""
    pose = pose_at(motion, row, x)
    q = point - pose.tip
    z = wp.dot(q, pose.axis)
    w = q - z * pose.axis
    r = wp.length(w)
    best = wp.vec3d(-FAR, f64(0.0), f64(0.0))
    for k in range(sections.first[part], sections.first[part + 1]):
        over = over_face(sections, k, r, z)
        if over[0] > best[0]:
            best = over
    out = wp.vec3d()
    if r > ON_AXIS:  # else w is noise
        out = w / r
    touch = Touch()
    touch.x = x
    touch.f = best[0]
    touch.normal = best[1] * out + best[2] * pose.axis
    touch.push = best[2] * (wp.dot(w, pose.axis_rate) - wp.dot(pose.tip_rate, pose.axis))
    touch.push -= best[1] * wp.dot(out, pose.tip_rate + z * pose.axis_rate)
    return touch


@wp.func
def between(a: Touch, b: Touch) -> Touch:
    """The touch of slope 0 between two close ones, the slope of the first below 0."""
    if a.push >= f64(0.0) or b.push <= f64(0.0):
        if a.f <= b.f:
            return a
        return b
    share = -a.push / (b.push - a.push)
    a.x += share * (b.x - a.x)
    a.f = wp.min(a.f, b.f)
    a.normal = wp.normalize((f64(1.0) - share) * a.normal + share * b.normal)
    a.push = f64(0.0)
    return a


@wp.func
def nearest_touch(sections: Sections, part: int, motion: Motion, row: int, point: wp.vec3d, poses: int) -> Touch:
    """The pose at which a part comes nearest to a point: the least of some, then halving towards slope 0."""
    a = Touch()
    b = Touch()
    best = Touch()
    best.f = FAR
    step = f64(2.0) / f64(poses)
    count = poses + 1 + HALVINGS
    for i in range(count):
        x = f64(0.5) * (a.x + b.x)
        if i <= poses:
            x = wp.min(f64(i) * step - f64(1.0), f64(1.0))
        here = touch_at(sections, part, motion, row, point, x)
        if i > poses:
            if here.push < f64(0.0):
                a = here
            else:
                b = here
        elif here.f < best.f:
            best = here
        if i == poses:
            if best.push == f64(0.0):
                return best
            if best.push < f64(0.0):
                if best.x >= f64(1.0):
                    return best
                a = best
                b.x = wp.min(best.x + step, f64(1.0))
            else:
                if best.x <= f64(-1.0):
                    return best
                b = best
                a.x = wp.max(best.x - step, f64(-1.0))
    return between(a, b)


@wp.kernel
def end_normals(
    # cutter
    sections: Sections,
    # motion
    motion: Motion,
    # in
    begin: int,
    points: wp.array(dtype=wp.vec3d),
    rows: wp.array(dtype=wp.int32),
    parts: wp.array(dtype=wp.vec2i),
    # out
    normal_out: wp.array(dtype=wp.vec3d),
    gap_out: wp.array(dtype=f64),
):
    """Outward normals of the material at points from number ``begin`` on, and how far they are from the tool.

    ``rows`` of the motion made them, with the tool of the ``parts`` from a first one to before a last one.
    """
    i = begin + wp.tid()
    best = Touch()
    best.f = FAR
    poses = FEW_POSES
    for _ in range(2):
        for part in range(parts[i][0], parts[i][1]):
            touch = nearest_touch(sections, part, motion, rows[i], points[i], poses)
            if touch.f < best.f:
                best = touch
        if wp.abs(best.f) <= NEAR:
            break
        poses = MANY_POSES
    normal_out[i] = -wp.normalize(best.normal)  # shorter at a point on the axis alone
    gap_out[i] = best.f
