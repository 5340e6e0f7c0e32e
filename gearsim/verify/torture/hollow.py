"""The certificates for a ring, whose section is convex and whose body is not.

A plane with nr >= 0 holds the whole body, as in separation.py. One of the hole's side holds the section only: its
distance nr r + nz z - h is bounded by r <= (r² + r0²) / (2 r0), which is exact where r = r0, and leaves
    S(x, tau) = nr (q² - z² + r0²) / (2 r0) + nz z - h,
a polynomial in x again, and concave in tau. Boxes of poses and points are halved where their bound does not do.
"""

import warp as wp

from gearsim.verify.torture.separation import (
    CLEAR,
    HIT,
    Look,
    Path,
    Place,
    Tools,
    look_at,
    lowest,
    place_of,
    taylor,
    third,
)

f64 = wp.float64

wp.set_module_options({"enable_backward": False})

DEEPEST_BOX = wp.constant(62)
MAX_BOXES = wp.constant(100000)
UNDECIDED = wp.constant(2)


@wp.struct
class Met:
    """CLEAR, HIT at pose ``x`` and point ``tau``, or UNDECIDED; ``boxes`` looked at."""

    state: wp.int32
    x: f64
    half: f64
    tau: f64
    boxes: wp.int32


@wp.func
def hole_taylor(g: Look, r0: f64, place: Place, point: wp.vec3d) -> wp.vec3d:
    """S of a plane on the hole's side at a ray's point, and its first two derivatives by x."""
    q = point - place.tip
    z = wp.dot(q, place.axis)
    z1 = wp.dot(q, place.axis1) - wp.dot(place.tip1, place.axis)
    z2 = wp.dot(q, place.axis2) - f64(2.0) * wp.dot(place.tip1, place.axis1) - wp.dot(place.tip2, place.axis)
    s0 = wp.length_sq(q) - z * z * (f64(2.0) - wp.length_sq(place.axis))
    s1 = f64(-2.0) * (wp.dot(q, place.tip1) + z * z1)
    s2 = f64(2.0) * (wp.length_sq(place.tip1) - wp.dot(q, place.tip2) - z1 * z1 - z * z2)
    k = f64(0.5) * g.nr / r0
    return wp.vec3d(k * (s0 + r0 * r0) + g.nz * z - g.h, k * s1 + g.nz * z1, k * s2 + g.nz * z2)


@wp.func
def hole_third(path: Path, row: int, far: f64, r0: f64) -> f64:
    """Bound of the third derivative of S on the hole's side by x."""
    t1 = path.bounds[row, 0]
    t2 = path.bounds[row, 1]
    t3 = path.bounds[row, 2]
    a1 = path.bounds[row, 3]
    a2 = path.bounds[row, 4]
    a3 = path.bounds[row, 5]
    z1 = t1 + far * a1
    z2 = t2 + f64(2.0) * t1 * a1 + far * a2
    z3 = t3 + f64(3.0) * (t2 * a1 + t1 * a2) + far * a3
    squares = f64(6.0) * (t1 * t2 + z1 * z2) + f64(2.0) * far * (t3 + z3)
    return f64(1.001) * (f64(0.5) * squares / r0 + z3)


@wp.func
def hole_bound(
    g: Look, place: Place, path: Path, row: int, far: f64, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, half: f64,
) -> f64:  # fmt: skip
    """Least distance that one plane leaves to a piece [lo, hi] of a ray over a cell of poses."""
    first = origin + lo * direction
    last = origin + hi * direction
    cube = half * half * half / f64(6.0)
    if g.nr >= f64(0.0):
        low = wp.min(lowest(taylor(g, place, first), half), lowest(taylor(g, place, last), half))
        return low - third(path, row, far, half) * cube
    q = origin + g.tau * direction - place.tip
    r0 = wp.length(q - wp.dot(q, place.axis) * place.axis)
    low = wp.min(lowest(hole_taylor(g, r0, place, first), half), lowest(hole_taylor(g, r0, place, last), half))
    return low - hole_third(path, row, far, r0) * cube


