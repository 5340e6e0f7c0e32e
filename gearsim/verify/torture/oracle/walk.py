"""All poses of a row, cell by cell: what no pose reaches, and which pose does."""

import warp as wp

from gearsim.verify.torture.oracle.hollow import UNDECIDED, met_in_row
from gearsim.verify.torture.oracle.separation import (
    CLEAR,
    HIT,
    Look,
    Path,
    Place,
    Tools,
    judge_cell,
    look_at,
    place_of,
    taylor,
    third,
)

f64 = wp.float64

wp.set_module_options({"enable_backward": False})

MAX_DEPTH = wp.constant(46)
MAX_CELLS = wp.constant(20000)


@wp.struct
class Reached:
    """CLEAR, HIT at pose ``x`` of ``row`` and point ``tau``, or UNDECIDED; ``cells`` looked at."""

    state: wp.int32
    body: wp.int32
    row: wp.int32
    x: f64
    half: f64
    tau: f64
    cells: wp.int32


@wp.func
def within(path: Path, row: int, reach: f64, origin: wp.vec3d, direction: wp.vec3d, lo: f64, hi: f64) -> wp.vec2d:
    """The part of [lo, hi] of a ray that the tool can come to in a row at all; empty (1, 0)."""
    radius = f64(1.001) * (reach + path.bounds[row, 0] + path.bounds[row, 3] * reach) + f64(1.0e-6) * reach
    q = origin - path.tip[row, 0]
    middle = -wp.dot(q, direction)
    square = wp.length_sq(q + middle * direction)
    if square > radius * radius:
        return wp.vec2d(f64(1.0), f64(0.0))
    half = wp.sqrt(radius * radius - square)
    return wp.vec2d(wp.max(lo, middle - half), wp.min(hi, middle + half))


@wp.func
def reached_in_row(
    tools: Tools, body: int, path: Path, row: int, reach: f64, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, level: f64, slack: f64,
) -> Reached:  # fmt: skip
    """Whether the tool comes nearer than ``level`` [mm] to the piece [lo, hi] of a ray anywhere in a row."""
    out = Reached()
    out.row = row
    out.body = body
    part = within(path, row, reach, origin, direction, lo, hi)
    if part[0] > part[1]:
        return out
    far = f64(2.1) * (reach + path.bounds[row, 0] + path.bounds[row, 3] * reach)
    depth = int(0)
    index = wp.int64(0)
    half = f64(1.0)
    while depth >= 0:
        x = f64(-1.0) + (f64(2.0) * f64(index) + f64(1.0)) * half
        rest = third(path, row, far, half) * half * half * half / f64(6.0)
        place = place_of(path, row, x)
        verdict = judge_cell(
            tools, body, place, origin, direction, part[0], part[1], half, rest, level, slack
        )  # fmt: skip
        out.cells += 1
        if verdict.state == HIT:
            out.state = HIT
            out.x = x
            out.half = half
            out.tau = verdict.tau
            return out
        if out.cells >= MAX_CELLS:
            out.state = UNDECIDED
            out.x = x
            return out
        if verdict.state == CLEAR or depth == MAX_DEPTH:
            if verdict.state != CLEAR:
                out.state = UNDECIDED
                out.x = x
            while depth > 0 and (index & wp.int64(1)) == wp.int64(1):
                index = index >> wp.int64(1)
                half = f64(2.0) * half
                depth -= 1
            if depth == 0:
                depth = -1
            else:
                index += wp.int64(1)
        else:
            index = index << wp.int64(1)
            half = f64(0.5) * half
            depth += 1
    return out


@wp.func
def reached_by_ring(
    tools: Tools, body: int, path: Path, row: int, reach: f64, origin: wp.vec3d, direction: wp.vec3d,
    lo: f64, hi: f64, level: f64, slack: f64,
) -> Reached:  # fmt: skip
    """The same of a ring."""
    out = Reached()
    out.row = row
    out.body = body
    part = within(path, row, reach, origin, direction, lo, hi)
    if part[0] > part[1]:
        return out
    far = f64(2.1) * (reach + path.bounds[row, 0] + path.bounds[row, 3] * reach)
    met = met_in_row(tools, body, path, row, far, origin, direction, part[0], part[1], level, slack)
    out.state = met.state
    out.x = met.x
    out.half = met.half
    out.tau = met.tau
    out.cells = met.boxes
    return out


