"""How close points come to a cutter over a whole exact motion.

The signed distance F(t) of a fixed point to a moving convex cutter is semi-convex: with K a bound on the
second derivative of the point as the tool sees it, F(t + s) >= F + F' s - K s²/2. A tree over the stretches of the
motion says where the tool may be near; a stretch whose bound from both ends stays above what matters is dropped, the
others are halved. The distance to a ring with a convex section is convex in (r, z), and r grows by at most b²/2r
over a step b across it: that adds V²/r to K, with V the fastest tool point's speed and r half the hole's radius.
What is nearer to the axis is farther from the ring than that.
"""

import warp as wp

from gearsim.kernels.exact_pose import ExactMotion, ExactPose, exact_pose
from gearsim.kernels.meridian import Meridian, meridian_distance
from gearsim.kernels.options import OPTIONS

f64 = wp.float64

TOLERANCE = wp.constant(f64(1.0e-11))
FAR = wp.constant(f64(1.0e300))
DEEP = wp.constant(64)  # levels of the tree, twice
SPLITS = wp.constant(64)

wp.set_module_options(OPTIONS)


@wp.struct
class Stretches:
    """Stretches of pieces, ``piece`` from ``start`` to ``end``, with K of the piece, as leaves of a binary tree.

    Node i has the children 2 i and 2 i + 1, the root is 1, the leaves come last. Under node i no tool point is farther
    than ``spread`` [mm] from where it is at the pose (``tip``, ``axis``).
    """

    tip: wp.array(dtype=wp.vec3d)
    axis: wp.array(dtype=wp.vec3d)
    spread: wp.array(dtype=f64)
    piece: wp.array(dtype=wp.int32)
    start: wp.array(dtype=f64)
    end: wp.array(dtype=f64)
    curvature: wp.array(dtype=f64)


@wp.struct
class Wanted:
    """Distances matter below ``floor``; one below ``enough`` ends the search, and ``most`` evaluations do."""

    floor: f64
    enough: f64
    most: wp.int32


@wp.struct
class Least:
    """The least distance found, and how often it was computed."""

    distance: f64
    looks: wp.int32


@wp.func
def distance_at(meridian: Meridian, point: wp.vec3d, tip: wp.vec3d, axis: wp.vec3d) -> f64:
    """Signed distance of a point to the tool at a pose."""
    q = point - tip
    z = wp.dot(q, axis)
    out = meridian_distance(meridian, wp.length(q - z * axis), z)
    return out[0]


@wp.func
def distance_rate(meridian: Meridian, point: wp.vec3d, pose: ExactPose) -> wp.vec2d:
    """Signed distance of a point to the tool at a pose, and its derivative by t."""
    q = point - pose.tip
    z = wp.dot(q, pose.axis)
    w = q - z * pose.axis
    r = wp.length(w)
    out = meridian_distance(meridian, r, z)
    sideways = wp.dot(w, pose.axis_rate)
    r_rate = f64(0.0)
    if r > f64(0.0):
        r_rate = -(wp.dot(w, pose.tip_rate) + z * sideways) / r
    return wp.vec2d(out[0], out[1] * r_rate + out[2] * (sideways - wp.dot(pose.tip_rate, pose.axis)))


@wp.func
def stretch_bound(width: f64, a: wp.vec2d, b: wp.vec2d, curvature: f64) -> f64:
    """Lower bound of the distance on a stretch: where the parabolas from its ends (distance, rate) cross."""
    half = f64(0.5) * curvature * width
    down = a[1] - b[1] - f64(2.0) * half
    s = f64(0.0)
    if down != f64(0.0):
        s = wp.clamp((b[0] - a[0] - (b[1] + half) * width) / down, f64(0.0), width)
    return wp.min(wp.min(a[0], b[0]), a[0] + a[1] * s - f64(0.5) * curvature * s * s)


@wp.func
def split_at(a: f64, b: f64, rate_a: f64, rate_b: f64, middle: bool) -> f64:
    """Near the minimum that the rates point to if they straddle zero, else the middle of a stretch."""
    if middle or rate_a >= f64(0.0) or rate_b <= f64(0.0):
        return f64(0.5) * (a + b)
    margin = f64(0.1) * (b - a)
    return wp.clamp((a * rate_b - b * rate_a) / (rate_b - rate_a), a + margin, b - margin)


