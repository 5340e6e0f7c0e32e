"""The earliest entry of a ray into the cutter over a part of one segment.

Let F(x, tau) be the signed distance of the ray's point tau to the cutter at pose x. For a convex cutter F
is the largest of linear functions of the point seen from the tool, so it is semi-convex: with K the bound
on that point's second derivative and w the axis rate,
    F(x + s, tau + u) >= F + F_x s + F_tau u - K s²/2 - w |s u|.
This bounds from below how early the ray can be entered near a known pose; the search for the earliest
entry stops when such bounds leave no room for more than the tolerance.
"""

import warp as wp

from gearsim.kernels.contact import Contact, chord_at, side_of
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import FAR, TINY, Cutter

f64 = wp.float64

DESCEND = wp.constant(0)
MARCH_RIGHT = wp.constant(1)
MARCH_LEFT = wp.constant(2)
DONE = wp.constant(3)

MAX_EVALUATIONS = wp.constant(400)
FLOOR_STEPS = wp.constant(f64(128.0))


@wp.struct
class Extreme:
    """The earliest entry on a bracket; the run of hits that holds it spans [from_x, to_x].

    ``gap`` 1: between two ends that hit, to_x misses, and nothing else is known.
    """

    tau: f64
    from_x: f64
    to_x: f64
    gap: wp.int32
    converged: wp.int32


@wp.struct
class Search:
    """State of a search: the bracket [a, b] of the descent, the earliest contact ``best``, and ``here``,
    up to which a march has come; ``x`` is where to look next. An entry as early as ``known`` is in the ray's
    list already. The rest as in Extreme.
    """

    phase: wp.int32
    a: Contact
    b: Contact
    best: Contact
    here: Contact
    x: f64
    from_x: f64
    to_x: f64
    gap: wp.int32
    known: f64


@wp.func
def certified_reach(push: f64, steep: f64, room: f64, curvature: f64, spin: f64, slack: f64) -> f64:
    """How far from a contact no entry can come earlier than ``room`` before it.

    ``push`` is F_x in the direction of travel; ``slack`` is the penetration [mm] that is let pass.
    """
    q = push - room * spin
    offer = f64(2.0) * (room * steep + slack)
    root = wp.sqrt(q * q + curvature * offer)
    if q >= f64(0.0):
        reach = (q + root) / wp.max(curvature, TINY)
    else:
        reach = offer / (root - q)
    return wp.min(reach, steep / wp.max(spin, TINY))


@wp.func
def slope(c: Contact) -> f64:
    """Derivative of the entry by x at a contact."""
    return c.push / wp.max(c.steep, TINY)


@wp.func
def lower_bound(a: Contact, b: Contact, curvature: f64, spin: f64) -> wp.vec2d:
    """Where the bounds from two contacts that straddle a minimum meet, and the earliest entry they allow.

    From a contact, an entry s onward is earlier by at most (|push| s + K s²/2) / (steep - w s).
    """
    width = b.x - a.x
    steep_a = a.steep - spin * width
    steep_b = b.steep - spin * width
    if steep_a <= TINY or steep_b <= TINY:
        return wp.vec2d(f64(0.5) * (a.x + b.x), -FAR)
    slope_a = a.push / steep_a
    slope_b = b.push / steep_b
    bend_a = curvature / steep_a
    bend_b = curvature / steep_b
    over = a.tau - b.tau + slope_b * width + f64(0.5) * bend_b * width * width
    fall = slope_b - slope_a + bend_b * width
    four_ac = f64(2.0) * (bend_b - bend_a) * over
    s = f64(2.0) * over / (fall + wp.sqrt(wp.max(fall * fall - four_ac, f64(0.0))))
    s = wp.clamp(s, f64(0.0), width)
    return wp.vec2d(a.x + s, a.tau + slope_a * s - f64(0.5) * bend_a * s * s)


