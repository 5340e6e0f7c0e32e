"""How a row's middle pose stands to what a ray has left beside the one interval that its list holds.

A plane fixed to the tool, with its outward normal n, has the tool behind it. Let F be how far before it the ray's point
tau lies. Of a point that the row's tool reaches anywhere, kernels/bounds.py holds:
    F(x, tau + u) >= F + F_x x + F_tau u - K x²/2 - w |x u|.
Where that is positive for all x in [-1, 1] and all that is left, no such point is reached.
"""

import warp as wp

from gearsim.kernels.interval import IntervalLists
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import LINE, Cutter
from gearsim.kernels.tool_ray import FAR, TINY, greater, lesser

f64 = wp.float64

NOTHING_NEW = wp.constant(0)
MORE = wp.constant(1)
MORE_LATER = wp.constant(2)


@wp.func
def facing_plane(cutter: Cutter, r: f64, z: f64) -> wp.vec3d:
    """How far [mm] a point lies before a plane that touches the cutter about as high as it is, and that plane's
    outward normal (nr, nz); -FAR where none is at hand.
    """
    below = cutter.slabs[cutter.first, 0] - z
    if below > f64(0.0):
        return wp.vec3d(below, f64(0.0), f64(-1.0))
    k = cutter.first
    while k < cutter.end:
        top = cutter.slabs[k, 1]
        if z <= top or k == cutter.end - 1:
            r0 = cutter.slabs[k, 2]
            if cutter.slabs[k, 5] == LINE:
                slope = cutter.slabs[k, 3]
                scale = f64(1.0) / cutter.slabs[k, 4]
                return wp.vec3d((r - r0 - slope * (z - cutter.slabs[k, 0])) * scale, scale, -slope * scale)
            out = r - r0
            up = z - cutter.slabs[k, 3]
            rho = cutter.slabs[k, 4]
            length = wp.sqrt(out * out + up * up)
            rise = rho * up - (cutter.slabs[k, 0] - cutter.slabs[k, 3]) * length
            if out > f64(0.0) and rise >= f64(0.0) and rise <= (top - cutter.slabs[k, 0]) * length:
                return wp.vec3d(length - rho, out / length, up / length)
        k += 1
    return wp.vec3d(-FAR, f64(0.0), f64(1.0))


@wp.struct
class Standing:
    """How a row's middle pose stands to what is left of a ray's window: how far it is from all of it [mm], at least,
    and whether the row may take some of it: NOTHING_NEW, MORE, or MORE_LATER where later poses may take more of it.
    """

    clear: f64
    more: wp.int32


@wp.func
def standing_of(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, window: wp.vec2d,
    tolerance: f64, ray: int, lists: IntervalLists,
) -> Standing:  # fmt: skip
    """See Standing. What is taken within ``tolerance`` of the interval is no more; of other lists nothing is told."""
    standing = Standing()
    if lists.count[ray] != 1:
        standing.more = MORE
        return standing
    standing.clear = FAR
    side = int(0)
    while side < 2:
        forward = f64(2 * side - 1)
        end = wp.where(side == 0, lists.lo[ray, 0], lists.hi[ray, 0]) + forward * tolerance
        length = forward * (window[side] - end)
        side += 1
        if length < f64(0.0):
            continue
        axis = motion.axis[row, 0]
        w = origin + end * direction - motion.tip[row, 0]
        z = wp.dot(w, axis)
        w = w - z * axis
        r = wp.length(w)
        plane = facing_plane(cutter, r, z)
        if r < f64(100.0) * cutter.skin:
            plane[0] = -FAR
        across = plane[1] / greater(r, TINY)
        climb = forward * (across * wp.dot(w, direction) + plane[2] * wp.dot(axis, direction))
        clear = plane[0] + lesser(f64(0.0), climb * length)
        standing.clear = lesser(standing.clear, clear)
        if clear < motion.speed[row]:
            turn = wp.dot(w, motion.axis[row, 1])
            tip_rate = motion.tip[row, 1]
            push = plane[2] * (turn - wp.dot(tip_rate, axis)) - across * (wp.dot(w, tip_rate) + z * turn)
            fall = lesser(f64(0.0), (climb - motion.spin[row]) * length)
            if plane[0] + fall < wp.abs(push) + f64(0.5) * motion.acceleration[row]:
                more = wp.where(push < f64(0.0), MORE_LATER, MORE)
                standing.more = wp.where(standing.more == MORE, MORE, more)
    return standing
