"""Certificates that a piece of a ray stays out of a moving body: separating planes carried along by the tool.

The only mathematics is the supporting plane. A plane with meridian normal (nr, nz), nr >= 0, in the direction u
across the axis, holds the body at every pose; a ray's point p sees it at the distance
    S(x, tau) = nr u . w + nz z - h,   q = p(tau) - tip(x),  z = q . a(x),  w = q - z a(x),
which is never more than the distance to the body. S is a polynomial in the pose's x, and linear in tau. Around a
pose its Taylor series to the second degree, less a bound of the third derivative, is what a cell of poses is
judged by; cells that are neither clear nor hit are halved.
"""

import warp as wp

f64 = wp.float64

wp.set_module_options({"enable_backward": False})

CLEAR = wp.constant(0)
HIT = wp.constant(1)
SPLIT = wp.constant(2)
CUTS = wp.constant(40)
SLACK = wp.constant(f64(0.05))


@wp.struct
class Tools:
    """Convex bodies of all jobs' tools (meridian.py) from ``first`` [job] on; ``reach`` [mm]; ``hollow``: rings."""

    planes: wp.array2d(dtype=f64)
    wedges: wp.array2d(dtype=f64)
    plane_first: wp.array(dtype=wp.int32)
    wedge_first: wp.array(dtype=wp.int32)
    first: wp.array(dtype=wp.int32)
    reach: wp.array(dtype=f64)
    hollow: wp.array(dtype=wp.int32)


@wp.struct
class Path:
    """Quintic rows of all jobs; ``bounds`` row: |tip'|, |tip''|, |tip'''|, |axis'|, |axis''|, |axis'''| on [-1, 1]."""

    tip: wp.array2d(dtype=wp.vec3d)
    axis: wp.array2d(dtype=wp.vec3d)
    bounds: wp.array2d(dtype=f64)
    first: wp.array(dtype=wp.int32)


@wp.struct
class Place:
    """Tip and axis at a pose with their first and second derivatives."""

    tip: wp.vec3d
    tip1: wp.vec3d
    tip2: wp.vec3d
    axis: wp.vec3d
    axis1: wp.vec3d
    axis2: wp.vec3d


@wp.struct
class Look:
    """The distance f of the ray's point tau to a body, its slope along the ray, and the plane that gives it."""

    tau: f64
    f: f64
    slope: f64
    u: wp.vec3d
    nr: f64
    nz: f64
    h: f64


@wp.struct
class Verdict:
    """CLEAR, HIT (at ``tau``) or SPLIT."""

    state: wp.int32
    tau: f64


@wp.func
def place_of(path: Path, row: int, x: f64) -> Place:
    """Pose of a row at x: Horner's rule with two derivatives."""
    zero = wp.vec3d(f64(0.0), f64(0.0), f64(0.0))
    p = Place()
    p.tip1 = zero
    p.tip2 = zero
    p.axis1 = zero
    p.axis2 = zero
    p.tip = zero
    p.axis = zero
    for i in range(6):
        k = 5 - i
        p.tip2 = p.tip2 * x + f64(2.0) * p.tip1
        p.axis2 = p.axis2 * x + f64(2.0) * p.axis1
        p.tip1 = p.tip1 * x + p.tip
        p.axis1 = p.axis1 * x + p.axis
        p.tip = p.tip * x + path.tip[row, k]
        p.axis = p.axis * x + path.axis[row, k]
    return p


@wp.func
def across_of(w: wp.vec3d, r: f64, a: wp.vec3d) -> wp.vec3d:
    """The unit vector across a that w, of length r, points along; any where w is but rounding."""
    if r > f64(0.0):
        u = w / r
        u = u - wp.dot(u, a) * a
        size = wp.length(u)
        if size > f64(0.5):
            return u / size
    e = wp.vec3d(f64(1.0), f64(0.0), f64(0.0))
    if wp.abs(a[0]) > f64(0.7):
        e = wp.vec3d(f64(0.0), f64(1.0), f64(0.0))
    return wp.normalize(e - wp.dot(e, a) * a)


