"""The least signed distance of a passing tool from a point at rest, certain to a tolerance.

The tool's section is convex (``ring.Ring``), the tool a convex body or a ring. Two bounds of its distance F(x) at the
poses x of a row make the search certain. A motion that moves no point of the tool by more than s changes F by at most
s, inside and outside. And F'' is at least -bend: the distance from a convex body is a convex function of the place, so
that only the bends of the point's path, as the tool sees it, can curve F downward; a ring's distance curves besides, by
the square of the speed over the distance from the axis. G = F - bend/2 (x - a)(b - x) is then convex on [a, b] and
below F, and lies above its tangents in a and b.
"""

import warp as wp

from gearsim.kernels.pose import Motion, pose_at
from gearsim.kernels.ring import Ring, section_distance
from gearsim.kernels.tool_ray import TINY

f64 = wp.float64

DEPTH = wp.constant(24)
MOST_LOOKS = wp.constant(400)
Ends = wp.types.vector(length=24, dtype=f64)


@wp.struct
class Look:
    """The tool at pose x: the point's signed distance f, its derivative by x, and its distance r from the axis."""

    x: f64
    f: f64
    push: f64
    r: f64


@wp.func
def look_at(ring: Ring, motion: Motion, row: int, point: wp.vec3d, x: f64) -> Look:
    """The point as the tool sees it at pose x."""
    pose = pose_at(motion, row, x)
    q = point - pose.tip
    z = wp.dot(q, pose.axis)
    w = q - z * pose.axis
    look = Look()
    look.x = x
    look.r = wp.max(wp.length(w), TINY)
    d = section_distance(ring, look.r, z)
    look.f = d[0]
    out = -wp.dot(w, pose.tip_rate + z * pose.axis_rate) / look.r
    along = wp.dot(w, pose.axis_rate) - wp.dot(pose.tip_rate, pose.axis)
    look.push = d[1] * out + d[2] * along
    return look


@wp.func
def least_between(a: Look, b: Look, speed: f64, bend: f64, hollow_speed: f64) -> wp.vec2d:
    """What F is at least between two poses, and where the bounds that say so meet.

    ``hollow_speed`` bounds the point's speed as a ring sees it; 0 for convex tools.
    """
    width = b.x - a.x
    least = f64(0.5) * (a.f + b.f - speed * width)
    at = f64(0.5) * (a.x + b.x)
    most_bend = bend
    if hollow_speed > f64(0.0):
        closest = wp.min(a.r, b.r) - f64(0.5) * hollow_speed * width
        most_bend += hollow_speed * hollow_speed / wp.max(closest, TINY)
    sag = f64(0.5) * most_bend * width
    down = a.push - sag
    up = b.push + sag
    if down >= f64(0.0):
        return wp.vec2d(wp.max(least, a.f), at)
    if up <= f64(0.0):
        return wp.vec2d(wp.max(least, b.f), at)
    along = wp.clamp((a.f - b.f + up * width) / (up - down), f64(0.0), width)
    crossing = a.f + down * along
    if crossing > least:
        return wp.vec2d(crossing, a.x + along)
    return wp.vec2d(least, at)


@wp.func
def next_look(a: Look, b: Look, meeting: f64, turn: int) -> f64:
    """Where to look next: where the slope would vanish on a parabola, or, every other turn, where the bounds meet."""
    x = meeting
    if turn % 2 == 1 and a.push < f64(0.0) and b.push > f64(0.0):
        x = a.x + (b.x - a.x) * a.push / (a.push - b.push)
    margin = f64(0.05) * (b.x - a.x)
    return wp.clamp(x, a.x + margin, b.x - margin)


@wp.func
def pass_distance(
    ring: Ring, hollow: int, motion: Motion, row: int, point: wp.vec3d, enough: f64, tolerance: f64
) -> wp.vec2d:
    """The least of ``enough`` and the distances of a point from the tool at all poses of a row.

    It is never below that, and above it by ``tolerance`` at most [mm]; where that is not certain the second number is
    1. Poses are looked at one by one; [a, b] is the first stretch between two of them that may still hold less, the
    ends of those behind it wait in the vectors.
    """
    reach = wp.length(point - motion.tip[row, 0]) + motion.speed[row]
    beyond = wp.max(reach / ring.reach, f64(1.0))
    bend = motion.acceleration[row] * beyond
    hollow_speed = f64(hollow) * motion.speed[row] * beyond
    end_x = Ends()
    end_f = Ends()
    end_push = Ends()
    end_r = Ends()
    a = Look()
    b = Look()
    best = enough
    waiting = int(0)
    turns = int(0)
    x = f64(-1.0)
    while turns < MOST_LOOKS:
        at = look_at(ring, motion, row, point, x)
        best = wp.min(best, at.f)
        turns += 1
        if turns == 1:
            a = at
            x = f64(1.0)
            continue
        if turns > 2:
            if waiting == DEPTH:
                return wp.vec2d(best, f64(1.0))
            end_x[waiting] = b.x
            end_f[waiting] = b.f
            end_push[waiting] = b.push
            end_r[waiting] = b.r
            waiting += 1
        b = at
        bound = least_between(a, b, motion.speed[row], bend, hollow_speed)
        while bound[0] >= best - tolerance:
            if waiting == 0:
                return wp.vec2d(best, f64(0.0))
            waiting -= 1
            a = b
            b.x = end_x[waiting]
            b.f = end_f[waiting]
            b.push = end_push[waiting]
            b.r = end_r[waiting]
            bound = least_between(a, b, motion.speed[row], bend, hollow_speed)
        x = next_look(a, b, bound[1], turns)
    return wp.vec2d(best, f64(1.0))
