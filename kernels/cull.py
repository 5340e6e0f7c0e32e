"""Which stretch of a ray a moving cutter may touch at all: the closed forms that turn rays away.

All bounds are outward: the tool at one pose is grown by the largest displacement of any of its points, and
an arc counts as the ball that holds it, or as its cylinder where it is centred beyond the axis.
"""

import warp as wp

from gearsim.kernels.profile import LINE, Cutter
from gearsim.kernels.tool_ray import FAR, TINY, ball_interval, greater, lesser, line_interval, tool_ray

f64 = wp.float64


@wp.struct
class Groups:
    """Consecutive rows of the motion taken together: group g has the rows first[g] to first[g + 1].

    The tool stays within ``spread`` [mm] of where it is at the pose (``tip``, ``axis``). It moves by no more than
    travel[j] - travel[i] [mm] from the middle of row i to that of row j.
    """

    first: wp.array(dtype=wp.int32)
    tip: wp.array(dtype=wp.vec3d)
    axis: wp.array(dtype=wp.vec3d)
    spread: wp.array(dtype=f64)
    travel: wp.array(dtype=f64)


PAD = wp.constant(f64(1.0e-7))


@wp.func
def near_stretch(
    cutter: Cutter, tip: wp.vec3d, axis: wp.vec3d, spread: f64, origin: wp.vec3d, direction: wp.vec3d, window: wp.vec2d
) -> wp.vec2d:  # fmt: skip
    """The part of a ray's window within ``spread`` [mm] of the cutter at a pose, or a little more; empty (1, 0)."""
    ray = tool_ray(tip, axis, cutter.middle, origin, direction)
    grown = spread + PAD * cutter.size + f64(1.0e3) * cutter.skin
    per_dz = FAR
    if wp.abs(ray.dz) > TINY:
        per_dz = f64(1.0) / ray.dz
    first = FAR
    last = -FAR
    for k in range(cutter.first, cutter.end):
        below = (cutter.slabs[k, 0] - grown - ray.z0) * per_dz
        above = (cutter.slabs[k, 1] + grown - ray.z0) * per_dz
        lo = greater(lesser(below, above), window[0] - ray.shift)
        hi = lesser(greater(below, above), window[1] - ray.shift)
        if lo <= hi:
            part = wp.vec2d(f64(1.0), f64(0.0))
            if cutter.slabs[k, 5] == LINE:
                radius = cutter.slabs[k, 2] + grown * cutter.slabs[k, 4]
                part = line_interval(ray, radius, cutter.slabs[k, 3], cutter.slabs[k, 0], lo, hi)
            elif cutter.slabs[k, 2] < f64(0.0):
                part = line_interval(ray, cutter.slabs[k, 2] + cutter.slabs[k, 4] + grown, f64(0.0), f64(0.0), lo, hi)
            else:
                part = ball_interval(ray, cutter.slabs[k, 3], cutter.slabs[k, 2] + cutter.slabs[k, 4] + grown, lo, hi)
            if part[0] <= part[1]:
                first = lesser(first, part[0])
                last = greater(last, part[1])
    if first > last:
        return wp.vec2d(f64(1.0), f64(0.0))
    return wp.vec2d(first + ray.shift, last + ray.shift)
