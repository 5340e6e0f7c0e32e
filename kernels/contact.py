"""Where a ray meets the moving cutter at one pose of a segment, and how that changes with the motion."""

import warp as wp

from gearsim.kernels.pose import Motion, Pose, perpendicular, place_at, with_derivatives
from gearsim.kernels.profile import Cutter, Hit, cutter_interval, face_normal
from gearsim.kernels.tool_ray import FAR, ToolRay, greater, tool_ray

f64 = wp.float64


@wp.struct
class Contact:
    """Where a ray enters the cutter at pose x: parameter, F_x and -F_tau, and where it leaves it again (``far``).

    ``found`` 0 where it misses: then tau is FAR.
    """

    found: wp.int32
    x: f64
    tau: f64
    far: f64
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
    across = n[0] / r
    c.push = n[1] * z_rate - across * (wp.dot(w, pose.tip_rate) + z * wp.dot(w, pose.axis_rate))
    c.steep = -across * wp.dot(w, ray.w1) - n[1] * ray.dz
    return c


@wp.func
def end_of(cutter: Cutter, pose: Pose, ray: ToolRay, hit: Hit, x: f64, side: int) -> Contact:
    """The entry (side 0) or exit (side 1) of the ray's chord at a pose, with F_x = n . d(point in the tool)/dx."""
    c = Contact()
    c.x = x
    c.tau = FAR
    if hit.found == 1:
        tau = hit.lo
        face = hit.lo_face
        if side == 1:
            tau = hit.hi
            face = hit.hi_face
        z = ray.z0 + tau * ray.dz
        w = ray.w0 + tau * ray.w1
        r = wp.length(w)
        if r < f64(100.0) * cutter.skin:
            # near an apex w is noise; there any plane that leans as the flank does keeps the tool on one side
            w = w - wp.dot(w, pose.axis) * pose.axis
            r = wp.length(w)
            if r < cutter.skin:
                r = cutter.skin
                w = r * perpendicular(pose.axis)
        c = with_rates(pose, ray, x, tau + ray.shift, z, w, r, face_normal(cutter, face, r, z))
        c.far = hit.hi + ray.shift
        if side == 1:
            c.tau = -c.tau
            c.far = -hit.lo - ray.shift
            c.steep = -c.steep
        c.steep = greater(c.steep, f64(0.0))
    return c


@wp.func
def end_at(
    cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, side: int, x: f64
) -> Contact:  # fmt: skip
    """One end of the ray's chord through the cutter at parameter x of a row."""
    pose = place_at(motion, row, x)
    ray = tool_ray(pose.tip, pose.axis, cutter.middle, origin, direction)
    hit = cutter_interval(cutter, ray)
    if hit.found == 1:
        pose = with_derivatives(pose, motion, row, x)
    return end_of(cutter, pose, ray, hit, x, side)


@wp.func
def chord_at(cutter: Cutter, motion: Motion, row: int, origin: wp.vec3d, direction: wp.vec3d, x: f64) -> Chord:
    """The ray's chord through the cutter at parameter x of a row."""
    pose = place_at(motion, row, x)
    ray = tool_ray(pose.tip, pose.axis, cutter.middle, origin, direction)
    hit = cutter_interval(cutter, ray)
    if hit.found == 1:
        pose = with_derivatives(pose, motion, row, x)
    chord = Chord()
    chord.entry = end_of(cutter, pose, ray, hit, x, 0)
    chord.exit = end_of(cutter, pose, ray, hit, x, 1)
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
