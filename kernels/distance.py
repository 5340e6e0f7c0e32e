"""The nearest place of the cutter's surface, for points outside it as for those inside."""

import warp as wp

from gearsim.kernels.profile import LINE, Cutter
from gearsim.kernels.tool_ray import FAR, TINY, greater

f64 = wp.float64


@wp.func
def nearer(best: wp.vec3d, r: f64, z: f64, at_r: f64, at_z: f64) -> wp.vec3d:
    """The nearer of an edge known as ``surface_distance`` gives it and one at (at_r, at_z)."""
    out = r - at_r
    up = z - at_z
    d = wp.sqrt(out * out + up * up)
    if d < best[0]:
        scale = f64(1.0) / greater(d, TINY)
        return wp.vec3d(d, out * scale, up * scale)
    return best


@wp.func
def face_nearest(cutter: Cutter, k: int, r: f64, z: f64) -> wp.vec3d:
    """Slab k's line or arc as ``surface_distance`` gives it, where the point is opposite to it; else FAR away."""
    z0 = cutter.slabs[k, 0]
    rise = cutter.slabs[k, 1] - z0
    r0 = cutter.slabs[k, 2]
    if cutter.slabs[k, 5] == LINE:
        slope = cutter.slabs[k, 3]
        scale = f64(1.0) / cutter.slabs[k, 4]
        along = ((r - r0) * slope + (z - z0)) * scale * scale
        if along > f64(0.0) and along < rise:
            return wp.vec3d(wp.abs((r - r0) - slope * (z - z0)) * scale, scale, -slope * scale)
        return wp.vec3d(FAR, f64(0.0), f64(0.0))
    rho = cutter.slabs[k, 4]
    out = greater(r - r0, f64(0.0))
    up = z - cutter.slabs[k, 3]
    length = wp.sqrt(out * out + up * up)
    scale = f64(1.0) / greater(length, TINY)
    along = cutter.slabs[k, 3] + rho * up * scale - z0
    rounding = TINY * cutter.size
    if along > -rounding and along < rise + rounding:
        return wp.vec3d(wp.abs(length - rho), out * scale, up * scale)
    return wp.vec3d(FAR, f64(0.0), f64(0.0))


@wp.func
def slab_radius(cutter: Cutter, k: int, z: f64) -> f64:
    """Radius of slab k at height z."""
    r0 = cutter.slabs[k, 2]
    if cutter.slabs[k, 5] == LINE:
        return r0 + cutter.slabs[k, 3] * (z - cutter.slabs[k, 0])
    rho = cutter.slabs[k, 4]
    up = z - cutter.slabs[k, 3]
    return greater(r0 + wp.sqrt(greater(rho * rho - up * up, f64(0.0))), f64(0.0))


@wp.func
def surface_distance(cutter: Cutter, r: f64, z: f64) -> wp.vec3d:
    """Distance of a point to the part's surface, and the unit normal (nr, nz) that the surface has there.

    On an edge the normal is that towards the point, which must then be outside. Faces give theirs, so that a
    point that all but touches has one without noise: an edge must be nearer than they are by more than rounding.
    """
    best = wp.vec3d(FAR, f64(0.0), f64(0.0))
    edge = wp.vec3d(FAR, f64(0.0), f64(0.0))
    for k in range(cutter.first, cutter.end):
        z0 = cutter.slabs[k, 0]
        z1 = cutter.slabs[k, 1]
        r0 = slab_radius(cutter, k, z0)
        r1 = slab_radius(cutter, k, z1)
        face = face_nearest(cutter, k, r, z)
        if face[0] < best[0]:
            best = face
        edge = nearer(edge, r, z, r0, z0)
        edge = nearer(edge, r, z, r1, z1)
        if k == cutter.first and r < r0 and wp.abs(z - z0) < best[0]:
            best = wp.vec3d(wp.abs(z - z0), f64(0.0), f64(-1.0))
        if k == cutter.end - 1 and r < r1 and wp.abs(z - z1) < best[0]:
            best = wp.vec3d(wp.abs(z - z1), f64(0.0), f64(1.0))
    if edge[0] < best[0] - TINY * cutter.size:
        return edge
    return best
