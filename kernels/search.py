"""The earliest entry of a ray into the cutter over a part of one segment.

A descent to a minimum and a march to both ends of the bracket, which stop when the bounds of kernels/bounds.py
leave no room for an entry that is earlier by more than the tolerance.
"""

import warp as wp

from gearsim.kernels.bounds import certified_reach, cubic_minimum, lower_bound
from gearsim.kernels.contact import Contact, end_at
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter
from gearsim.kernels.tool_ray import TINY, greater, lesser

f64 = wp.float64

DESCEND = wp.constant(0)
MARCH_RIGHT = wp.constant(1)
MARCH_LEFT = wp.constant(2)
DONE = wp.constant(3)

MAX_EVALUATIONS = wp.constant(120)
SLACK = wp.constant(f64(1.0e-4))
# a stride of less than two reaches is covered from its far end as well, where entries do not fall there
BOLD = wp.constant(f64(1.95))
NARROWEST = wp.constant(f64(1.0e-6))


@wp.struct
class Extreme:
    """The earliest entry on a bracket, at pose x, where the chord ends at ``far``; the run of hits that holds it
    spans [from_x, to_x].

    ``gap`` 1: between two ends that hit, to_x misses, and nothing else is known. ``certain`` 0: an earlier
    entry could not be excluded everywhere.
    """

    x: f64
    tau: f64
    far: f64
    from_x: f64
    to_x: f64
    gap: wp.int32
    certain: wp.int32


@wp.struct
class Search:
    """State of a search: the bracket [a, b] of the descent, the earliest contact ``best``, and ``here``,
    up to which a march has come; ``x`` is where to look next. An entry as early as ``known`` is in the ray's
    list already. ``stride`` is how many certified reaches a march goes at once; ``lost`` 1: one came to a
    standstill. The rest as in Extreme.
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
    lost: wp.int32
    known: f64
    stride: f64


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
        finished = lesser(lesser(a.tau, b.tau), known) - bound[1] < f64(0.5) * tolerance
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
    here: Contact, end: Contact, best: f64, tolerance: f64, curvature: f64, spin: f64, floor: f64, stride: f64
) -> wp.vec2d:
    """Where to look next on the way from here to the end, and 1 where the rest is certified (else 0).

    A stride of more than one certified reach is for the caller to check. 2 where steps get smaller than ``floor``:
    this bound does not lead to the end.
    """
    forward = wp.sign(end.x - here.x)
    slack = SLACK * tolerance
    room = greater(here.tau - best, f64(0.0)) + tolerance
    reach = certified_reach(forward * here.push, here.steep, room, curvature, spin, slack)
    left_over = wp.abs(end.x - here.x)
    if end.found == 1:
        room = greater(end.tau - best, f64(0.0)) + tolerance
        left_over -= certified_reach(-forward * end.push, end.steep, room, curvature, spin, slack)
    if reach >= left_over:
        return wp.vec2d(end.x, f64(1.0))
    if reach < floor:
        return wp.vec2d(end.x, f64(2.0))
    step = lesser(stride * reach, f64(0.5) * (reach + left_over))
    return wp.vec2d(here.x + forward * greater(step, reach), f64(0.0))


@wp.func
def follows(here: Contact, at: Contact, best: f64, tolerance: f64, curvature: f64, spin: f64) -> bool:
    """Whether the stride from here to another contact is certified from its two ends."""
    if at.found == 0:
        return False
    return march_point(here, at, best, tolerance, curvature, spin, f64(0.0), f64(1.0))[1] == f64(1.0)


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
    s.stride = BOLD
    if lesser(s.best.tau, known) < enough:
        s.phase = DONE
        return s
    here = left
    end = right
    if left.found == 0:
        here = right
        end = left
    if march_point(here, end, lesser(s.best.tau, known), tolerance, curvature, spin, f64(0.0), f64(1.0))[1] == f64(1.0):
        s.phase = DONE
    return s


@wp.func
def aim(
    s: Search, left: Contact, right: Contact, enough: f64, tolerance: f64, curvature: f64, spin: f64, turn: int
) -> Search:  # fmt: skip
    """Choose where to look next, going on to the next phase where one has nothing left to look for."""
    best = lesser(s.best.tau, s.known)
    if best < enough:
        s.phase = DONE
        return s
    floor = (right.x - left.x) * NARROWEST
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
        next = march_point(s.here, right, best, tolerance, curvature, spin, floor, s.stride)
        if next[1] == f64(1.0):
            s.phase = MARCH_LEFT
            s.stride = BOLD
            s.here = s.a
    if s.phase == MARCH_LEFT:
        next = march_point(s.here, left, best, tolerance, curvature, spin, floor, s.stride)
        if next[1] == f64(1.0):
            s.phase = DONE
    if s.phase != DONE and next[1] == f64(2.0):
        s.lost = 1
        s.phase = DONE
    s.x = next[0]
    return s


@wp.func
def take(
    s: Search, at: Contact, left: Contact, right: Contact, tolerance: f64, curvature: f64, spin: f64
) -> Search:  # fmt: skip
    """Draw the conclusions from what was found at the point aimed at."""
    if at.found == 0 and left.found == 1 and right.found == 1:
        s.gap = 1
        s.to_x = at.x
        s.phase = DONE
        return s
    best = lesser(s.best.tau, s.known)
    earlier = at.tau < best - f64(0.5) * tolerance
    if at.tau < s.best.tau:
        s.best = at
    if s.phase == DESCEND:
        if replaces_left(s.a, s.b, at):
            s.a = at
        else:
            s.b = at
    elif s.stride > f64(1.0) and not earlier and not follows(s.here, at, best, tolerance, curvature, spin):
        s.stride = f64(1.0)
    elif at.found == 0 and s.phase == MARCH_RIGHT:
        s.to_x = at.x
        s.phase = MARCH_LEFT
        s.stride = BOLD
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
            at = end_at(cutter, motion, row, origin, direction, side, s.x)
            evaluations += 1
            s = take(s, at, left, right, tolerance, motion.acceleration[row], motion.spin[row])
    out = Extreme()
    out.x = s.best.x
    out.tau = s.best.tau
    out.far = s.best.far
    out.from_x = s.from_x
    out.to_x = s.to_x
    out.gap = s.gap
    if s.phase == DONE and s.lost == 0:
        out.certain = 1
    return out
