"""The oracle: whether the intervals claimed for a ray are what a motion removes from it, by certificates.

Nothing may be lost: no pose of the tool, made smaller by the noise, enters the ray outside the claimed intervals,
widened by the tolerance. Nothing may be spanned: every point of the claimed intervals, narrowed by the tolerance,
lies in the tool at some pose, the tool made larger by the noise, or in a gap no wider than the tolerance.
"""

import warp as wp

from gearsim.verify.torture.oracle.hollow import UNDECIDED, followed
from gearsim.verify.torture.oracle.separation import HIT, SLACK, Path, Tools, look_at, place_of
from gearsim.verify.torture.oracle.walk import chord_end, deepest, inside_at, reached, within

f64 = wp.float64

# Little is inlined: judge.prepare chooses anew for long runs.
wp.set_module_options({"enable_backward": False, "cpu_compiler_flags": "-mllvm=-inline-threshold=25"})

POSES = wp.constant(5)
STEPS = wp.constant(200)
MARCH = wp.constant(24)
CELLS = wp.constant(200000)


@wp.struct
class Claims:
    """Rays and the intervals claimed for them: ray i owns rows first[i] to first[i + 1]; ``noise`` [mm] per ray."""

    origin: wp.array(dtype=wp.vec3d)
    direction: wp.array(dtype=wp.vec3d)
    start: wp.array(dtype=f64)
    end: wp.array(dtype=f64)
    noise: wp.array(dtype=f64)
    job: wp.array(dtype=wp.int32)
    first: wp.array(dtype=wp.int32)
    lo: wp.array(dtype=f64)
    hi: wp.array(dtype=f64)


@wp.struct
class Findings:
    """Per ray, of what is lost and what is spanned: state (CLEAR, HIT, UNDECIDED), the piece [from, to] of the ray,
    the witness pose; ``cells`` and ``steps`` are what the search cost."""

    lost: wp.array(dtype=wp.int32)
    lost_from: wp.array(dtype=f64)
    lost_to: wp.array(dtype=f64)
    row: wp.array(dtype=wp.int32)
    body: wp.array(dtype=wp.int32)
    x: wp.array(dtype=f64)
    spanned: wp.array(dtype=wp.int32)
    spanned_from: wp.array(dtype=f64)
    spanned_to: wp.array(dtype=f64)
    cells: wp.array(dtype=wp.int32)


@wp.func
def chord(
    tools: Tools, path: Path, body: int, row: int, x: f64, reach: f64, origin: wp.vec3d, direction: wp.vec3d,
    level: f64, lo: f64, hi: f64,
) -> wp.vec2d:  # fmt: skip
    """The part of [lo, hi] of a ray in a body grown by ``level`` at a pose; empty (1, 0)."""
    place = place_of(path, row, x)
    part = within(path, row, reach, origin, direction, lo, hi)
    if part[0] > part[1]:
        return part
    g = inside_at(tools, body, place, origin, direction, part[0], part[1], level)
    if g.f > level:
        return wp.vec2d(f64(1.0), f64(0.0))
    return wp.vec2d(
        chord_end(tools, body, place, origin, direction, g.tau, part[0], level),
        chord_end(tools, body, place, origin, direction, g.tau, part[1], level),
    )


@wp.func
def linked(
    tools: Tools, path: Path, body: int, row: int, before: f64, after: f64, reach: f64, origin: wp.vec3d,
    direction: wp.vec3d, level: f64, a: wp.vec2d, b: wp.vec2d,
) -> bool:  # fmt: skip
    """Whether all poses between two that hit do so too, so that their chords leave no gap.

    In the tool's frame the straight way between two points of a convex body lies in it; the points' true way leaves
    it by at most an eighth of its second derivative.
    """
    t1 = path.bounds[row, 0]
    a1 = path.bounds[row, 3]
    middle_a = f64(0.5) * (a[0] + a[1])
    middle_b = f64(0.5) * (b[0] + b[1])
    bend = path.bounds[row, 1] + f64(2.1) * (reach + t1) * (path.bounds[row, 4] + a1 * a1) + f64(2.0) * a1 * t1
    step = wp.abs(after - before)
    bend = bend * step * step + f64(2.0) * a1 * step * wp.abs(middle_b - middle_a)
    first = look_at(tools, body, place_of(path, row, before), origin, direction, middle_a)
    last = look_at(tools, body, place_of(path, row, after), origin, direction, middle_b)
    return wp.max(first.f, last.f) + bend / f64(8.0) <= level