@wp.func
def cubic_minimum(a: Contact, b: Contact) -> f64:
    """Minimiser of the cubic through two contacts with slopes of opposite sign, a to the left."""
    slope_a = slope(a)
    slope_b = slope(b)
    d1 = slope_a + slope_b - f64(3.0) * (a.tau - b.tau) / (a.x - b.x)
    d2 = wp.sqrt(wp.max(d1 * d1 - slope_a * slope_b, f64(0.0)))
    return b.x - (b.x - a.x) * (slope_b + d2 - d1) / (slope_b - slope_a + f64(2.0) * d2)


@wp.func
def straddles(a: Contact, b: Contact) -> bool:
    """Whether the entry falls from a and rises to b."""
    return a.found == 1 and b.found == 1 and a.push < f64(0.0) and b.push > f64(0.0)


@wp.func
def descent_point(a: Contact, b: Contact, known: f64, tolerance: f64, curvature: f64, spin: f64, turn: int) -> wp.vec2d:
    """Where to look next for a minimum between a and b, and 1 where no more than the tolerance is left.

    A guess close to one end is moved past the minimum, so that both ends close in on it.
    """
    width = b.x - a.x
    x = f64(0.5) * (a.x + b.x)
    finished = width < TINY
    if a.tau <= b.tau:
        finished = finished or a.push >= f64(0.0)
    else:
        finished = finished or b.push <= f64(0.0)
    if not finished and straddles(a, b):
        bound = lower_bound(a, b, curvature, spin)
        finished = wp.min(wp.min(a.tau, b.tau), known) - bound[1] < f64(0.5) * tolerance
        if turn % 3 == 0:
            x = cubic_minimum(a, b)
        elif turn % 3 == 1:
            x = bound[0]
        if x - a.x < f64(0.1) * width:
            x = f64(2.0) * x - a.x
        elif b.x - x < f64(0.1) * width:
            x = f64(2.0) * x - b.x
    if finished:
        return wp.vec2d(x, f64(1.0))
    margin = f64(1.0e-3) * width
    return wp.vec2d(wp.clamp(x, a.x + margin, b.x - margin), f64(0.0))


@wp.func
def replaces_left(a: Contact, b: Contact, at: Contact) -> bool:
    """Whether a point between a and b becomes the bracket's left end, so that a minimum stays inside.

    Of two minima that of the earlier end stays: a ray in the plane of a disc that tilts is entered elsewhere
    at once.
    """
    if straddles(a, b):
        if a.tau <= b.tau:
            return at.push < f64(0.0) and at.tau <= a.tau
        return at.push < f64(0.0) or at.tau > b.tau
    if a.tau <= b.tau:
        return at.tau < a.tau and at.push < f64(0.0)
    return at.tau >= b.tau or at.push <= f64(0.0)


@wp.func
def march_point(
    here: Contact, end: Contact, best: f64, tolerance: f64, curvature: f64, spin: f64, floor: f64
) -> wp.vec2d:
    """Where to look next on the way from here to the end, and 1 where the rest is certified (else 0)."""
    forward = wp.sign(end.x - here.x)
    slack = f64(0.1) * tolerance
    room = wp.max(here.tau - best, f64(0.0)) + tolerance
    reach = certified_reach(forward * here.push, here.steep, room, curvature, spin, slack)
    left_over = wp.abs(end.x - here.x)
    if end.found == 1:
        room = wp.max(end.tau - best, f64(0.0)) + tolerance
        left_over -= certified_reach(-forward * end.push, end.steep, room, curvature, spin, slack)
    reach = wp.max(reach, floor)
    if reach >= left_over:
        return wp.vec2d(end.x, f64(1.0))
    return wp.vec2d(here.x + forward * reach, f64(0.0))


@wp.func
def start_search(
    left: Contact, right: Contact, known: f64, enough: f64, tolerance: f64, curvature: f64, spin: f64
) -> Search:  # fmt: skip
    """A descent in the bracket [left, right], or nothing left to do where its ends certify that."""
    s = Search()
    s.phase = DESCEND
    s.a = left
    s.b = right
    s.best = left
    if right.tau < left.tau:
        s.best = right
    s.here = s.best
    s.from_x = left.x
    s.to_x = right.x
    s.known = known
    if wp.min(s.best.tau, known) < enough:
        s.phase = DONE
        return s
    here = left
    end = right
    if left.found == 0:
        here = right
        end = left
    if march_point(here, end, wp.min(s.best.tau, known), tolerance, curvature, spin, f64(0.0))[1] == f64(1.0):
        s.phase = DONE
    return s


