"""Poses of the segment table: quintic tip and axis with their derivatives."""

import warp as wp

f64 = wp.float64


@wp.struct
class Motion:
    """Rows of quintic coefficients, shape (n, 6), and the bounds of motion/segments.py."""

    tip: wp.array2d(dtype=wp.vec3d)
    axis: wp.array2d(dtype=wp.vec3d)
    speed: wp.array(dtype=f64)
    acceleration: wp.array(dtype=f64)
    spin: wp.array(dtype=f64)


@wp.struct
class Pose:
    """Tip and axis with their derivatives by the segment's parameter; the axis is not renormalised."""

    tip: wp.vec3d
    tip_rate: wp.vec3d
    axis: wp.vec3d
    axis_rate: wp.vec3d


@wp.func
def pose_at(motion: Motion, row: int, x: f64) -> Pose:
    """Pose of a row at x in [-1, 1] by Horner's rule."""
    pose = Pose()
    pose.tip = motion.tip[row, 5]
    pose.axis = motion.axis[row, 5]
    pose.tip_rate = wp.vec3d()
    pose.axis_rate = wp.vec3d()
    for i in range(5):
        k = 4 - i
        pose.tip_rate = pose.tip_rate * x + pose.tip
        pose.axis_rate = pose.axis_rate * x + pose.axis
        pose.tip = pose.tip * x + motion.tip[row, k]
        pose.axis = pose.axis * x + motion.axis[row, k]
    return pose


@wp.func
def place_at(motion: Motion, row: int, x: f64) -> Pose:
    """The same without the derivatives."""
    pose = Pose()
    pose.tip = motion.tip[row, 5]
    pose.axis = motion.axis[row, 5]
    for i in range(5):
        pose.tip = pose.tip * x + motion.tip[row, 4 - i]
        pose.axis = pose.axis * x + motion.axis[row, 4 - i]
    return pose


@wp.func
def with_derivatives(place: Pose, motion: Motion, row: int, x: f64) -> Pose:
    """The pose that ``place_at`` gives, with the derivatives."""
    tip_rate = f64(5.0) * motion.tip[row, 5]
    axis_rate = f64(5.0) * motion.axis[row, 5]
    for i in range(4):
        k = 4 - i
        tip_rate = tip_rate * x + f64(k) * motion.tip[row, k]
        axis_rate = axis_rate * x + f64(k) * motion.axis[row, k]
    place.tip_rate = tip_rate
    place.axis_rate = axis_rate
    return place


@wp.func
def perpendicular(v: wp.vec3d) -> wp.vec3d:
    """Any unit vector perpendicular to a unit vector."""
    other = wp.vec3d(f64(1.0), f64(0.0), f64(0.0))
    if wp.abs(v[0]) > f64(0.6):
        other = wp.vec3d(f64(0.0), f64(1.0), f64(0.0))
    return wp.normalize(wp.cross(v, other))