@wp.func
def marched(
    tools: Tools, path: Path, body: int, row: int, start: f64, reach: f64, origin: wp.vec3d, direction: wp.vec3d,
    level: f64, lo: f64, hi: f64,
) -> f64:  # fmt: skip
    """How far on the ray is covered from a pose that hits, by poses linked with it on both sides."""
    first = chord(tools, path, body, row, start, reach, origin, direction, level, lo, hi)
    best = first[1]
    way = f64(-1.0)
    while way < f64(2.0):
        x = start
        held = first
        step = f64(0.5)
        turn = int(0)
        while turn < MARCH and step > f64(1.0e-9):
            turn += 1
            next = wp.clamp(x + way * step, f64(-1.0), f64(1.0))
            c = chord(tools, path, body, row, next, reach, origin, direction, level, lo, hi)
            if next == x:
                turn = MARCH
            elif c[0] <= c[1] and linked(
                tools, path, body, row, x, next, reach, origin, direction, level, held, c
            ):  # fmt: skip
                x = next
                held = c
                step = f64(2.0) * step
                best = wp.max(best, c[1])
            else:
                step = f64(0.25) * step
        way += f64(2.0)
    return best


@wp.func
def find_lost(tools: Tools, path: Path, claims: Claims, ray: int, tolerance: f64, found: Findings):
    """Look for a pose that enters the ray outside its claimed intervals; write what it removes there."""
    origin = claims.origin[ray]
    direction = claims.direction[ray]
    job = claims.job[ray]
    noise = claims.noise[ray]
    cells = int(0)
    lo = claims.start[ray]
    k = claims.first[ray]
    end = claims.first[ray + 1]
    while k <= end:
        hi = claims.end[ray]
        if k < end:
            hi = wp.min(hi, claims.lo[k] - tolerance)
        if lo < hi:
            hit = reached(tools, path, job, origin, direction, lo, hi, -noise, SLACK * noise)
            cells += hit.cells
            if hit.state == UNDECIDED:
                found.lost[ray] = UNDECIDED
                found.row[ray] = hit.row
                found.x[ray] = hit.x
            if hit.state == HIT:
                x = deepest(tools, hit.body, path, hit.row, origin, direction, hit.x, hit.tau, hit.half)
                part = wp.vec2d(hit.tau, hit.tau)
                if tools.hollow[job] == 1:
                    place = place_of(path, hit.row, x)
                    part = wp.vec2d(
                        followed(tools, hit.body, place, origin, direction, hit.tau, lo, -noise),
                        followed(tools, hit.body, place, origin, direction, hit.tau, hi, -noise),
                    )
                else:
                    part = chord(
                        tools, path, hit.body, hit.row, x, tools.reach[job], origin, direction, -noise, lo, hi
                    )  # fmt: skip
                found.lost[ray] = HIT
                found.lost_from[ray] = part[0]
                found.lost_to[ray] = part[1]
                found.row[ray] = hit.row
                found.body[ray] = hit.body
                found.x[ray] = x
                k = end
        if k < end:
            lo = wp.max(lo, claims.hi[k] + tolerance)
        k += 1
    found.cells[ray] = cells