@wp.func
def met_in_row(
    tools: Tools, body: int, path: Path, row: int, far: f64, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, level: f64, slack: f64,
) -> Met:  # fmt: skip
    """Whether a ring comes nearer than ``level`` [mm] to the piece [lo, hi] of a ray anywhere in a row."""
    out = Met()
    depth = int(0)
    along = wp.int64(0)
    upper = wp.int64(0)
    one = wp.int64(1)
    while depth >= 0:
        x = f64(0.0)
        half = f64(1.0)
        tau = f64(0.5) * (lo + hi)
        length = f64(0.5) * (hi - lo)
        for k in range(depth):
            way = f64(-1.0)
            if ((upper >> wp.int64(k)) & one) == one:
                way = f64(1.0)
            if ((along >> wp.int64(k)) & one) == one:
                length = f64(0.5) * length
                tau += way * length
            else:
                half = f64(0.5) * half
                x += way * half
        place = place_of(path, row, x)
        g = look_at(tools, body, place, origin, direction, tau)
        out.boxes += 1
        if g.f < level:
            out.state = HIT
            out.x = x
            out.half = half
            out.tau = tau
            return out
        if out.boxes >= MAX_BOXES:
            out.state = UNDECIDED
            return out
        clear = (
            hole_bound(g, place, path, row, far, origin, direction, tau - length, tau + length, half) >= level - slack
        )
        if clear or depth == DEEPEST_BOX:
            if not clear:
                out.state = UNDECIDED
            while depth > 0 and ((upper >> wp.int64(depth - 1)) & one) == one:
                depth -= 1
            if depth == 0:
                return out
            upper = (upper | (one << wp.int64(depth - 1))) & ((one << wp.int64(depth)) - one)
        else:
            rate = taylor(g, place, origin + tau * direction)
            by_x = wp.abs(rate[1]) * half + (wp.abs(rate[2]) + path.bounds[row, 0] * path.bounds[row, 0] / far) * half * half
            by_tau = (wp.abs(g.slope) + length / far) * length
            along = along & ((one << wp.int64(depth)) - one)
            upper = upper & ((one << wp.int64(depth)) - one)
            if by_tau > by_x:
                along = along | (one << wp.int64(depth))
            depth += 1
    return out


@wp.func
def followed(
    tools: Tools, body: int, place: Place, origin: wp.vec3d, direction: wp.vec3d, start: f64, end: f64, level: f64
) -> f64:
    """How far from ``start`` towards ``end`` a ray stays in a ring grown by ``level`` at a pose.

    The distance changes no faster than the way, and bends down no more than 1/r.
    """
    way = wp.sign(end - start)
    g = look_at(tools, body, place, origin, direction, start)
    step = int(0)
    while step < 80 and g.f < level and (end - g.tau) * way > f64(0.0):
        depth = level - g.f
        q = origin + g.tau * direction - place.tip
        r = wp.length(q - wp.dot(q, place.axis) * place.axis)
        jump = f64(0.5) * r
        if g.slope * way > f64(0.0):
            jump = wp.min(jump, f64(0.9) * depth / (g.slope * way))
        jump = wp.min(jump, wp.abs(end - g.tau))
        next = look_at(tools, body, place, origin, direction, g.tau + way * jump)
        trial = int(0)
        while trial < 8 and wp.max(g.f, next.f) + jump * jump / (f64(4.0) * r) > level and jump > depth:
            jump = f64(0.4) * jump
            next = look_at(tools, body, place, origin, direction, g.tau + way * jump)
            trial += 1
        if wp.max(g.f, next.f) + jump * jump / (f64(4.0) * r) > level:
            jump = wp.min(depth, wp.abs(end - g.tau))
            next = look_at(tools, body, place, origin, direction, g.tau + way * jump)
        if next.tau == g.tau:
            return g.tau
        g = next
        step += 1
    return g.tau
