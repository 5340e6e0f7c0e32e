"""Where a ray meets the moving cutter at one pose of a segment, and how that changes with the motion."""

import warp as wp

from gearsim.kernels.distance import closest_point, outside_distance
from gearsim.kernels.pose import Motion, Pose, pose_at
from gearsim.kernels.profile import FAR, TINY, Cutter, ToolRay, cutter_interval, face_normal, tool_ray

f64 = wp.float64


@wp.struct
class Contact:
    """Where a ray enters the cutter at pose x: parameter, F_x and -F_tau.

    ``found`` 0 where it misses: then tau is FAR.
    """

    found: wp.int32
    x: f64
    tau: f64
    push: f64
    steep: f64


@wp.struct
class Chord:
    """A ray's two ends inside the cutter at one pose; the exit is the entry of the reversed ray."""

    entry: Contact
    exit: Contact


@wp.func
def with_rates(pose: Pose, ray: ToolRay, x: f64, tau: f64, z: f64, w: wp.vec3d, r: f64, n: wp.vec2d) -> Contact:
    """A contact at (r, z) with meridian normal n, and how the distance there changes with x and tau."""
    c = Contact()
    c.found = 1
    c.x = x
    c.tau = tau
    z_rate = wp.dot(w, pose.axis_rate) - wp.dot(pose.tip_rate, pose.axis)
    r_rate = -(wp.dot(w, pose.tip_rate) + z * wp.dot(w, pose.axis_rate)) / r
    c.push = n[0] * r_rate + n[1] * z_rate
    c.steep = -(n[0] * wp.dot(w, ray.w1) / r + n[1] * ray.dz)
    return c


@wp.func
def contact_rates(cutter: Cutter, pose: Pose, ray: ToolRay, x: f64, tau: f64, face: int) -> Contact:
    """The contact at tau on a face of the cutter, with F_x = n . d(point seen from the tool)/dx."""
    z = ray.z0 + tau * ray.dz
    w = ray.w0 + tau * ray.w1
    r = wp.max(wp.length(w), TINY)
    n = face_normal(cutter, face, r, z)
    return with_rates(pose, ray, x, tau, z, w, r, n)


@wp.func
def chord_at(cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, x: f64) -> Chord:
    """The ray's chord through the cutter at parameter x of a row."""
    pose = pose_at(motion, row, x)
    ray = tool_ray(pose.tip, pose.axis, cutter.middle, origin, direction)
    hit = cutter_interval(cutter, ray)
    chord = Chord()
    chord.entry.found = 0
    chord.exit.found = 0
    chord.entry.x = x
    chord.exit.x = x
    chord.entry.tau = FAR
    chord.exit.tau = FAR
    if hit.found == 1:
        chord.entry = contact_rates(cutter, pose, ray, x, hit.lo, hit.lo_face)
        chord.exit = contact_rates(cutter, pose, ray, x, hit.hi, hit.hi_face)
        chord.entry.tau = hit.lo + ray.shift
        chord.exit.tau = -(hit.hi + ray.shift)
        chord.entry.steep = wp.max(chord.entry.steep, f64(0.0))
        chord.exit.steep = wp.max(-chord.exit.steep, f64(0.0))
    return chord


@wp.func
def side_of(chord: Chord, side: int) -> Contact:
    """The entry (side 0) or exit (side 1) of a chord, as an entry of the ray or its reverse."""
    if side == 0:
        return chord.entry
    return chord.exit


@wp.func
def overlap(a: Chord, b: Chord) -> bool:
    """Whether two chords of one ray share a point; not if either is none."""
    if a.entry.found == 0 or b.entry.found == 0:
        return False
    return a.entry.tau <= -b.exit.tau and b.entry.tau <= -a.exit.tau


@wp.func
def gap_at(cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, x: f64) -> wp.vec2d:
    """Distance between a ray that misses and the cutter at x, and its derivative by x."""
    pose = pose_at(motion, row, x)
    ray = tool_ray(pose.tip, pose.axis, cutter.middle, origin, direction)
    tau = closest_point(cutter, ray)
    z = ray.z0 + tau * ray.dz
    w = ray.w0 + tau * ray.w1
    r = wp.max(wp.length(w), TINY)
    d = outside_distance(cutter, r, z)
    c = with_rates(pose, ray, x, tau, z, w, r, wp.vec2d(d[1], d[2]))
    return wp.vec2d(d[0], c.push)
