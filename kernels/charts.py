"""Charts of the classes of a machined surface: points over (t, place) with their derivatives.

The envelope over (t, arc length), circles of the profile over (t, angle about the axis), and for each kind of element
the envelope in a chart that is regular where the first one folds or where all of a circle grazes at once.
"""

import warp as wp

from gearsim.kernels.envelope import AT_REST, PARALLEL
from gearsim.kernels.exact_pose import ExactMotion, ExactPose, exact_jet
from gearsim.kernels.meridian import (
    CENTRE_R,
    CENTRE_Z,
    END_R,
    END_Z,
    FIRST,
    LENGTH,
    MIDDLE_COS,
    MIDDLE_SIN,
    RADIUS,
    START_R,
    START_Z,
    Meridian,
    MeridianPoint,
    meridian_at,
)

f64 = wp.float64

ENVELOPE = wp.constant(0)
CIRCLE = wp.constant(1)
ARC = wp.constant(2)
DISC = wp.constant(3)
LINE = wp.constant(4)

PI = wp.constant(f64(3.14159265358979323846))


@wp.struct
class Place:
    """Where on a chart: ``place`` is an arc length [mm] or an angle [rad], as the chart has it."""

    piece: wp.int32
    t: f64
    element: wp.int32
    place: f64
    branch: f64


@wp.struct
class ChartPoint:
    """A point with its derivatives by t and by place; nan where there is none. On which branch of the envelope, and
    at which arc length [mm] of its element, it lies."""

    point: wp.vec3d
    by_t: wp.vec3d
    by_place: wp.vec3d
    s: f64
    branch: f64


@wp.func
def nowhere() -> ChartPoint:
    """No point."""
    none = f64(wp.nan)
    out = ChartPoint()
    out.point = wp.vec3d(none, none, none)
    out.by_t = out.point
    out.by_place = out.point
    out.s = none
    out.branch = f64(1.0)
    return out


@wp.func
def least_axis(v: wp.vec3d) -> wp.vec3d:
    """The coordinate axis along which a vector is shortest, the first of equal ones."""
    least = wp.vec3d(f64(1.0), f64(0.0), f64(0.0))
    if wp.abs(v[1]) < wp.abs(v[0]):
        least = wp.vec3d(f64(0.0), f64(1.0), f64(0.0))
    if wp.abs(v[2]) < wp.min(wp.abs(v[0]), wp.abs(v[1])):
        least = wp.vec3d(f64(0.0), f64(0.0), f64(1.0))
    return least


@wp.func
def radial(axis: wp.vec3d, angle: f64) -> wp.mat33d:
    """Rows: the unit vector normal to the axis at an angle from a fixed direction's projection, and 90 deg on."""
    fixed = least_axis(axis)
    x = wp.normalize(fixed - wp.dot(fixed, axis) * axis)
    y = wp.cross(axis, x)
    c = wp.cos(angle)
    s = wp.sin(angle)
    return wp.matrix_from_rows(c * x + s * y, c * y - s * x, axis)


@wp.func
def side_of(pose: ExactPose, u: wp.vec3d, g: wp.vec3d) -> f64:
    """The branch on which a radial direction u grazes."""
    if wp.dot(u, wp.cross(pose.axis, g)) < f64(0.0):
        return f64(-1.0)
    return f64(1.0)


@wp.func
def envelope_chart(pose: ExactPose, at: MeridianPoint, where: Place) -> ChartPoint:
    """The closed form with first derivatives, as geometry/grazing.py has it (Zhou 2015, 2.30-2.31)."""
    lever = at.z * at.nr - at.r * at.nz
    g = at.nr * pose.tip_rate + lever * pose.axis_rate
    rise = wp.dot(pose.axis, pose.tip_rate)
    b = at.nz * rise
    along = wp.dot(pose.axis, g)
    flat = g - along * pose.axis
    size2 = wp.dot(flat, flat)
    travel2 = wp.dot(pose.tip_rate, pose.tip_rate)
    spin2 = wp.dot(pose.axis_rate, pose.axis_rate)
    zn = at.z * at.nr
    rn = at.r * at.nz
    parts2 = at.nr * at.nr * travel2 + (zn * zn + rn * rn) * spin2
    moves = size2 > PARALLEL * PARALLEL * parts2 and travel2 + (at.r * at.r + at.z * at.z) * spin2 > AT_REST * AT_REST
    inside = size2 - b * b
    out = nowhere()
    if not moves or not (inside >= f64(0.0)):
        return out
    u = (where.branch * wp.sqrt(inside) * wp.cross(pose.axis, flat) - b * flat) / size2
    w = wp.cross(pose.axis, u)
    across = wp.dot(w, g)
    if across == f64(0.0):
        across = f64(wp.nan)
    lever_s = f64(1.0) - at.bend * (at.r * at.nr + at.z * at.nz)
    g_s = -at.bend * at.nz * pose.tip_rate + lever_s * pose.axis_rate
    u_s = -(wp.dot(u, g_s) + at.bend * at.nr * rise) / across * w
    g_t = at.nr * pose.tip_rate2 + lever * pose.axis_rate2
    b_t = at.nz * (wp.dot(pose.axis_rate, pose.tip_rate) + wp.dot(pose.axis, pose.tip_rate2))
    tilt = wp.dot(u, pose.axis_rate)
    u_t = (tilt * along - wp.dot(u, g_t) - b_t) / across * w - tilt * pose.axis
    out.point = pose.tip + at.z * pose.axis + at.r * u
    out.by_t = pose.tip_rate + at.z * pose.axis_rate + at.r * u_t
    out.by_place = at.nr * pose.axis - at.nz * u + at.r * u_s
    out.s = where.place
    out.branch = where.branch
    return out


