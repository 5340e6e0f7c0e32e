"""From a hit of a ring along the ray to where the segment's sweep ends.

Two steps alternate until both settle: take the pose at which the point lies deepest, and follow the ray at
that pose to the tool's surface. Every stretch walked lies in the tool at some pose, so no gap is spanned.
"""

import warp as wp

from gearsim.kernels.pose import Motion
from gearsim.kernels.ring import Gap, Ring, gap_of

f64 = wp.float64

DEEPEST_STEPS = wp.constant(60)
FOLLOW_STEPS = wp.constant(1000)
ROUNDS = wp.constant(300)
SETTLED = wp.constant(f64(1.0e-12))


@wp.struct
class End:
    """The end of a sweep along the ray, and whether the search for it settled."""

    tau: f64
    converged: wp.int32


@wp.func
def deepest(ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, here: Gap) -> Gap:
    """The deepest pose downhill from one, for the same point of the ray."""
    way = f64(1.0)
    if here.push > f64(0.0):
        way = f64(-1.0)
    if here.x * way >= f64(1.0):
        return here
    a = here
    b = here
    best = here
    x = way
    step = int(0)
    while step < DEEPEST_STEPS:
        g = gap_of(ring, motion, row, origin, direction, x, here.tau)
        step += 1
        if g.f < best.f:
            best = g
        if g.push * way <= f64(0.0) and g.f <= a.f:
            a = g
            if g.x == way:
                return best
        else:
            b = g
        width = wp.abs(b.x - a.x)
        fall = -a.push * way
        rise = b.push * way
        if fall * width < SETTLED:
            return best
        x = f64(0.5) * (a.x + b.x)
        if rise > f64(0.0) and step % 3 != 0:
            x = a.x + (b.x - a.x) * fall / (fall + rise)
    return best


@wp.func
def follow(
    ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, here: Gap, way: f64, slack: f64
) -> Gap:  # fmt: skip
    """Along the ray at a fixed pose from inside the ring to its surface.

    F + c tau²/2 is convex along the ray with c = 2/r, as long as r stays above half its value. Hence between
    two points inside, one of them deeper than c L²/2, a stretch of length L is all inside; where neither is,
    it comes out by c L²/8 at most, which may be as much as the slack.
    """
    a = here
    b = here
    bracketed = int(0)
    step = int(0)
    while step < FOLLOW_STEPS:
        depth = -a.f
        rise = a.steep * way
        if bracketed == 1:
            width = wp.abs(b.tau - a.tau)
            if depth <= SETTLED or width <= SETTLED:
                return a
            move = width * depth / (depth + b.f)
            if step % 3 == 0:
                move = f64(0.5) * width
        else:
            if depth <= SETTLED and rise > f64(0.0):
                return a
            move = wp.max(depth, wp.sqrt(wp.max(depth, f64(4.0) * slack) * a.r))
            move = wp.min(move, f64(0.5) * a.r)
            if rise > f64(0.0):
                move = wp.min(move, depth / rise)
        g = gap_of(ring, motion, row, origin, direction, a.x, a.tau + way * move)
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
) -> End:  # fmt: skip
    """Where the sweep that holds a hit ends, onward (way 1) or back (-1) along the ray."""
    end = End()
    here = hit
    round = int(0)
    while round < ROUNDS and end.converged == 0:
        here = deepest(ring, motion, row, origin, direction, here)
        if round > 0 and here.f > f64(-4.0) * SETTLED:
            end.converged = 1
        else:
            here = follow(ring, motion, row, origin, direction, here, way, slack)
        round += 1
    end.tau = here.tau
    return end
