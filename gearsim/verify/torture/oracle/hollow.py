"""The certificates for a ring, whose section is convex and whose body is not.

Outside of the body with its hole filled, separation.py does. A plane of the hole's side, nr < 0, holds the section
only: its distance nr r + nz z - h is bounded by r <= u . w + (v . w)² / (2 u . w) + ..., u being the direction
across the axis where the plane touches, v the one around it: a polynomial in x again, and concave in tau. Boxes of
poses and points are halved where no bound does.
"""

import warp as wp

from gearsim.verify.torture.oracle.separation import (
    CLEAR,
    HIT,
    Look,
    Path,
    Place,
    Tools,
    judge_cell,
    look_at,
    lowest,
    place_of,
    taylor,
    third,
)

f64 = wp.float64

wp.set_module_options({"enable_backward": False})

DEEPEST_BOX = wp.constant(100)
WORD = wp.constant(50)
ONE = wp.constant(wp.int64(1))
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
def hole_series(g: Look, v: wp.vec3d, u_least: f64, place: Place, point: wp.vec3d) -> wp.vec3d:
    """S of a plane on the hole's side at a ray's point, and its first two derivatives by x."""
    s = taylor(g, place, point)
    around = g
    around.u = v
    around.nr = f64(1.0)
    around.nz = f64(0.0)
    around.h = f64(0.0)
    c = taylor(around, place, point)
    k = f64(0.5) * g.nr / u_least
    return s + k * wp.vec3d(c[0] * c[0], f64(2.0) * c[0] * c[1], f64(2.0) * (c[1] * c[1] + c[0] * c[2]))


@wp.func
def across_series(g: Look, place: Place, point: wp.vec3d) -> wp.vec3d:
    """u . w at a ray's point, and its first two derivatives by x."""
    out = g
    out.nr = f64(1.0)
    out.nz = f64(0.0)
    out.h = f64(0.0)
    return taylor(out, place, point)


@wp.func
def hole_bound(
    g: Look, place: Place, path: Path, row: int, far: f64, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, half: f64,
) -> f64:  # fmt: skip
    """Least distance that one plane leaves to a piece [lo, hi] of a ray over a cell of poses."""
    first = origin + lo * direction
    last = origin + hi * direction
    cube = half * half * half / f64(6.0)
    k3 = third(path, row, far, half)
    if g.nr >= f64(0.0):
        return wp.min(lowest(taylor(g, place, first), half), lowest(taylor(g, place, last), half)) - k3 * cube
    u_least = wp.min(
        lowest(across_series(g, place, first), half), lowest(across_series(g, place, last), half)
    ) - k3 * cube  # fmt: skip
    if u_least <= f64(0.0):
        return f64(-1.0e300)
    v = wp.normalize(wp.cross(place.axis, g.u))
    t1 = path.bounds[row, 0] + f64(2.0) * far * path.bounds[row, 3]
    t2 = (
        path.bounds[row, 1]
        + f64(4.0) * path.bounds[row, 0] * path.bounds[row, 3]
        + far * (f64(2.0) * path.bounds[row, 4] + f64(2.0) * path.bounds[row, 3] * path.bounds[row, 3])
    )
    bend = k3 - f64(0.5) * g.nr / u_least * (f64(6.0) * t1 * t2 + f64(2.0) * far * k3)
    tilt = far * path.bounds[row, 3] * half
    low = wp.min(
        lowest(hole_series(g, v, u_least, place, first), half), lowest(hole_series(g, v, u_least, place, last), half)
    )
    return low - bend * cube + f64(0.51) * g.nr / u_least * tilt * tilt


@wp.struct
class Bits:
    """A hundred bits in two words."""

    low: wp.int64
    high: wp.int64


@wp.func
def bit(bits: Bits, k: int) -> bool:
    """Whether bit k is set."""
    if k < WORD:
        return ((bits.low >> wp.int64(k)) & ONE) == ONE
    return ((bits.high >> wp.int64(k - WORD)) & ONE) == ONE