@wp.func
def least_on_stretch(
    motion: ExactMotion, meridian: Meridian, point: wp.vec3d, stretches: Stretches, leaf: int, wanted: Wanted,
    known: Least,
) -> Least:  # fmt: skip
    """What is known of the least distance after looking at one stretch."""
    ends = wp.zeros(shape=(SPLITS,), dtype=wp.vec2d)
    early = wp.zeros(shape=(SPLITS,), dtype=wp.vec2d)
    late = wp.zeros(shape=(SPLITS,), dtype=wp.vec2d)
    level = wp.zeros(shape=(SPLITS,), dtype=wp.int32)
    piece = stretches.piece[leaf]
    curvature = stretches.curvature[leaf]
    least = known.distance
    looks = known.looks + 2
    ends[0] = wp.vec2d(stretches.start[leaf], stretches.end[leaf])
    early[0] = distance_rate(meridian, point, exact_pose(motion, piece, stretches.start[leaf]))
    late[0] = distance_rate(meridian, point, exact_pose(motion, piece, stretches.end[leaf]))
    level[0] = 0
    least = wp.min(least, wp.min(early[0][0], late[0][0]))
    top = int(1)
    while top > 0 and least >= wanted.enough and looks < wanted.most:
        top -= 1
        span = ends[top]
        fa = early[top]
        fb = late[top]
        if stretch_bound(span[1] - span[0], fa, fb, curvature) >= wp.min(least - TOLERANCE, wanted.floor):
            continue
        depth = level[top]
        if top + 2 > SPLITS or depth > SPLITS:
            looks = wanted.most
            continue
        x = split_at(span[0], span[1], fa[1], fb[1], depth % 2 == 1)
        f = distance_rate(meridian, point, exact_pose(motion, piece, x))
        looks += 1
        least = wp.min(least, f[0])
        ends[top] = wp.vec2d(span[0], x)
        late[top] = f
        level[top] = depth + 1
        ends[top + 1] = wp.vec2d(x, span[1])
        early[top + 1] = f
        late[top + 1] = fb
        level[top + 1] = depth + 1
        top += 2
    out = Least()
    out.distance = least
    out.looks = looks
    return out


@wp.func
def least_distance(
    motion: ExactMotion, meridian: Meridian, stretches: Stretches, point: wp.vec3d, wanted: Wanted
) -> Least:  # fmt: skip
    """The least distance of a point over all stretches, the nearest ones looked at first."""
    node = wp.zeros(shape=(DEEP,), dtype=wp.int32)
    bound = wp.zeros(shape=(DEEP,), dtype=f64)
    leaves = stretches.piece.shape[0]
    known = Least()
    known.distance = FAR
    known.looks = 0
    node[0] = 1
    bound[0] = -FAR
    top = int(1)
    while top > 0 and known.distance >= wanted.enough and known.looks < wanted.most:
        top -= 1
        i = node[top]
        if bound[top] >= wp.min(known.distance - TOLERANCE, wanted.floor):
            continue
        if i >= leaves:
            known = least_on_stretch(motion, meridian, point, stretches, i - leaves, wanted, known)
            continue
        a = 2 * i
        b = a + 1
        near_a = distance_at(meridian, point, stretches.tip[a], stretches.axis[a])
        near_b = distance_at(meridian, point, stretches.tip[b], stretches.axis[b])
        known.distance = wp.min(known.distance, wp.min(near_a, near_b))
        known.looks = known.looks + 1
        if near_a < near_b:
            node[top] = b
            bound[top] = near_b - stretches.spread[b]
            node[top + 1] = a
            bound[top + 1] = near_a - stretches.spread[a]
        else:
            node[top] = a
            bound[top] = near_a - stretches.spread[a]
            node[top + 1] = b
            bound[top + 1] = near_b - stretches.spread[b]
        top += 2
    return known


@wp.kernel
def least_distances(
    motion: ExactMotion,
    meridian: Meridian,
    stretches: Stretches,
    points: wp.array(dtype=wp.vec3d),
    wanted: Wanted,
    # out
    least_out: wp.array(dtype=f64),
    looks_out: wp.array(dtype=wp.int32),
):
    """Least signed distance of each point to a convex cutter or a ring."""
    i = wp.tid()
    least = least_distance(motion, meridian, stretches, points[i], wanted)
    least_out[i] = least.distance
    looks_out[i] = least.looks