@wp.func
def aim(
    s: Search, left: Contact, right: Contact, enough: f64, tolerance: f64, curvature: f64, spin: f64, turn: int
) -> Search:  # fmt: skip
    """Choose where to look next, going on to the next phase where one has nothing left to look for."""
    best = wp.min(s.best.tau, s.known)
    if best < enough:
        s.phase = DONE
        return s
    floor = (right.x - left.x) / FLOOR_STEPS
    next = wp.vec2d(f64(0.0), f64(1.0))
    if s.phase == DESCEND:
        next = descent_point(s.a, s.b, s.known, tolerance, curvature, spin, turn)
        if next[1] == f64(1.0):
            s.phase = MARCH_RIGHT
            if not straddles(s.a, s.b):
                s.a = s.best
                s.b = s.best
            s.here = s.b
    if s.phase == MARCH_RIGHT:
        next = march_point(s.here, right, best, tolerance, curvature, spin, floor)
        if next[1] == f64(1.0):
            s.phase = MARCH_LEFT
            s.here = s.a
    if s.phase == MARCH_LEFT:
        next = march_point(s.here, left, best, tolerance, curvature, spin, floor)
        if next[1] == f64(1.0):
            s.phase = DONE
    s.x = next[0]
    return s


@wp.func
def take(s: Search, at: Contact, left: Contact, right: Contact, tolerance: f64) -> Search:
    """Draw the conclusions from what was found at the point aimed at."""
    if at.found == 0 and left.found == 1 and right.found == 1:
        s.gap = 1
        s.to_x = at.x
        s.phase = DONE
        return s
    earlier = at.tau < wp.min(s.best.tau, s.known) - f64(0.5) * tolerance
    if at.tau < s.best.tau:
        s.best = at
    if s.phase == DESCEND:
        if replaces_left(s.a, s.b, at):
            s.a = at
        else:
            s.b = at
    elif at.found == 0 and s.phase == MARCH_RIGHT:
        s.to_x = at.x
        s.phase = MARCH_LEFT
        s.here = s.a
    elif at.found == 0:
        s.from_x = at.x
        s.phase = DONE
    elif earlier and s.phase == MARCH_RIGHT:
        s.a = at
        s.b = right
        s.phase = DESCEND
    elif earlier:
        s.a = left
        s.b = at
        s.phase = DESCEND
    else:
        s.here = at
    return s


@wp.func
def earliest_entry(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, side: int,
    left: Contact, right: Contact, known: f64, enough: f64, tolerance: f64,
) -> Extreme:  # fmt: skip
    """Earliest entry over [left.x, right.x], of which at least one end hits.

    Descends to the minimum inside a bracket, then marches from it to both ends by certified reaches;
    meeting something earlier, it descends again from there. A miss ends the march, for the run of hits
    is over; between two ends that hit it is a gap, and the search stops for the caller to split there.
    An entry is not looked for if it is no earlier than ``known`` (what the list holds around one of the
    ends), and none is once one is earlier than ``enough`` (where the ray's window begins).
    """
    s = start_search(left, right, known, enough, tolerance, motion.acceleration[row], motion.spin[row])
    evaluations = int(0)
    while evaluations < MAX_EVALUATIONS and s.phase != DONE:
        s = aim(s, left, right, enough, tolerance, motion.acceleration[row], motion.spin[row], evaluations)
        if s.phase != DONE:
            at = side_of(chord_at(cutter, motion, row, origin, direction, s.x), side)
            evaluations += 1
            s = take(s, at, left, right, tolerance)
    out = Extreme()
    out.tau = s.best.tau
    out.from_x = s.from_x
    out.to_x = s.to_x
    out.gap = s.gap
    if s.phase == DONE:
        out.converged = 1
    return out
