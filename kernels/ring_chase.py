"""From a hit of a ring along the ray to where the segment's sweep ends.

Two steps alternate until both settle: take the pose at which the point lies deepest, and follow the ray to
the tool's surface, at that pose or while the pose changes as the deepest one does. Every point walked through
lies in the tool at some pose, so no gap is spanned. Whether the sweep goes on beyond the end found is not said
here: what is left of the ray is searched again (kernels/ring_search.py).
"""

import warp as wp

from gearsim.kernels.pose import Motion
from gearsim.kernels.ring import Gap, Ring, gap_of
from gearsim.kernels.tool_ray import FAR

f64 = wp.float64

DEEPEST_STEPS = wp.constant(60)
FOLLOW_STEPS = wp.constant(1000)
ROUNDS = wp.constant(300)
SETTLED = wp.constant(f64(0.125))  # of the slack


@wp.struct
class Low:
    """The deepest pose found, and the poses a and b on both sides of it, last looked at; a: downhill to it."""

    best: Gap
    a: Gap
    b: Gap


@wp.func
def deepest(
    ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, here: Gap, settled: f64
) -> Low:  # fmt: skip
    """The deepest pose downhill from one, for the same point of the ray."""
    low = Low()
    low.best = here
    low.a = here
    low.b = here
    way = f64(1.0)
    if here.push > f64(0.0):
        way = f64(-1.0)
    if here.x * way >= f64(1.0):
        return low
    x = way
    step = int(0)
    while step < DEEPEST_STEPS:
        g = gap_of(ring, motion, row, origin, direction, x, here.tau)
        step += 1
        if g.f < low.best.f:
            low.best = g
        if g.push * way <= f64(0.0) and g.f <= low.a.f:
            low.a = g
            if g.x == way:
                return low
        else:
            low.b = g
        width = wp.abs(low.b.x - low.a.x)
        fall = -low.a.push * way
        rise = low.b.push * way
        if fall * width < settled:
            return low
        x = f64(0.5) * (low.a.x + low.b.x)
        if rise > f64(0.0) and step % 3 != 0:
            x = low.a.x + (low.b.x - low.a.x) * fall / (fall + rise)
    return low


@wp.func
def valley(low: Low) -> f64:
    """How the deepest pose changes along the ray, dx/dtau: where the faces on both sides of it stay level."""
    if low.a.push * low.b.push >= f64(0.0):
        return f64(0.0)
    return -(low.a.steep - low.b.steep) / (low.a.push - low.b.push)


@wp.func
def room(x: f64, climb: f64) -> f64:
    """How far the ray can be followed until the pose leaves the segment."""
    if climb > f64(0.0):
        return (f64(1.0) - x) / climb
    if climb < f64(0.0):
        return (f64(-1.0) - x) / climb
    return FAR


@wp.func
def follow(
    ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    here: Gap, way: f64, slope: f64, slack: f64,
) -> Gap:  # fmt: skip
    """Along the ray, the pose changing by ``slope``, from inside the ring to its surface or the segment's end.

    By the bound of kernels/ring_search.py F + c tau²/2 is convex on the way as long as r stays above half its
    value. Hence between two points inside, one of them deeper than c L²/2, a stretch of length L is all
    inside; where neither is, it comes out by c L²/8 at most, which may be as much as the slack. No step is longer.
    """
    climb = slope * way
    pace = f64(1.0) + wp.abs(slope) * motion.speed[row]
    bend = (motion.acceleration[row] * wp.abs(slope) + f64(2.0) * motion.spin[row]) * wp.abs(slope)
    a = here
    b = here
    settled = SETTLED * slack
    bracketed = int(0)
    step = int(0)
    while step < FOLLOW_STEPS:
        depth = -a.f
        rise = (a.steep + slope * a.push) * way
        c = bend + f64(2.0) * pace * pace / a.r
        move = wp.max(depth / pace, wp.sqrt(f64(2.0) * wp.max(depth, f64(4.0) * slack) / c))
        move = wp.min(move, f64(0.5) * a.r / pace)
        if bracketed == 1:
            width = wp.abs(b.tau - a.tau)
            if depth <= settled or width <= settled:
                return a
            if step % 3 == 0:
                move = wp.min(move, f64(0.5) * width)
            else:
                move = wp.min(move, width * depth / (depth + b.f))
        else:
            left = room(a.x, climb)
            if left <= settled or (depth <= settled and rise > f64(0.0)):
                return a
            if rise > f64(0.0):
                move = wp.min(move, depth / rise)
            move = wp.min(move, left)
        x = wp.clamp(a.x + climb * move, f64(-1.0), f64(1.0))
        g = gap_of(ring, motion, row, origin, direction, x, a.tau + way * move)
        step += 1
        if g.f <= f64(0.0):
            a = g
        else:
            b = g
            bracketed = 1
    return a


@wp.func
def chase(
    ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, hit: Gap, way: f64, slack: f64
) -> f64:  # fmt: skip
    """How far the sweep that holds a hit is followed, onward (way 1) or back (-1) along the ray."""
    settled = SETTLED * slack
    here = hit
    round = int(0)
    while round < ROUNDS:
        low = deepest(ring, motion, row, origin, direction, here, settled)
        here = low.best
        if round > 0 and here.f > f64(-4.0) * settled:
            return here.tau
        slope = f64(0.0)
        if round % 2 == 1:
            slope = valley(low)
        here = follow(ring, motion, row, origin, direction, here, way, slope, slack)
        round += 1
    return here.tau
