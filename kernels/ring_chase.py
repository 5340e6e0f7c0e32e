"""From a hit of a ring along the ray to where the segment's sweep ends.

Two steps alternate until both settle: take the pose at which the point lies deepest, and follow the ray at
that pose to the tool's surface. Where two faces of the tool take turns in stopping this, each gaining little,
the pose is taken at which both, seen as planes, let pass the farthest point. Every stretch walked lies in the
tool at some pose, so no gap is spanned.
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


@wp.struct
class Low:
    """The deepest pose found, and the poses a and b on both sides of it, last looked at; a: downhill to it."""

    best: Gap
    a: Gap
    b: Gap


@wp.func
def deepest(ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, here: Gap) -> Low:
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
        if fall * width < SETTLED:
            return low
        x = f64(0.5) * (low.a.x + low.b.x)
        if rise > f64(0.0) and step % 3 != 0:
            x = low.a.x + (low.b.x - low.a.x) * fall / (fall + rise)
    return low


@wp.func
def farthest_pose(low: Low, way: f64) -> f64:
    """The pose at which the planes that touch F on both sides of a low let pass the farthest point.

    Not quite up to where one of them keeps out the point itself.
    """
    m_a = low.a.push * low.a.x - low.a.f
    m_b = low.b.push * low.b.x - low.b.f
    det = low.a.push * low.b.steep - low.b.push * low.a.steep
    u = low.a.push * m_b - low.b.push * m_a
    if low.a.push * low.b.push >= f64(0.0) or u * det * way <= f64(0.0):
        return low.best.x
    x_a = m_a / low.a.push
    x_b = m_b / low.b.push
    margin = f64(0.01) * wp.abs(x_b - x_a)
    x = (m_a * low.b.steep - m_b * low.a.steep) / det
    x = wp.clamp(x, wp.min(x_a, x_b) + margin, wp.max(x_a, x_b) - margin)
    return wp.clamp(x, f64(-1.0), f64(1.0))


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
        low = deepest(ring, motion, row, origin, direction, here)
        here = low.best
        if round > 0 and here.f > f64(-4.0) * SETTLED:
            end.converged = 1
        else:
            if round % 2 == 1:
                far = gap_of(ring, motion, row, origin, direction, farthest_pose(low, way), here.tau)
                if far.f <= f64(0.0):
                    here = far
            here = follow(ring, motion, row, origin, direction, here, way, slack)
        round += 1
    end.tau = here.tau
    return end
