"""Where a segment of a ring's motion hits a stretch of a ray, or the certainty that it does not.

F(x, tau), the ring's distance at pose x to the ray's point tau, is f(r, z) with f convex. Around a known
point, with n = (nr, nz) the gradient of f there,
    F(x + s, tau + u) >= F + nr (r' - r) + nz (z' - z) >= F + F_x s + F_tau u - B - C,
    B = K s²/2 + w |s u|,   C = max(-nr, 0) (|a_x s| + |a_tau u| + B)² / (2 r_min).
B is what the point's path as the tool sees it bends (K, w: bounds on its second derivatives); C is there on
the hole's side only, where r grows by b²/2r over a step b around the axis (a_x, a_tau: rates that way). A
box of poses and ray points whose bound is above minus the slack holds no hit deeper than the slack. As f is
never below a line of the section, n may also be that of any line: small boxes, which lie where f bends at an
edge, are tried with all of them. The others are halved, down a binary tree that is walked without a stack.
Where the smallest boxes still leave room for a hit, the search is lost.
"""

import warp as wp

from gearsim.kernels.pose import Motion
from gearsim.kernels.ring import Gap, Ring, gap_of, over_line

f64 = wp.float64

SEARCH_EVALUATIONS = wp.constant(50000)
MAX_DEPTH = wp.constant(120)
SMALL_DEPTH = wp.constant(16)
WORD = wp.constant(60)
ONE = wp.constant(wp.int64(1))
NONE = wp.constant(0)
HIT = wp.constant(1)
LOST = wp.constant(2)


@wp.struct
class Find:
    """Outcome of a search (NONE, HIT, LOST: evaluations used up or boxes too small to halve) and the hit."""

    outcome: wp.int32
    hit: Gap


@wp.struct
class Bits:
    """120 bits."""

    low: wp.int64
    high: wp.int64


@wp.struct
class Box:
    """Poses x +- hx and ray points tau +- ht, and the way down to them from the whole.

    Bit k of ``in_tau`` says that step k halved tau, of ``up`` that it went to the upper half, of ``second``
    that the other half is done with.
    """

    x: f64
    hx: f64
    tau: f64
    ht: f64
    depth: wp.int32
    in_tau: Bits
    up: Bits
    second: Bits


@wp.func
def bit(bits: Bits, k: int) -> bool:
    """Whether bit k is set."""
    if k < WORD:
        return ((bits.low >> wp.int64(k)) & ONE) == ONE
    return ((bits.high >> wp.int64(k - WORD)) & ONE) == ONE


@wp.func
def with_bit(bits: Bits, k: int, value: bool) -> Bits:
    """The bits with bit k set to a value."""
    low = wp.int64(0)
    high = wp.int64(0)
    if k < WORD:
        low = ONE << wp.int64(k)
    else:
        high = ONE << wp.int64(k - WORD)
    changed = Bits()
    changed.low = bits.low & (~low)
    changed.high = bits.high & (~high)
    if value:
        changed.low = changed.low | low
        changed.high = changed.high | high
    return changed


@wp.func
def least_in(ring: Ring, motion: Motion, row: int, g: Gap, hx: f64, ht: f64) -> wp.vec3d:
    """Lower bound of the distance in the box hx, ht around a known point, and what hx and ht take off it.

    The row's bounds hold for points within the reach; farther ones, up to 5 deg of rotation, are faster by ``far``.
    """
    far = wp.max(f64(1.05) * (g.size + motion.speed[row] * hx + ht) / ring.reach, f64(1.0))
    bend = f64(0.5) * motion.acceleration[row] * far * far * hx * hx
    twist = motion.spin[row] * hx * ht
    by_x = wp.abs(g.push) * hx + bend
    by_tau = wp.abs(g.steep) * ht
    affine = g.f - by_x - by_tau - twist
    if g.nr < f64(0.0):
        r_min = g.r - motion.speed[row] * far * hx - ht
        if r_min <= f64(0.0):
            return wp.vec3d(g.f - motion.speed[row] * hx - ht, motion.speed[row] * hx, ht)
        across_x = wp.abs(g.across_x) * hx + bend + twist
        across_tau = wp.abs(g.across_tau) * ht
        bow = f64(-0.5) * g.nr / r_min
        affine -= bow * (across_x + across_tau) * (across_x + across_tau)
        by_x += bow * across_x * across_x
        by_tau += bow * across_tau * across_tau
    return wp.vec3d(wp.max(affine, g.f - motion.speed[row] * hx - ht), by_x, by_tau)


@wp.func
def clear_of_lines(ring: Ring, motion: Motion, row: int, g: Gap, hx: f64, ht: f64, slack: f64) -> bool:
    """Whether one line of the section keeps the box hx, ht around a known point clear."""
    for i in range(ring.lines.shape[0]):
        if least_in(ring, motion, row, over_line(ring, g, i), hx, ht)[0] >= -slack:
            return True
    return False


@wp.func
def descend(box: Box, in_tau: bool, up: bool, second: bool) -> Box:
    """One half of a box."""
    box.in_tau = with_bit(box.in_tau, box.depth, in_tau)
    box.up = with_bit(box.up, box.depth, up)
    box.second = with_bit(box.second, box.depth, second)
    box.depth += 1
    way = f64(-0.5)
    if up:
        way = f64(0.5)
    if in_tau:
        box.tau += way * box.ht
        box.ht *= f64(0.5)
    else:
        box.x += way * box.hx
        box.hx *= f64(0.5)
    return box


@wp.func
def ascend(box: Box) -> Box:
    """The box that this one is a half of."""
    box.depth -= 1
    way = f64(1.0)
    if bit(box.up, box.depth):
        way = f64(-1.0)
    if bit(box.in_tau, box.depth):
        box.tau += way * box.ht
        box.ht *= f64(2.0)
    else:
        box.x += way * box.hx
        box.hx *= f64(2.0)
    return box


@wp.func
def next_box(box: Box) -> Box:
    """The next box after one that is done with; depth -1 where there is none."""
    while box.depth > 0 and bit(box.second, box.depth - 1):
        box = ascend(box)
    if box.depth == 0:
        box.depth = -1
        return box
    in_tau = bit(box.in_tau, box.depth - 1)
    up = bit(box.up, box.depth - 1)
    box = ascend(box)
    return descend(box, in_tau, not up, True)


@wp.func
def find_hit(
    ring: Ring, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, lo: f64, hi: f64, slack: f64
) -> Find:  # fmt: skip
    """Any hit on the stretch [lo, hi] of the ray, looked for downhill first."""
    found = Find()
    box = Box()
    box.hx = f64(1.0)
    box.tau = f64(0.5) * (lo + hi)
    box.ht = f64(0.5) * (hi - lo)
    evaluations = int(0)
    while box.depth >= 0:
        if evaluations == SEARCH_EVALUATIONS:
            found.outcome = LOST
            return found
        g = gap_of(ring, motion, row, origin, direction, box.x, box.tau)
        evaluations += 1
        if g.f <= f64(0.0):
            found.outcome = HIT
            found.hit = g
            return found
        least = least_in(ring, motion, row, g, box.hx, box.ht)
        clear = least[0] >= -slack
        if not clear and box.depth >= SMALL_DEPTH:
            clear = clear_of_lines(ring, motion, row, g, box.hx, box.ht, slack)
        if clear or box.depth == MAX_DEPTH:
            if not clear:
                found.outcome = LOST
            box = next_box(box)
        elif least[2] > least[1]:
            box = descend(box, True, g.steep < f64(0.0), False)
        else:
            box = descend(box, False, g.push < f64(0.0), False)
    return found
