"""Exact poses of a motion in closed form: power series on equal spans of each piece of the path.

The envelope road's own table (envelope/poses.py); the removal road's segments are another one.
"""

import warp as wp

f64 = wp.float64

# A piece's spans reach from t = -BEYOND to 1 + BEYOND.
BEYOND = wp.constant(f64(0.5))


@wp.struct
class ExactMotion:
    """Coefficients of tip [mm] and axis by x in [-1, 1], shape (spans, terms); span k has ``terms[k]`` of them.

    Piece i has the spans ``first[i]`` to ``first[i + 1]``, all of one length.
    """

    tip: wp.array2d(dtype=wp.vec3d)
    axis: wp.array2d(dtype=wp.vec3d)
    terms: wp.array(dtype=wp.int32)
    first: wp.array(dtype=wp.int32)


@wp.struct
class ExactPose:
    """Tip and axis with their first and second derivatives by t."""

    tip: wp.vec3d
    axis: wp.vec3d
    tip_rate: wp.vec3d
    axis_rate: wp.vec3d
    tip_rate2: wp.vec3d
    axis_rate2: wp.vec3d


@wp.func
def exact_place(motion: ExactMotion, piece: int, t: f64) -> wp.vec3d:
    """Span [number], x on it, and dx/dt, as a vector."""
    first = motion.first[piece]
    count = motion.first[piece + 1] - first
    scale = f64(count) / (f64(1.0) + f64(2.0) * BEYOND)
    along = (t + BEYOND) * scale
    k = int(wp.floor(along))
    if t > f64(0.5):  # the piece's end lies on its own last span
        k = int(wp.ceil(along)) - 1
    k = wp.clamp(k, 0, count - 1)
    return wp.vec3d(f64(first + k), f64(2.0) * (along - f64(k)) - f64(1.0), f64(2.0) * scale)


@wp.func
def exact_pose(motion: ExactMotion, piece: int, t: f64) -> ExactPose:
    """The pose and its first derivatives; the second ones stay zero."""
    place = exact_place(motion, piece, t)
    span = int(place[0])
    x = place[1]
    last = motion.terms[span] - 1
    pose = ExactPose()
    pose.tip = motion.tip[span, last]
    pose.axis = motion.axis[span, last]
    for i in range(last):
        k = last - 1 - i
        pose.tip_rate = pose.tip_rate * x + pose.tip
        pose.axis_rate = pose.axis_rate * x + pose.axis
        pose.tip = pose.tip * x + motion.tip[span, k]
        pose.axis = pose.axis * x + motion.axis[span, k]
    pose.tip_rate = pose.tip_rate * place[2]
    pose.axis_rate = pose.axis_rate * place[2]
    return pose


@wp.func
def exact_jet(motion: ExactMotion, piece: int, t: f64) -> ExactPose:
    """The pose with its first and second derivatives."""
    place = exact_place(motion, piece, t)
    span = int(place[0])
    x = place[1]
    last = motion.terms[span] - 1
    pose = ExactPose()
    pose.tip = motion.tip[span, last]
    pose.axis = motion.axis[span, last]
    for i in range(last):
        k = last - 1 - i
        pose.tip_rate2 = pose.tip_rate2 * x + pose.tip_rate
        pose.axis_rate2 = pose.axis_rate2 * x + pose.axis_rate
        pose.tip_rate = pose.tip_rate * x + pose.tip
        pose.axis_rate = pose.axis_rate * x + pose.axis
        pose.tip = pose.tip * x + motion.tip[span, k]
        pose.axis = pose.axis * x + motion.axis[span, k]
    pose.tip_rate = pose.tip_rate * place[2]
    pose.axis_rate = pose.axis_rate * place[2]
    twice = f64(2.0) * place[2] * place[2]
    pose.tip_rate2 = pose.tip_rate2 * twice
    pose.axis_rate2 = pose.axis_rate2 * twice
    return pose
