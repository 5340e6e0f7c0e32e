"""The intervals that one segment's motion of the cutter removes from one ray."""

import warp as wp

from gearsim.kernels.contact import Chord, chord_at, side_of
from gearsim.kernels.find import HIT, LOST, NONE, find_pose
from gearsim.kernels.gaps import find_gap
from gearsim.kernels.interval import IntervalLists, free_stretch, hull, insert
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutter
from gearsim.kernels.search import earliest_entry
from gearsim.kernels.tool_ray import FAR, greater, lesser

f64 = wp.float64

STATUS_INTERVALS_OVERFLOW = wp.constant(1)
STATUS_NOT_CONVERGED = wp.constant(2)
STATUS_GAP_UNDECIDED = wp.constant(4)  # what was taken may be too much; of the others it may be too little

MAX_TURNS = wp.constant(40)
MAX_ROUNDS = wp.constant(60)

NOWHERE = wp.constant(0)
FIRST = wp.constant(1)
LEFT = wp.constant(2)
RIGHT = wp.constant(3)
WITHIN = wp.constant(4)
BEFORE = wp.constant(5)


@wp.struct
class Sweep:
    """The interval removed by one run of hits, and the part [from_x, to_x] of its bracket it accounts for.

    ``lo`` and ``hi`` are reached at the poses first_x and last_x, by chords that overlap if ``whole`` is 1.
    ``gap`` and ``certain`` as in search.Extreme.
    """

    lo: f64
    hi: f64
    first_x: f64
    last_x: f64
    whole: wp.int32
    from_x: f64
    to_x: f64
    gap: wp.int32
    certain: wp.int32


@wp.func
def sweep_run(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    left: Chord, right: Chord, window: wp.vec2d, known: wp.vec2d, tolerance: f64,
) -> Sweep:  # fmt: skip
    """Interval removed between two poses of which at least one hits, united with ``known``, in ``window``."""
    sweep = Sweep()
    sweep.certain = 1
    sweep.from_x = left.entry.x
    sweep.to_x = right.entry.x
    first_far = f64(0.0)
    side = int(0)
    while side < 2:
        a = side_of(left, side)
        b = side_of(right, side)
        held = known[0]
        enough = window[0]
        if side == 1:
            held = -known[1]
            enough = -window[1]
        end = earliest_entry(cutter, motion, row, origin, direction, side, a, b, held, enough, tolerance)
        if side == 0:
            sweep.lo = end.tau
            sweep.first_x = end.x
            first_far = end.far
        else:
            sweep.hi = -end.tau
            sweep.last_x = end.x
            if first_far >= -end.far:
                sweep.whole = 1
        sweep.from_x = greater(sweep.from_x, end.from_x)
        sweep.to_x = lesser(sweep.to_x, end.to_x)
        sweep.gap = wp.max(sweep.gap, end.gap)
        sweep.certain = wp.min(sweep.certain, end.certain)
        side += 1
    return sweep


@wp.func
def held_by(lists: IntervalLists, ray: int, left: Chord, right: Chord) -> wp.vec2d:
    """What the list holds around one of two chords; (FAR, -FAR) where it holds nothing of it."""
    known = hull(lists, ray, left.entry.tau, -left.exit.tau)
    if known[0] == FAR:
        known = hull(lists, ray, right.entry.tau, -right.exit.tau)
    return known


@wp.func
def cut_rest(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    window: wp.vec2d, tolerance: f64, ray: int, lists: IntervalLists,
) -> int:  # fmt: skip
    """Unite with the ray's list whatever a segment removes from the window that the list lacks; status bits.

    One chord after the other is cut out of the stretches that are left, until it is certain that none is cut
    any more. No bound is asked of how entries move, and nothing is cut that no pose cuts.
    """
    status = int(0)
    rounds = int(0)
    from_tau = window[0]
    while from_tau < window[1]:
        free = free_stretch(lists, ray, from_tau, window[1], f64(0.5) * tolerance)
        if free[0] > free[1]:
            return status
        find = find_pose(cutter, motion, row, origin, direction, f64(-1.0), f64(1.0), free, 0)
        if find.outcome == HIT and rounds < MAX_ROUNDS:
            chord = chord_at(cutter, motion, row, origin, direction, find.x)
            if not insert(lists, ray, chord.entry.tau, -chord.exit.tau, row, row, tolerance):
                return status | STATUS_INTERVALS_OVERFLOW
            rounds += 1
            from_tau = free[0]
        else:
            if find.outcome != NONE:
                status = status | STATUS_NOT_CONVERGED
            from_tau = free[1]
    return status


@wp.func
def cut_by_segment(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    window: wp.vec2d, tolerance: f64, ray: int, lists: IntervalLists,
) -> int:  # fmt: skip
    """Unite what one segment removes from one ray with the ray's list; status bits.

    Goes over the poses [left, right] from left to right, run of hits by run of hits. Every turn looks at one
    pose, an end of the part [left, end] that is looked at, so that the code is there only once. Where both its
    ends miss, a pose that hits is looked for; where one hits, the run is cut out, and parts before and after it
    remain. Whatever is not certain is left to ``cut_rest``.
    """
    left = Chord()
    right = Chord()
    status = int(0)
    certain = int(1)
    turns = int(0)
    resume = f64(1.0)
    x = f64(-1.0)
    place = FIRST
    while place != NOWHERE:
        at = chord_at(cutter, motion, row, origin, direction, x)
        end = at
        if place == FIRST:
            left = at
            x = f64(1.0)
            place = RIGHT
            continue
        if place == LEFT:
            left = at
            end = right
        elif place == RIGHT:
            right = at
        turns += 1
        if turns == MAX_TURNS:
            certain = 0
            place = NOWHERE
        elif left.entry.found == 0 and end.entry.found == 0:
            find = find_pose(cutter, motion, row, origin, direction, left.entry.x, end.entry.x, window, 1)
            if find.outcome == LOST or (find.outcome == HIT and place == BEFORE):
                certain = 0
            if find.outcome == HIT and place != BEFORE:
                x = find.x
                place = WITHIN
            else:
                x = end.entry.x
                if place == BEFORE:
                    x = resume
                place = wp.where(x < right.entry.x, LEFT, NOWHERE)
        else:
            known = held_by(lists, ray, left, end)
            sweep = sweep_run(cutter, motion, row, origin, direction, left, end, window, known, tolerance)
            place = wp.where(sweep.gap == 1, WITHIN, NOWHERE)
            x = sweep.to_x
            if place == NOWHERE and sweep.whole == 0:
                first = lesser(sweep.first_x, sweep.last_x)
                gap = find_gap(cutter, motion, row, origin, direction, first, greater(sweep.first_x, sweep.last_x))
                if gap.outcome == LOST:
                    status = status | STATUS_GAP_UNDECIDED
                elif gap.outcome == HIT:
                    x = gap.x
                    place = WITHIN
            if place == NOWHERE:
                certain = wp.min(certain, sweep.certain)
                if not insert(lists, ray, sweep.lo, sweep.hi, row, row, tolerance):
                    status = status | STATUS_INTERVALS_OVERFLOW
                resume = sweep.to_x
                if sweep.from_x > left.entry.x:
                    x = sweep.from_x
                    place = BEFORE
                elif resume < right.entry.x:
                    x = resume
                    place = LEFT
    if certain == 0:
        status = status | cut_rest(cutter, motion, row, origin, direction, window, tolerance, ray, lists)
    return status