@wp.func
def look_at(tools: Tools, body: int, place: Place, origin: wp.vec3d, direction: wp.vec3d, tau: f64) -> Look:
    """Distance of a ray's point to a body at a pose: the largest of those from its supporting planes."""
    q = origin + tau * direction - place.tip
    z = wp.dot(q, place.axis)
    w = q - z * place.axis
    r = wp.length(w)
    best = f64(-1.0e300)
    nr = f64(0.0)
    nz = f64(1.0)
    for i in range(tools.plane_first[body], tools.plane_first[body + 1]):
        over = tools.planes[i, 0] * r + tools.planes[i, 1] * z - tools.planes[i, 2]
        if over > best:
            best = over
            nr = tools.planes[i, 0]
            nz = tools.planes[i, 1]
    for i in range(tools.wedge_first[body], tools.wedge_first[body + 1]):
        dr = r - tools.wedges[i, 0]
        dz = z - tools.wedges[i, 1]
        if tools.wedges[i, 3] * dz - tools.wedges[i, 4] * dr >= f64(0.0) and tools.wedges[i, 6] * dr - tools.wedges[
            i, 5
        ] * dz >= f64(0.0):
            size = wp.sqrt(dr * dr + dz * dz)
            if size - tools.wedges[i, 2] > best and size > f64(0.0):
                best = size - tools.wedges[i, 2]
                nr = dr / size
                nz = dz / size
    g = Look()
    g.tau = tau
    g.f = best
    g.nr = nr
    g.nz = nz
    g.h = nr * r + nz * z - best
    g.u = across_of(w, r, place.axis)
    rise = wp.dot(place.axis, direction)
    g.slope = nr * (wp.dot(g.u, direction) - rise * wp.dot(g.u, place.axis)) + nz * rise
    return g


@wp.func
def taylor(g: Look, place: Place, point: wp.vec3d) -> wp.vec3d:
    """S of a plane at a ray's point, and its first two derivatives by x."""
    q = point - place.tip
    z = wp.dot(q, place.axis)
    z1 = wp.dot(q, place.axis1) - wp.dot(place.tip1, place.axis)
    z2 = wp.dot(q, place.axis2) - f64(2.0) * wp.dot(place.tip1, place.axis1) - wp.dot(place.tip2, place.axis)
    a = wp.dot(g.u, place.axis)
    a1 = wp.dot(g.u, place.axis1)
    a2 = wp.dot(g.u, place.axis2)
    out = wp.dot(g.u, q) - z * a
    out1 = -wp.dot(g.u, place.tip1) - z1 * a - z * a1
    out2 = -wp.dot(g.u, place.tip2) - z2 * a - f64(2.0) * z1 * a1 - z * a2
    return wp.vec3d(g.nr * out + g.nz * z - g.h, g.nr * out1 + g.nz * z1, g.nr * out2 + g.nz * z2)


@wp.func
def third(path: Path, row: int, far: f64, half: f64) -> f64:
    """Bound of the third derivative of S by x, for points within ``far`` of the tip and poses within ``half``."""
    t1 = path.bounds[row, 0]
    t2 = path.bounds[row, 1]
    t3 = path.bounds[row, 2]
    a1 = path.bounds[row, 3]
    a2 = path.bounds[row, 4]
    a3 = path.bounds[row, 5]
    z1 = t1 + far * a1
    z2 = t2 + f64(2.0) * t1 * a1 + far * a2
    z3 = t3 + f64(3.0) * (t2 * a1 + t1 * a2) + far * a3
    out3 = t3 + z3 * wp.min(f64(1.0), a1 * half) + f64(3.0) * (z2 * a1 + z1 * a2) + far * a3
    return f64(1.001) * (z3 + out3)


@wp.func
def lowest(c: wp.vec3d, half: f64) -> f64:
    """Least value of c0 + c1 s + c2 s²/2 for |s| <= half."""
    low = c[0] - wp.abs(c[1]) * half + f64(0.5) * c[2] * half * half
    if c[2] > f64(0.0) and wp.abs(c[1]) < c[2] * half:
        low = c[0] - f64(0.5) * c[1] * c[1] / c[2]
    return low


