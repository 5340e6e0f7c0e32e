"""Whether the cutter meets a stretch of a ray anywhere between two poses of a row: a pose that does, or the certainty
that none does.

The poses are walked through from one end to the other, step by step. Wherever the cutter misses, a plane with
normal n keeps it away from both ends p of the stretch, by n . (p - tip) - H(n), H being the cutter's support
function. Over a step let n change evenly from that of its one end to that of the other. H is convex in n as the tool
sees it, so in between the clearance is above what lies evenly between that of the two ends, less
C (x - x1) (x2 - x) / 2. With the rates v of the tip and w of the axis, and the cutter's reach R, C is
    |n . tip''| + 2 |n' . tip'| + R (w² + |axis''| + 2 w |n'|)            where n changes evenly in space, or
    |tip''| + 2 w v + |p - tip| (w² + |axis''|) + 2 |n'| (v + w |p - tip|)  where it does as the tool sees it,
whichever proves more; where the apex of a pointed cutter stays nearest to the plane, R is its distance from the tip.
A step of which that is not certain is halved, and the next one is twice as long. It holds at
kinks (edges, flat faces) too, and the clearance may have any number of minima, touch zero, or stay there.
"""

import warp as wp

from gearsim.kernels.look import Look, glance_at, look_at
from gearsim.kernels.pose import Motion, place_at
from gearsim.kernels.profile import LINE, Cutter
from gearsim.kernels.support import from_axis
from gearsim.kernels.tool_ray import greater, lesser

f64 = wp.float64

FIND_LOOKS = wp.constant(10000)
NARROWEST = wp.constant(f64(1.0e-14))
NONE = wp.constant(0)
HIT = wp.constant(1)
LOST = wp.constant(2)

FIRST_GUESS = wp.constant(1)
LAST_GUESS = wp.constant(2)
SAME_PLANE = wp.constant(3)


@wp.struct
class Find:
    """Outcome of a search (NONE, HIT, LOST: looks used up) and the pose that hits."""

    outcome: wp.int32
    x: f64


@wp.func
def least_of(first: f64, last: f64, sag: f64) -> f64:
    """Least value of a parabola between two values, which ``sag`` takes off their mean in the middle."""
    change = last - first
    if wp.abs(change) >= f64(4.0) * sag:
        return lesser(first, last)
    return f64(0.5) * (first + last) - change * change / (f64(16.0) * sag) - sag


@wp.func
def least_of_both(a: Look, b: Look, first_sag: f64, last_sag: f64) -> f64:
    """Lower bound over a step for both ends of the stretch, which one plane must keep the cutter from."""
    return lesser(least_of(a.first, b.first, first_sag), least_of(a.last, b.last, last_sag))


@wp.func
def turned(v: wp.vec3d, a: wp.vec3d, b: wp.vec3d) -> wp.vec3d:
    """A vector turned as the shortest turn from unit vector a to b does, less than half a turn."""
    return v - (wp.dot(v, a + b) / (f64(1.0) + wp.dot(a, b))) * (a + b) + f64(2.0) * wp.dot(v, a) * b


@wp.func
def at_apex(cutter: Cutter, look: Look, turn: f64) -> bool:
    """Whether a pointed cutter's apex stays the point nearest to a look's plane while the axis turns by ``turn``."""
    slope = cutter.slabs[cutter.first, 3]
    if cutter.slabs[cutter.first, 5] != LINE or cutter.slabs[cutter.first, 2] > f64(0.0):
        return False
    along = wp.dot(look.n, look.axis)
    across = wp.length(look.n - along * look.axis)
    return (across + turn) * slope + along + turn <= f64(0.0)


@wp.func
def least_clearance(cutter: Cutter, motion: Motion, row: int, a: Look, b: Look) -> f64:
    """Certain lower bound of the cutter's clearance from a stretch between two poses; see above."""
    width = b.x - a.x
    reach = f64(0.5) * cutter.size
    spin = motion.spin[row]
    v = motion.speed[row] - spin * reach
    n_rate = (b.n - a.n) / width
    seen_rate = wp.length(turned(b.n, b.axis, a.axis) - a.n) / width
    turning = spin * spin
    in_space = f64(0.0)
    seen = f64(2.0) * v * (spin + seen_rate)
    for k in range(1, 6):
        tip = motion.tip[row, k]
        bend = f64(k * (k - 1))
        turning += bend * wp.length(motion.axis[row, k])
        seen += bend * wp.length(tip)
        in_space += bend * greater(wp.abs(wp.dot(a.n, tip)), wp.abs(wp.dot(b.n, tip)))
        in_space += f64(2 * k) * wp.abs(wp.dot(n_rate, tip))
    nearest = reach
    if at_apex(cutter, a, spin * width) and at_apex(cutter, b, spin * width):
        nearest = wp.abs(cutter.slabs[cutter.first, 0])
    in_space += nearest * (turning + f64(2.0) * spin * wp.length(n_rate))
    turning += f64(2.0) * spin * seen_rate
    part = f64(0.125) * width * width
    first_arm = lesser(a.first_arm, b.first_arm) + v * width
    last_arm = lesser(a.last_arm, b.last_arm) + v * width
    fixed = least_of_both(a, b, part * in_space, part * in_space)
    return greater(fixed, least_of_both(a, b, part * (seen + first_arm * turning), part * (seen + last_arm * turning)))


@wp.func
def find_pose(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d,
    from_x: f64, to_x: f64, stretch: wp.vec2d, misses: int,
) -> Find:  # fmt: skip
    """A pose in [from_x, to_x] at which the cutter meets a stretch of a ray, or the certainty that there is none.

    ``misses`` 1: it is known that the ray does at both ends. What is passed over as a miss is cut no deeper than a
    few times the rounding of the coordinates. The first step is tried with the plane of its one end alone.
    """
    find = Find()
    here = Look()
    x = from_x
    looks = int(0)
    n = from_axis(cutter, place_at(motion, row, from_x), origin, direction)
    glance = FIRST_GUESS
    while looks < FIND_LOOKS:
        ahead = Look()
        if glance != NONE:
            ahead = glance_at(cutter, motion, row, origin, direction, stretch, x, n)
        else:
            known = wp.where(looks < 2, misses, 0)
            ahead = look_at(cutter, motion, row, origin, direction, stretch, x, known)
            looks += 1
        if ahead.hit == 1:
            find.outcome = HIT
            find.x = x
            return find
        if glance == FIRST_GUESS or (looks == 1 and glance == NONE):
            here = ahead
            n = ahead.n
            x = to_x
            glance = wp.where(glance == FIRST_GUESS, LAST_GUESS, SAME_PLANE)
            continue
        width = ahead.x - here.x
        if least_clearance(cutter, motion, row, here, ahead) >= f64(-2.0) * cutter.skin:
            if ahead.x >= to_x:
                return find
            here = ahead
            x = wp.min(to_x, ahead.x + f64(2.0) * width)
        elif glance == LAST_GUESS:
            x = from_x
        elif glance == NONE:
            x = f64(0.5) * (here.x + ahead.x)
            if width < NARROWEST:
                break
        glance = NONE
    find.outcome = LOST
    return find
