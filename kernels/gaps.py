"""Whether what the cutter sweeps from a ray between two poses that hit is one stretch.

Two chords that overlap are. Otherwise F is looked at on the straight way from the middle of one to that of the
other, in pose and place at once: it is convex along a straight line in the tool, so between depths a and b it
stays inside as long as the way, as the tool sees it, bends by no more than B = 2 (sqrt(a) + sqrt(b))².
"""

import warp as wp

from gearsim.kernels.distance import surface_distance
from gearsim.kernels.find import FIND_LOOKS, HIT, LOST, NARROWEST, Find
from gearsim.kernels.pose import Motion, place_at
from gearsim.kernels.profile import Cutter, cutter_interval
from gearsim.kernels.tool_ray import greater, tool_ray

f64 = wp.float64


@wp.struct
class Link:
    """A ray's chord [lo, hi] at pose x and how deep in the cutter its middle lies, less what is rounded."""

    found: wp.int32
    x: f64
    lo: f64
    hi: f64
    depth: f64


@wp.func
def link_at(cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, x: f64) -> Link:
    """See Link."""
    place = place_at(motion, row, x)
    ray = tool_ray(place.tip, place.axis, cutter.middle, origin, direction)
    hit = cutter_interval(cutter, ray)
    link = Link()
    link.x = x
    link.found = hit.found
    if hit.found == 1:
        link.lo = hit.lo + ray.shift
        link.hi = hit.hi + ray.shift
        tau = f64(0.5) * (hit.lo + hit.hi)
        depth = surface_distance(cutter, wp.length(ray.w0 + tau * ray.w1), ray.z0 + tau * ray.dz)[0]
        link.depth = greater(depth - cutter.skin, f64(0.0))
    return link


@wp.func
def joined(motion: Motion, row: int, a: Link, b: Link) -> bool:
    """Whether everything between two chords is swept; see above."""
    if a.lo <= b.hi and b.lo <= a.hi:
        return True
    step = b.x - a.x
    move = f64(0.5) * wp.abs(b.lo + b.hi - a.lo - a.hi)
    bend = motion.acceleration[row] * step * step + f64(2.0) * motion.spin[row] * step * move
    depth = wp.sqrt(a.depth) + wp.sqrt(b.depth)
    return bend <= f64(2.0) * depth * depth


@wp.func
def find_gap(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, from_x: f64, to_x: f64
) -> Find:  # fmt: skip
    """A pose that misses between two that hit (HIT), or the certainty that all between their chords is swept (NONE)."""
    find = Find()
    here = Link()
    x = from_x
    looks = int(0)
    while looks < FIND_LOOKS:
        ahead = link_at(cutter, motion, row, origin, direction, x)
        looks += 1
        if ahead.found == 0:
            find.outcome = HIT
            find.x = x
            return find
        if looks == 1:
            here = ahead
            x = to_x
            continue
        width = ahead.x - here.x
        if joined(motion, row, here, ahead):
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