@wp.func
def reached(
    tools: Tools, path: Path, job: int, origin: wp.vec3d, direction: wp.vec3d, lo: f64, hi: f64, level: f64, slack: f64
) -> Reached:
    """The first hit of a piece of a ray by any body in any row of a job, or the certainty that there is none."""
    total = Reached()
    for row in range(path.first[job], path.first[job + 1]):
        for body in range(tools.first[job], tools.first[job + 1] - tools.hollow[job]):
            part = Reached()
            if tools.hollow[job] == 1:
                part = reached_by_ring(
                    tools, body, path, row, tools.reach[job], origin, direction, lo, hi, level, slack
                )  # fmt: skip
            else:
                part = reached_in_row(
                    tools, body, path, row, tools.reach[job], origin, direction, lo, hi, level, slack
                )  # fmt: skip
            part.cells += total.cells
            if part.state == HIT:
                return part
            if part.state == UNDECIDED or total.state == CLEAR:
                total = part
            total.cells = part.cells
    return total


@wp.func
def deepest(
    tools: Tools,
    body: int,
    path: Path,
    row: int,
    origin: wp.vec3d,
    direction: wp.vec3d,
    start: f64,
    tau: f64,
    step: f64,
) -> f64:
    """A pose near ``start`` at which a point of the ray lies deeper, found downhill with growing steps."""
    x = start
    place = place_of(path, row, x)
    g = look_at(tools, body, place, origin, direction, tau)
    way = -taylor(g, place, origin + tau * direction)[1]
    best = g.f
    turn = int(0)
    while turn < 60:
        if way > f64(0.0):
            next = wp.min(x + step, f64(1.0))
        else:
            next = wp.max(x - step, f64(-1.0))
        if next == x:
            return x
        f = look_at(tools, body, place_of(path, row, next), origin, direction, tau).f
        if f < best:
            best = f
            x = next
            step = f64(2.0) * step
        else:
            if turn > 0:
                return x
            step = f64(0.25) * step
            if step < f64(1.0e-13):
                return x
            turn -= 1
        turn += 1
    return x


@wp.func
def chord_end(
    tools: Tools, body: int, place: Place, origin: wp.vec3d, direction: wp.vec3d, inside: f64, outside: f64, level: f64
) -> f64:
    """Where the ray leaves a body grown by ``level`` at a pose, between a point inside and one outside.

    Newton's method from outside, which is monotone for a convex distance.
    """
    g = look_at(tools, body, place, origin, direction, outside)
    turn = int(0)
    while turn < 100 and g.f > level:
        move = (g.f - level) / g.slope
        tau = g.tau - move
        if (tau - inside) * (outside - inside) <= f64(0.0) or tau == g.tau or g.slope * (outside - inside) <= f64(0.0):
            return g.tau
        g = look_at(tools, body, place, origin, direction, tau)
        turn += 1
    return g.tau


@wp.func
def inside_at(
    tools: Tools, body: int, place: Place, origin: wp.vec3d, direction: wp.vec3d, lo: f64, hi: f64, level: f64
) -> Look:
    """A point of [lo, hi] nearer than ``level`` to a body at a pose, if there is one; else one that is not."""
    a = look_at(tools, body, place, origin, direction, lo)
    if a.f <= level or a.slope >= f64(0.0):
        return a
    b = look_at(tools, body, place, origin, direction, hi)
    if b.f <= level or b.slope <= f64(0.0):
        return b
    here = a
    cut = int(0)
    while cut < 60:
        share = -a.slope / (b.slope - a.slope)
        floor = (f64(1.0) - share) * (a.f - a.slope * a.tau) + share * (b.f - b.slope * b.tau)
        width = b.tau - a.tau
        if floor > level or width <= f64(0.0):
            return here
        tau = b.tau - (b.f - a.f - a.slope * width) / (b.slope - a.slope)
        if cut % 3 == 2:
            tau = a.tau + share * width
        if cut % 5 == 4:
            tau = f64(0.5) * (a.tau + b.tau)
        tau = wp.clamp(tau, a.tau + f64(1.0e-3) * width, b.tau - f64(1.0e-3) * width)
        here = look_at(tools, body, place, origin, direction, tau)
        if here.f <= level:
            return here
        if here.slope < f64(0.0):
            a = here
        else:
            b = here
        cut += 1
    return here
