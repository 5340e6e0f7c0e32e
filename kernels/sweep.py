"""The intervals that one segment's motion of the cutter removes from one ray."""

import warp as wp

from gearsim.kernels.contact import Chord, chord_at, gap_at, overlap, side_of
from gearsim.kernels.interval import IntervalLists, hull, insert
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import FAR, Cutter
from gearsim.kernels.search import MAX_EVALUATIONS, earliest_entry

f64 = wp.float64

STATUS_INTERVALS_OVERFLOW = wp.constant(1)
STATUS_NOT_CONVERGED = wp.constant(2)

MAX_RUNS = wp.constant(12)


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
        sweep.from_x = wp.max(sweep.from_x, end.from_x)
        sweep.to_x = wp.min(sweep.to_x, end.to_x)
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
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    left: Chord, right: Chord,
) -> Chord:  # fmt: skip
    """A pose that hits between two that miss, by minimising the gap; ``left`` itself if there is none."""
    a = left.entry.x
    b = right.entry.x
    gap_a = gap_at(cutter, motion, row, origin, direction, a)
    gap_b = gap_at(cutter, motion, row, origin, direction, b)
    step = int(0)
    while step < 60:
        width = b - a
        if gap_a[0] + gap_b[0] > motion.speed[row] * width:
            return left
        if gap_a[1] >= f64(0.0) or gap_b[1] <= f64(0.0) or width < f64(1.0e-12):
            return left
        if wp.max(-gap_a[1], gap_b[1]) * width < wp.min(gap_a[0], gap_b[0]):
            return left
        d1 = gap_a[1] + gap_b[1] + f64(3.0) * (gap_a[0] - gap_b[0]) / width
        d2 = wp.sqrt(wp.max(d1 * d1 - gap_a[1] * gap_b[1], f64(0.0)))
        x = b - width * (gap_b[1] + d2 - d1) / (gap_b[1] - gap_a[1] + f64(2.0) * d2)
        if step % 3 == 2:
            x = f64(0.5) * (a + b)
        x = wp.clamp(x, a + f64(0.01) * width, b - f64(0.01) * width)
        chord = chord_at(cutter, motion, row, origin, direction, x)
        if chord.entry.found == 1:
            return chord
        gap = gap_at(cutter, motion, row, origin, direction, x)
        if gap[1] < f64(0.0):
            a = x
            gap_a = gap
        else:
            b = x
            gap_b = gap
        step += 1
    return left


@wp.func
def cut_by_segment(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    window: wp.vec2d, tolerance: f64, ray: int, lists: IntervalLists,
) -> int:  # fmt: skip
    """Unite what one segment removes from one ray with the ray's list; status bits.

    Takes one run of hits after the other out of the bracket [left, right], until both ends miss and
    nothing is hidden between them.
    """
    left = chord_at(cutter, motion, row, origin, direction, f64(-1.0))
    right = chord_at(cutter, motion, row, origin, direction, f64(1.0))
    status = int(0)
    runs = int(0)
    while left.entry.x < right.entry.x:
        end = right
        if left.entry.found == 0 and right.entry.found == 0:
            end = hidden_hit(cutter, motion, row, origin, direction, left, right)
            if end.entry.found == 0:
                return status
        elif left.entry.found == 1 and right.entry.found == 1 and not overlap(left, right):
            end = separating_pose(cutter, motion, row, origin, direction, left, right)
        if runs == MAX_RUNS:
            return status | STATUS_NOT_CONVERGED
        known = held_by(lists, ray, left, end)
        sweep = sweep_run(cutter, motion, row, origin, direction, left, end, window, known, tolerance)
        runs += 1
        if sweep.gap == 1:
            end = chord_at(cutter, motion, row, origin, direction, sweep.to_x)
            known = held_by(lists, ray, left, end)
            sweep = sweep_run(cutter, motion, row, origin, direction, left, end, window, known, tolerance)
        if sweep.converged == 0:
            status = status | STATUS_NOT_CONVERGED
        if not insert(lists, ray, sweep.lo, sweep.hi, row, row, tolerance):
            status = status | STATUS_INTERVALS_OVERFLOW
        if end.entry.x < right.entry.x:
            left = end
        elif left.entry.found == 0:
            right = chord_at(cutter, motion, row, origin, direction, sweep.from_x)
        elif right.entry.found == 0:
            left = chord_at(cutter, motion, row, origin, direction, sweep.to_x)
        else:
            left = right
    return status