@wp.func
def bound_by_one(g: Look, place: Place, first: wp.vec3d, last: wp.vec3d, half: f64, rest: f64) -> f64:
    """Least distance that a plane leaves to a piece of a ray over a cell."""
    return wp.min(lowest(taylor(g, place, first), half), lowest(taylor(g, place, last), half)) - rest


@wp.func
def bound_by_two(
    a: Look, b: Look, share: f64, tau: f64, place: Place, origin: wp.vec3d, direction: wp.vec3d, lo: f64, hi: f64,
    half: f64, rest: f64,
) -> f64:  # fmt: skip
    """Least distance that planes on both sides of the nearest point leave to a piece [lo, hi] of a ray over a cell.

    Each rules on its side of ``tau``, where they cross; near it, as far as the crossing may wander, their mean with
    ``share`` of the second does, which is level along the ray.
    """
    here = origin + tau * direction
    wander = wp.max(wp.abs(taylor(a, place, here)[1]), wp.abs(taylor(b, place, here)[1]))
    wander = f64(2.0) * half * wander / wp.min(-a.slope, b.slope)
    left = wp.max(lo, tau - wander)
    right = wp.min(hi, tau + wander)
    p = origin + left * direction
    q = origin + right * direction
    a_left = taylor(a, place, p)
    b_right = taylor(b, place, q)
    keep = f64(1.0) - share
    bound = wp.min(
        lowest(keep * a_left + share * taylor(b, place, p), half),
        lowest(keep * taylor(a, place, q) + share * b_right, half),
    )
    if left > lo:
        bound = wp.min(bound, wp.min(lowest(a_left, half), lowest(taylor(a, place, origin + lo * direction), half)))
    if right < hi:
        bound = wp.min(bound, wp.min(lowest(b_right, half), lowest(taylor(b, place, origin + hi * direction), half)))
    return bound - rest


@wp.func
def judge_cell(
    tools: Tools, body: int, place: Place, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, half: f64, rest: f64, level: f64, slack: f64,
) -> Verdict:  # fmt: skip
    """Whether a piece [lo, hi] of a ray stays ``level`` [mm] away from a body over a cell of poses.

    HIT: at the cell's middle pose a point is nearer. Along the ray the distance is convex: it is cut at the
    crossing of the planes on both sides of its least value until the bound suffices.
    """
    out = Verdict()
    out.state = SPLIT
    first = origin + lo * direction
    last = origin + hi * direction
    a = look_at(tools, body, place, origin, direction, lo)
    b = a
    here = a
    one = int(0)
    if lo == hi or a.slope >= f64(0.0):
        one = 1
    cut = int(0)
    while cut < CUTS:
        if here.f < level:
            out.state = HIT
            out.tau = here.tau
            return out
        if one == 1:
            if bound_by_one(here, place, first, last, half, rest) >= level - slack:
                out.state = CLEAR
            return out
        if cut == 0:
            b = look_at(tools, body, place, origin, direction, hi)
            here = b
            if b.slope <= f64(0.0):
                one = 1
        else:
            share = -a.slope / (b.slope - a.slope)
            floor = (f64(1.0) - share) * (a.f - a.slope * a.tau) + share * (b.f - b.slope * b.tau)
            tau = b.tau - (b.f - a.f - a.slope * (b.tau - a.tau)) / (b.slope - a.slope)
            tau = wp.clamp(tau, a.tau, b.tau)
            if bound_by_two(a, b, share, tau, place, origin, direction, lo, hi, half, rest) >= level - slack:
                out.state = CLEAR
                return out
            least = wp.min(a.f, b.f)
            if floor >= level and least - floor <= f64(0.25) * (floor - level):
                return out
            width = b.tau - a.tau
            if cut % 3 == 2:
                tau = a.tau + share * width
            if cut % 5 == 4:
                tau = f64(0.5) * (a.tau + b.tau)
            tau = wp.clamp(tau, a.tau + f64(1.0e-3) * width, b.tau - f64(1.0e-3) * width)
            here = look_at(tools, body, place, origin, direction, tau)
            if here.slope < f64(0.0):
                a = here
            else:
                b = here
        cut += 1
    return out
