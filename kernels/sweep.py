"""The intervals that one segment's motion of the cutter removes from one ray."""

import warp as wp

from gearsim.kernels.contact import Chord, chord_at, gap_at, overlap, side_of
from gearsim.kernels.interval import IntervalLists, hull, insert
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import FAR, Cutter, greater, lesser
from gearsim.kernels.search import MAX_EVALUATIONS, earliest_entry

f64 = wp.float64

STATUS_INTERVALS_OVERFLOW = wp.constant(1)
STATUS_NOT_CONVERGED = wp.constant(2)

MAX_RUNS = wp.constant(12)

NOWHERE = wp.constant(0)
FIRST = wp.constant(1)
LEFT = wp.constant(2)
RIGHT = wp.constant(3)
WITHIN = wp.constant(4)


@wp.struct
class Sweep:
    """The interval removed by one run of hits, and the part [from_x, to_x] of its bracket it accounts for."""

    lo: f64
    hi: f64
    from_x: f64
    to_x: f64
    gap: wp.int32
    converged: wp.int32


@wp.func
def sweep_run(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    left: Chord, right: Chord, window: wp.vec2d, known: wp.vec2d, tolerance: f64,
) -> Sweep:  # fmt: skip
    """Interval removed between two poses of which at least one hits, united with ``known``, in ``window``."""
    sweep = Sweep()
    sweep.converged = 1
    sweep.from_x = left.entry.x
    sweep.to_x = right.entry.x
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
        else:
            sweep.hi = -end.tau
        sweep.from_x = greater(sweep.from_x, end.from_x)
        sweep.to_x = lesser(sweep.to_x, end.to_x)
        sweep.gap = wp.max(sweep.gap, end.gap)
        sweep.converged = wp.min(sweep.converged, end.converged)
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
def separating_pose(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, left: Chord, right: Chord
) -> Chord:  # fmt: skip
    """Between two disjoint chords, a pose that misses; ``right`` where a chain of overlaps joins them."""
    a = left
    b = right
    step = int(0)
    while step < MAX_EVALUATIONS:
        if overlap(a, b):
            if b.entry.x == right.entry.x:
                return right
            a = b
            b = right
        else:
            b = chord_at(cutter, motion, row, origin, direction, f64(0.5) * (a.entry.x + b.entry.x))
            if b.entry.found == 0:
                return b
        step += 1
    return right


@wp.func
def hidden_hit(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, left: Chord, right: Chord
) -> Chord:  # fmt: skip
    """A pose that hits between two that miss, by minimising the gap; ``left`` itself if there is none."""
    a = left.entry.x
    b = right.entry.x
    gap_a = wp.vec2d()
    gap_b = wp.vec2d()
    x = a
    step = int(-2)
    while step < 60:
        if step >= 0:
            chord = chord_at(cutter, motion, row, origin, direction, x)
            if chord.entry.found == 1:
                return chord
        gap = gap_at(cutter, motion, row, origin, direction, x)
        if step == -2 or (step >= 0 and gap[1] < f64(0.0)):
            a = x
            gap_a = gap
            x = b
        else:
            b = x
            gap_b = gap
        if step >= -1:
            width = b - a
            if gap_a[0] + gap_b[0] > motion.speed[row] * width:
                return left
            if gap_a[1] >= f64(0.0) or gap_b[1] <= f64(0.0) or width < f64(1.0e-12):
                return left
            if greater(-gap_a[1], gap_b[1]) * width < lesser(gap_a[0], gap_b[0]):
                return left
            x = least_gap(a, b, gap_a, gap_b)
            if step % 3 == 1:
                x = f64(0.5) * (a + b)
        step += 1
    return left


@wp.func
def least_gap(a: f64, b: f64, gap_a: wp.vec2d, gap_b: wp.vec2d) -> f64:
    """Minimiser of the cubic through two gaps with their slopes, kept off both ends."""
    width = b - a
    d1 = gap_a[1] + gap_b[1] + f64(3.0) * (gap_a[0] - gap_b[0]) / width
    d2 = wp.sqrt(greater(d1 * d1 - gap_a[1] * gap_b[1], f64(0.0)))
    x = b - width * (gap_b[1] + d2 - d1) / (gap_b[1] - gap_a[1] + f64(2.0) * d2)
    return wp.clamp(x, a + f64(0.01) * width, b - f64(0.01) * width)


@wp.func
def run_end(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, left: Chord, right: Chord
) -> Chord:  # fmt: skip
    """A pose up to which there is one run of hits from ``left`` on; one that misses, like ``left``: no hit at all."""
    if left.entry.found == 0 and right.entry.found == 0:
        return hidden_hit(cutter, motion, row, origin, direction, left, right)
    if left.entry.found == 1 and right.entry.found == 1 and not overlap(left, right):
        return separating_pose(cutter, motion, row, origin, direction, left, right)
    return right


@wp.func
def cut_by_segment(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    window: wp.vec2d, tolerance: f64, ray: int, lists: IntervalLists,
) -> int:  # fmt: skip
    """Unite what one segment removes from one ray with the ray's list; status bits.

    Takes one run of hits after the other out of the bracket [left, right], until both ends miss and
    nothing is hidden between them. Every turn looks at one pose, which becomes an end of the bracket, and
    cuts out the run between ``left`` and ``end``, so that the code of both is there only once.
    """
    left = Chord()
    right = Chord()
    status = int(0)
    runs = int(0)
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
        place = NOWHERE
        end = run_end(cutter, motion, row, origin, direction, left, end)
        if left.entry.found == 0 and end.entry.found == 0:
            return status
        if runs == MAX_RUNS:
            return status | STATUS_NOT_CONVERGED
        known = held_by(lists, ray, left, end)
        sweep = sweep_run(cutter, motion, row, origin, direction, left, end, window, known, tolerance)
        if sweep.gap == 1:
            x = sweep.to_x
            place = WITHIN
            continue
        runs += 1
        if sweep.converged == 0:
            status = status | STATUS_NOT_CONVERGED
        if not insert(lists, ray, sweep.lo, sweep.hi, row, row, tolerance):
            status = status | STATUS_INTERVALS_OVERFLOW
        if end.entry.x < right.entry.x:
            x = end.entry.x
            place = LEFT
        elif left.entry.found == 0 and sweep.from_x > left.entry.x:
            x = sweep.from_x
            place = RIGHT
        elif right.entry.found == 0 and sweep.to_x < right.entry.x:
            x = sweep.to_x
            place = LEFT
    return status