@wp.func
def circle_chart(pose: ExactPose, r: f64, z: f64, where: Place) -> ChartPoint:
    """A circle of the profile. The derivative by t keeps the radial direction from turning about the axis; the
    difference is a motion along the circle."""
    frame = radial(pose.axis, where.place)
    u = frame[0]
    u_rate = -wp.dot(u, pose.axis_rate) * pose.axis
    out = nowhere()
    out.point = pose.tip + z * pose.axis + r * u
    out.by_t = pose.tip_rate + z * pose.axis_rate + r * u_rate
    out.by_place = r * frame[1]
    return out


@wp.func
def arc_chart(pose: ExactPose, meridian: Meridian, where: Place) -> ChartPoint:
    """The envelope of an arc over (t, angle about the axis).

    For a given radial direction u the envelope condition fixes the meridian normal:
        nr u.(p' + zc l') + nz (l.p' - rc u.l') = 0,
    with the arc's centre (rc, zc). Regular where the branches meet: the bottom of a trough.
    """
    e = meridian.elements
    i = where.element
    rc = e[i, CENTRE_R]
    zc = e[i, CENTRE_Z]
    rho = e[i, RADIUS]
    frame = radial(pose.axis, where.place)
    u = frame[0]
    around = frame[1]
    q_rate = pose.tip_rate + zc * pose.axis_rate
    q_rate2 = pose.tip_rate2 + zc * pose.axis_rate2
    lean = wp.dot(u, pose.axis_rate)
    a = wp.dot(pose.axis, pose.tip_rate) - rc * lean
    b = -wp.dot(u, q_rate)
    sign = f64(1.0)
    if a * e[i, MIDDLE_COS] + b * e[i, MIDDLE_SIN] < f64(0.0):
        sign = f64(-1.0)
    size = wp.sqrt(a * a + b * b)
    out = nowhere()
    if not (size > AT_REST):
        return out
    nr = sign * a / size
    nz = sign * b / size
    a_t = wp.dot(pose.axis_rate, pose.tip_rate) + wp.dot(pose.axis, pose.tip_rate2) - rc * wp.dot(u, pose.axis_rate2)
    b_t = lean * wp.dot(pose.axis, q_rate) - wp.dot(u, q_rate2)
    turn_t = (a * b_t - b * a_t) / (size * size)
    turn_angle = (b * rc * wp.dot(around, pose.axis_rate) - a * wp.dot(around, q_rate)) / (size * size)
    way = nr * pose.axis - nz * u
    out.point = pose.tip + zc * pose.axis + rc * u + rho * (nr * u + nz * pose.axis)
    out.by_t = q_rate - (rc + rho * nr) * lean * pose.axis + rho * nz * pose.axis_rate + rho * turn_t * way
    out.by_place = (rc + rho * nr) * around + rho * turn_angle * way
    g = nr * pose.tip_rate + ((zc + rho * nz) * nr - (rc + rho * nr) * nz) * pose.axis_rate
    out.branch = side_of(pose, u, g)
    turned = wp.atan2(nz, nr) - e[i, FIRST] + f64(1.0)
    out.s = rho * (turned - f64(2.0) * PI * wp.floor(turned / (f64(2.0) * PI)) - f64(1.0))
    return out