@wp.func
def sample_chords(tools: Tools, path: Path, claims: Claims, ray: int, chords: wp.array2d(dtype=wp.vec2d)) -> int:
    """Chords at evenly spread poses of every row and body, neighbours united where they are linked; their number."""
    job = claims.job[ray]
    origin = claims.origin[ray]
    direction = claims.direction[ray]
    reach = tools.reach[job]
    level = claims.noise[ray]
    step = f64(2.0) / f64(POSES - 1)
    slot = int(0)
    for row in range(path.first[job], path.first[job + 1]):
        for body in range(tools.first[job], tools.first[job + 1]):
            before = wp.vec2d(f64(1.0), f64(0.0))
            for i in range(POSES):
                x = f64(-1.0) + step * f64(i)
                c = chord(
                    tools, path, body, row, x, reach, origin, direction, level, claims.start[ray], claims.end[ray]
                )  # fmt: skip
                chords[ray, slot] = c
                if before[0] <= before[1] and c[0] <= c[1]:
                    if linked(tools, path, body, row, x - step, x, reach, origin, direction, level, before, c):
                        chords[ray, slot] = wp.vec2d(wp.min(before[0], c[0]), wp.max(before[1], c[1]))
                before = c
                slot += 1
    return slot


@wp.func
def carried(chords: wp.array2d(dtype=wp.vec2d), ray: int, slots: int, c: f64) -> f64:
    """How far sampled chords reach on from a point without a break."""
    best = c
    turn = int(0)
    while turn < slots:
        before = best
        for i in range(slots):
            if chords[ray, i][0] <= best and chords[ray, i][1] > best:
                best = chords[ray, i][1]
        if best == before:
            return best
        turn += 1
    return best


@wp.func
def find_spanned(
    tools: Tools, path: Path, claims: Claims, ray: int, tolerance: f64, chords: wp.array2d(dtype=wp.vec2d),
    found: Findings,
):  # fmt: skip
    """Walk along the claimed intervals from chord to chord; write the first point that no pose reaches."""
    origin = claims.origin[ray]
    direction = claims.direction[ray]
    job = claims.job[ray]
    noise = claims.noise[ray]
    slots = int(-1)
    cells = int(0)
    steps = int(0)
    for k in range(claims.first[ray], claims.first[ray + 1]):
        c = wp.max(claims.lo[k], claims.start[ray]) + tolerance
        goal = wp.min(claims.hi[k], claims.end[ray]) - tolerance
        while c < goal and found.spanned[ray] != HIT:
            if slots < 0 and tools.hollow[job] == 0:
                slots = sample_chords(tools, path, claims, ray, chords)
            on = carried(chords, ray, slots, c)
            if on <= c:
                hit = reached(tools, path, job, origin, direction, c, c, noise, SLACK * noise)
                cells += hit.cells
                steps += 1
                if hit.state == HIT:
                    x = deepest(tools, hit.body, path, hit.row, origin, direction, hit.x, c, hit.half)
                    if tools.hollow[job] == 1:
                        on = followed(
                            tools, hit.body, place_of(path, hit.row, x), origin, direction, c, claims.end[ray], noise
                        )
                    else:
                        on = marched(
                            tools, path, hit.body, hit.row, x, tools.reach[job], origin, direction, noise,
                            claims.start[ray], claims.end[ray],
                        )  # fmt: skip
                    on = wp.max(c, on)
                elif hit.state == UNDECIDED:
                    found.spanned[ray] = UNDECIDED
                    c = goal
                else:
                    found.spanned[ray] = HIT
                    found.spanned_from[ray] = c
                    found.spanned_to[ray] = goal
                    for i in range(slots):
                        if chords[ray, i][0] <= chords[ray, i][1] and chords[ray, i][0] > c:
                            found.spanned_to[ray] = wp.min(found.spanned_to[ray], chords[ray, i][0])
            c = wp.max(c, on + tolerance)
            if steps > STEPS or cells > CELLS:
                if found.spanned[ray] != HIT:
                    found.spanned[ray] = UNDECIDED
                c = goal
    found.cells[ray] += cells


@wp.kernel
def judge_rays(
    # tools and motions
    tools: Tools,
    path: Path,
    tolerance: f64,
    # in
    begin: int,
    claims: Claims,
    chords: wp.array2d(dtype=wp.vec2d),
    # out
    found_out: Findings,
):
    """Judge the claims of one ray a thread."""
    ray = begin + wp.tid()
    find_lost(tools, path, claims, ray, tolerance, found_out)
    find_spanned(tools, path, claims, ray, tolerance, chords, found_out)
