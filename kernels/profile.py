"""Closed forms of a ray against a convex cutter's profile at rest: no motion, no index, no scene.

A cutter is one convex part or the union of several, of which one at a time is looked at. A part is cut
into slabs, one for each line or arc of its profile that rises along the axis; every slab is convex (a
frustum; or a disc rounded by a ball, or a spindle, between two planes), so a ray meets each in one
interval, and the part in the hull of those.
"""

import warp as wp

from gearsim.kernels.tool_ray import FAR, NOTHING, ToolRay, arc_interval, cone_interval, greater, lesser

f64 = wp.float64

LINE = wp.constant(f64(0.0))
ARC = wp.constant(f64(1.0))

SKIN = wp.constant(f64(2.0e-15))


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
    """One convex part: the slabs ``first`` to ``end``, the height of its middle, and more than its size.

    ``skin`` [mm] is what coordinates are rounded to. The part is taken to be smaller by it, so that a ray that
    touches it misses, whichever way it was rounded.
    """

    slabs: wp.array2d(dtype=f64)
    first: wp.int32
    end: wp.int32
    middle: f64
    size: f64
    skin: f64


@wp.struct
class Hit:
    """Interval of a ray inside the cutter; ``face`` is 2 k for slab k's flank, else 2 k + 1 for its disc."""

    found: wp.int32
    lo: f64
    hi: f64
    lo_face: wp.int32
    hi_face: wp.int32


@wp.func
def convex_part(cutters: Cutters, part: int, extent: f64) -> Cutter:
    """One part of a cutter, for coordinates no greater than ``extent`` [mm]."""
    one = Cutter()
    one.slabs = cutters.slabs
    one.first = cutters.part_first[part]
    one.end = cutters.part_first[part + 1]
    one.middle = f64(0.5) * (one.slabs[one.first, 0] + one.slabs[one.end - 1, 1])
    one.size = cutters.part_size[part]
    one.skin = SKIN * (extent + one.size)
    return one


@wp.func
def cutter_interval(cutter: Cutter, ray: ToolRay) -> Hit:
    """Interval of a unit-speed ray inside the cutter."""
    skin = cutter.skin
    hit = Hit()
    hit.found = 0
    hit.lo = FAR
    hit.hi = -FAR
    for k in range(cutter.first, cutter.end):
        z0 = cutter.slabs[k, 0]
        z1 = cutter.slabs[k, 1]
        if k == cutter.first:
            z0 += skin
        if k == cutter.end - 1:
            z1 -= skin
        lo = -FAR
        hi = FAR
        if wp.abs(ray.dz) > NOTHING:
            ta = (z0 - ray.z0) / ray.dz
            tb = (z1 - ray.z0) / ray.dz
            lo = lesser(ta, tb)
            hi = greater(ta, tb)
        elif ray.z0 < z0 or ray.z0 > z1:
            continue
        part = wp.vec2d(f64(1.0), f64(0.0))
        if cutter.slabs[k, 5] == LINE:
            radius = cutter.slabs[k, 2] - skin * cutter.slabs[k, 4]
            slope = cutter.slabs[k, 3]
            base = cutter.slabs[k, 0]
            if slope < f64(0.0):
                radius += slope * (cutter.slabs[k, 1] - base)
                base = cutter.slabs[k, 1]
            part = cone_interval(ray, radius, slope, base, lo, hi)
        else:
            rho = cutter.slabs[k, 4] - skin
            part = arc_interval(ray, cutter.slabs[k, 2], cutter.slabs[k, 3], rho, lo, hi, f64(0.1) * skin)
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