@wp.func
def disc_chart(pose: ExactPose, meridian: Meridian, where: Place) -> ChartPoint:
    """The envelope of a disc or annulus over (t, place along the line of contact).

    In a plane normal to the axis the points x from the axis with l . p' = l' . x graze: a line. ``place`` runs over
    0 to 2 pi for the whole diameter. Regular where the line comes nearest to the axis. Nowhere where the axis does
    not turn.
    """
    e = meridian.elements
    i = where.element
    start = e[i, START_R]
    end = e[i, END_R]
    z = e[i, START_Z]
    half = wp.max(start, end)
    along = half * (where.place / PI - f64(1.0))
    turn2 = wp.dot(pose.axis_rate, pose.axis_rate)
    out = nowhere()
    if not (turn2 > AT_REST * AT_REST):
        return out
    line = wp.cross(pose.axis, pose.axis_rate) / wp.sqrt(turn2)
    line_t = wp.cross(pose.axis, pose.axis_rate2) / wp.sqrt(turn2)
    line_t -= wp.dot(line_t, line) * line
    foot = wp.dot(pose.axis, pose.tip_rate) / turn2
    rise_t = wp.dot(pose.axis_rate, pose.tip_rate) + wp.dot(pose.axis, pose.tip_rate2)
    foot_t = (rise_t - f64(2.0) * foot * wp.dot(pose.axis_rate, pose.axis_rate2)) / turn2
    x = foot * pose.axis_rate + along * line
    out.point = pose.tip + z * pose.axis + x
    out.by_t = pose.tip_rate + z * pose.axis_rate + foot_t * pose.axis_rate + foot * pose.axis_rate2 + along * line_t
    out.by_place = half / PI * line
    outward = wp.sign(end - start)
    out.branch = f64(1.0)
    if (along < f64(0.0)) == (outward > f64(0.0)):
        out.branch = f64(-1.0)
    out.s = outward * (wp.length(x) - start)
    return out


@wp.func
def line_chart(pose: ExactPose, meridian: Meridian, where: Place) -> ChartPoint:
    """The envelope of a straight element over (t, angle about the axis).

    On a generatrix the normal is constant and the envelope condition is linear in the arc length s. Regular where a
    circle's effective centre stands still (a tool that turns about a point of its axis). Nowhere far off the element.
    """
    at = meridian_at(meridian, where.element, f64(0.0))
    length = meridian.elements[where.element, LENGTH]
    frame = radial(pose.axis, where.place)
    u = frame[0]
    around = frame[1]
    rise = wp.dot(pose.axis, pose.tip_rate)
    rise_t = wp.dot(pose.axis_rate, pose.tip_rate) + wp.dot(pose.axis, pose.tip_rate2)
    lever = at.z * at.nr - at.r * at.nz
    lean = wp.dot(u, pose.axis_rate)
    lean_t = wp.dot(u, pose.axis_rate2)
    lean_angle = wp.dot(around, pose.axis_rate)
    s = -(at.nr * wp.dot(u, pose.tip_rate) + lever * lean + at.nz * rise) / lean
    out = nowhere()
    if wp.dot(pose.axis_rate, pose.axis_rate) < AT_REST * AT_REST or not (wp.abs(s - f64(0.5) * length) < length):
        return out
    s_t = -(at.nr * (wp.dot(u, pose.tip_rate2) - lean * rise) + (lever + s) * lean_t + at.nz * rise_t) / lean
    s_angle = -(at.nr * wp.dot(around, pose.tip_rate) + (lever + s) * lean_angle) / lean
    way = at.nr * pose.axis - at.nz * u
    r = at.r - at.nz * s
    z = at.z + at.nr * s
    out.point = pose.tip + z * pose.axis + r * u
    out.by_t = pose.tip_rate + z * pose.axis_rate - r * lean * pose.axis + s_t * way
    out.by_place = r * around + s_angle * way
    out.branch = side_of(pose, u, at.nr * pose.tip_rate + (lever + s) * pose.axis_rate)
    out.s = s
    return out


@wp.func
def chart_point(chart: int, motion: ExactMotion, meridian: Meridian, where: Place) -> ChartPoint:
    """A point of any of the charts."""
    pose = exact_jet(motion, where.piece, where.t)
    if chart == ENVELOPE:
        return envelope_chart(pose, meridian_at(meridian, where.element, where.place), where)
    if chart == CIRCLE:
        e = meridian.elements
        return circle_chart(pose, e[where.element, END_R], e[where.element, END_Z], where)
    if chart == ARC:
        return arc_chart(pose, meridian, where)
    if chart == DISC:
        return disc_chart(pose, meridian, where)
    return line_chart(pose, meridian, where)