@wp.func
def with_bit(bits: Bits, k: int, value: bool) -> Bits:
    """The bits with bit k set to a value."""
    if k < WORD:
        bits.low = bits.low & (~(ONE << wp.int64(k)))
        if value:
            bits.low = bits.low | (ONE << wp.int64(k))
    else:
        bits.high = bits.high & (~(ONE << wp.int64(k - WORD)))
        if value:
            bits.high = bits.high | (ONE << wp.int64(k - WORD))
    return bits


@wp.func
def met_in_row(
    tools: Tools, body: int, path: Path, row: int, far: f64, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, level: f64, slack: f64,
) -> Met:  # fmt: skip
    """Whether a ring comes nearer than ``level`` [mm] to the piece [lo, hi] of a ray anywhere in a row."""
    out = Met()
    depth = int(0)
    along = Bits()
    upper = Bits()
    while depth >= 0:
        x = f64(0.0)
        half = f64(1.0)
        tau = f64(0.5) * (lo + hi)
        length = f64(0.5) * (hi - lo)
        for k in range(depth):
            way = f64(-1.0)
            if bit(upper, k):
                way = f64(1.0)
            if bit(along, k):
                length = f64(0.5) * length
                tau += way * length
            else:
                half = f64(0.5) * half
                x += way * half
        place = place_of(path, row, x)
        out.boxes += 1
        rest = third(path, row, far, half) * half * half * half / f64(6.0)
        clear = (
            judge_cell(
                tools, body + 1, place, origin, direction, tau - length, tau + length, half, rest, level, slack
            ).state
            == CLEAR
        )  # fmt: skip
        g = look_at(tools, body, place, origin, direction, tau)
        if not clear and g.f < level:
            out.state = HIT
            out.x = x
            out.half = half
            out.tau = tau
            return out
        if out.boxes >= MAX_BOXES:
            out.state = UNDECIDED
            return out
        if not clear:
            bound = hole_bound(g, place, path, row, far, origin, direction, tau - length, tau + length, half)
            fastest = path.bounds[row, 0] + far * path.bounds[row, 3]
            clear = wp.max(bound, g.f - fastest * half - length) >= level - slack
        if clear or depth == DEEPEST_BOX:
            if not clear:
                out.state = UNDECIDED
            while depth > 0 and bit(upper, depth - 1):
                depth -= 1
            if depth == 0:
                return out
            upper = with_bit(upper, depth - 1, True)
        else:
            rate = taylor(g, place, origin + tau * direction)
            by_x = (
                wp.abs(rate[1]) * half
                + (wp.abs(rate[2]) + path.bounds[row, 0] * path.bounds[row, 0] / far) * half * half
            )
            by_tau = (wp.abs(g.slope) + length / far) * length
            along = with_bit(along, depth, by_tau > by_x)
            upper = with_bit(upper, depth, False)
            depth += 1
    return out


@wp.func
def stays(a: Look, b: Look, middle: Look, r: f64, level: f64) -> bool:
    """Whether a ray stays in a ring grown by ``level`` between two points.

    The distance along it changes no faster than the way and bends down by -nr / r at most, not at all on the outside.
    """
    jump = wp.abs(b.tau - a.tau)
    most = wp.max(a.f, b.f)
    inward = wp.max(-wp.min(wp.min(a.nr, b.nr), middle.nr), f64(0.0))
    if middle.f > level:
        return False
    return most + inward * jump * jump / (f64(4.0) * r) <= level or f64(2.0) * level - a.f - b.f >= jump


@wp.func
def followed(
    tools: Tools, body: int, place: Place, origin: wp.vec3d, direction: wp.vec3d, start: f64, end: f64, level: f64
) -> f64:  # fmt: skip
    """How far from ``start`` towards ``end`` a ray stays in a ring grown by ``level`` at a pose."""
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
        next = g
        trial = int(0)
        good = int(0)
        while trial < 40 and good == 0:
            next = look_at(tools, body, place, origin, direction, g.tau + way * jump)
            middle = look_at(tools, body, place, origin, direction, g.tau + f64(0.5) * way * jump)
            if stays(g, next, middle, r, level):
                good = 1
            else:
                jump = wp.max(f64(0.4) * jump, wp.min(f64(0.99) * depth, jump))
            trial += 1
        if good == 0 or next.tau == g.tau:
            return g.tau
        g = next
        step += 1
    return g.tau
