"""Where rays cross the classes of a machined surface: Newton's method on their charts, and the tool at rest."""

import warp as wp

from gearsim.kernels.approach import distance_at, distance_rate
from gearsim.kernels.charts import ChartPoint, Place, chart_point, least_axis
from gearsim.kernels.exact_pose import BEYOND, ExactMotion, exact_pose
from gearsim.kernels.meridian import Meridian
from gearsim.kernels.options import OPTIONS

f64 = wp.float64

LONGEST_STEP = wp.constant(f64(1.0))
CONVERGED = wp.constant(f64(1.0e-9))
SETTLED = wp.constant(f64(1.0e-11))
ROUNDING = wp.constant(f64(1.0e-15))
GIVES_UP = wp.constant(4)
TINY = wp.constant(f64(1.0e-300))
PROBES = wp.constant(48)
SHORTEST = wp.constant(f64(1.0e-6))  # a chord no longer than this [mm] lies less than 1e-12 mm deep in a tool
CLOSE = wp.constant(f64(1.0e-2))
DEEP = wp.constant(64)
ZERO = wp.constant(f64(1.0e-11))
FINEST = wp.constant(f64(1.0e-14))

wp.set_module_options(OPTIONS)


@wp.struct
class Rays:
    """Lines with unit directions, looked at from ``start`` to ``end`` [mm] of their origins."""

    origin: wp.array(dtype=wp.vec3d)
    direction: wp.array(dtype=wp.vec3d)
    start: wp.array(dtype=f64)
    end: wp.array(dtype=f64)


@wp.struct
class Step:
    """A step of Newton's method by t and place, and how far [mm] the point is from the ray (nan: no point)."""

    dt: f64
    dplace: f64
    miss: f64


@wp.func
def finite_or_zero(x: f64) -> f64:
    """x, or 0 where it is no finite number."""
    if wp.isfinite(x):
        return x
    return f64(0.0)


@wp.func
def across(direction: wp.vec3d) -> wp.vec3d:
    """A unit vector normal to a direction."""
    return wp.normalize(wp.cross(direction, least_axis(direction)))


@wp.func
def newton_step(at: ChartPoint, origin: wp.vec3d, e1: wp.vec3d, e2: wp.vec3d) -> Step:
    """The step that carries the point onto the ray, shortened to 1 mm; 0 where there is none."""
    m1 = wp.dot(at.point - origin, e1)
    m2 = wp.dot(at.point - origin, e2)
    a = wp.dot(at.by_t, e1)
    b = wp.dot(at.by_place, e1)
    c = wp.dot(at.by_t, e2)
    d = wp.dot(at.by_place, e2)
    det = a * d - b * c
    step = Step()
    step.miss = wp.sqrt(m1 * m1 + m2 * m2)
    step.dt = (b * m2 - d * m1) / det
    step.dplace = (c * m1 - a * m2) / det
    moved = wp.length(at.by_t * step.dt + at.by_place * step.dplace)
    scale = wp.min(f64(1.0), LONGEST_STEP / wp.max(moved, TINY))
    step.dt = finite_or_zero(step.dt * scale)
    step.dplace = finite_or_zero(step.dplace * scale)
    return step


@wp.func
def place_of(piece: int, t: f64, element: int, place: f64, branch: f64) -> Place:
    """A place of its parts."""
    where = Place()
    where.piece = piece
    where.t = t
    where.element = element
    where.place = place
    where.branch = branch
    return where


@wp.func
def moved_to(where: Place, t: f64, pieces: int) -> Place:
    """The place at another t: on the next piece where it runs off one of ``pieces``, else held where poses end."""
    if pieces > 0:
        onward = wp.clamp(int(wp.floor(t)), -where.piece, pieces - 1 - where.piece)
        where.piece += onward
        t -= f64(onward)
    where.t = wp.clamp(t, -BEYOND, f64(1.0) + BEYOND)
    return where


@wp.kernel
def solve_places(
    motion: ExactMotion,
    meridian: Meridian,
    rays: Rays,
    chart: int,
    steps: int,
    pieces: int,
    ray: wp.array(dtype=wp.int32),
    # in and out
    piece: wp.array(dtype=wp.int32),
    t: wp.array(dtype=f64),
    element: wp.array(dtype=wp.int32),
    place: wp.array(dtype=f64),
    branch: wp.array(dtype=f64),
    # out
    s_out: wp.array(dtype=f64),
    tau_out: wp.array(dtype=f64),
    settled_out: wp.array(dtype=wp.int32),
):
    """Carry places of a chart onto their rays: places, arc lengths, branches, tau [mm], and which ones settled.

    A step to where no point exists is taken back by halves: solutions can lie close to the surface's end. With
    ``pieces`` > 0 a place that runs off its piece goes on in the next one; with 0 it stays, and gives up after a while.
    """
    i = wp.tid()
    origin = rays.origin[ray[i]]
    direction = rays.direction[ray[i]]
    e1 = across(direction)
    e2 = wp.cross(direction, e1)
    where = place_of(piece[i], t[i], element[i], place[i], branch[i])
    last_t = f64(0.0)
    last_place = f64(0.0)
    held = int(0)  # how often running the place was held at the end of what is known of its piece
    searching = int(1)
    for _ in range(steps):
        if searching == 1:
            step = newton_step(chart_point(chart, motion, meridian, where), origin, e1, e2)
            dt = step.dt
            dplace = step.dplace
            last_t = -f64(0.5) * last_t
            last_place = -f64(0.5) * last_place
            if wp.isfinite(step.miss):
                last_t = dt
                last_place = dplace
            else:
                dt = last_t
                dplace = last_place
                last_t = -last_t
                last_place = -last_place
            where.place += dplace
            after = where.t + dt
            where = moved_to(where, after, pieces)
            held = wp.where(where.t > -BEYOND and where.t < f64(1.0) + BEYOND, 0, held + 1)
            if step.miss <= CONVERGED or held == GIVES_UP:
                searching = 0
    at = chart_point(chart, motion, meridian, where)
    step = newton_step(at, origin, e1, e2)
    speed = finite_or_zero(wp.length(at.by_t))
    settled_out[i] = 0
    if step.miss < SETTLED + ROUNDING * speed:
        settled_out[i] = 1
    piece[i] = where.piece
    t[i] = where.t
    place[i] = where.place
    branch[i] = at.branch
    s_out[i] = at.s
    tau_out[i] = wp.dot(at.point - origin, direction)


@wp.kernel
def places_at(
    motion: ExactMotion,
    meridian: Meridian,
    chart: int,
    piece: wp.array(dtype=wp.int32),
    t: wp.array(dtype=f64),
    element: wp.array(dtype=wp.int32),
    place: wp.array(dtype=f64),
    branch: wp.array(dtype=f64),
    # out
    point_out: wp.array(dtype=wp.vec3d),
):
    """Points of a chart, nan where there is none."""
    i = wp.tid()
    where = place_of(piece[i], t[i], element[i], place[i], branch[i])
    at = chart_point(chart, motion, meridian, where)
    point_out[i] = at.point


@wp.func
def along_ray(
    meridian: Meridian, origin: wp.vec3d, direction: wp.vec3d, tip: wp.vec3d, axis: wp.vec3d, tau: f64
) -> f64:
    """Signed distance of a ray's point to the tool at rest."""
    return distance_at(meridian, origin + tau * direction, tip, axis)


@wp.func
def root_between(
    meridian: Meridian, origin: wp.vec3d, direction: wp.vec3d, tip: wp.vec3d, axis: wp.vec3d,
    low: f64, high: f64, f_low: f64, f_high: f64,
) -> f64:  # fmt: skip
    """Where the distance along the ray changes its sign: secant steps with bisection."""
    a = low
    b = high
    fa = f_low
    fb = f_high
    for i in range(80):
        if wp.min(b - a, wp.min(wp.abs(fa), wp.abs(fb))) >= FINEST:
            x = f64(0.5) * (a + b)
            if i % 3 != 2:
                secant = (a * fb - b * fa) / (fb - fa)
                if wp.isfinite(secant):
                    x = wp.clamp(secant, a, b)
            f = along_ray(meridian, origin, direction, tip, axis, x)
            if (f > f64(0.0)) == (fa > f64(0.0)):
                a = x
                fa = f
            else:
                b = x
                fb = f
    if wp.abs(fa) < wp.abs(fb):
        return a
    return b


@wp.kernel
def standing_crossings(
    motion: ExactMotion,
    meridian: Meridian,
    rays: Rays,
    ray: wp.array(dtype=wp.int32),
    joint: wp.array(dtype=wp.int32),
    pieces: int,
    # out
    count_out: wp.array(dtype=wp.int32),
    tau_out: wp.array2d(dtype=f64),
    before_out: wp.array2d(dtype=f64),
    after_out: wp.array2d(dtype=f64),
):
    """Where each ray crosses the tool standing at a joint, and how fast the tool comes nearer before and after it.

    Joint i is where piece i begins, the last one the path's end. The distance changes by no more than the way along
    the ray: a chord can hide only where both distances together are below the stretch's length; such stretches are
    halved. ``count_out`` counts all crossings, the columns hold the first ones.
    """
    i = wp.tid()
    k = ray[i]
    origin = rays.origin[k]
    direction = rays.direction[k]
    here = wp.min(joint[i], pieces - 1)
    pose = exact_pose(motion, here, f64(joint[i] - here))
    left = exact_pose(motion, wp.max(joint[i] - 1, 0), f64(1.0))
    right = exact_pose(motion, here, f64(0.0))
    ends = wp.zeros(shape=(DEEP,), dtype=f64)
    values = wp.zeros(shape=(DEEP,), dtype=f64)
    span = rays.end[k] - rays.start[k]
    probe = span / f64(PROBES - 1)
    found = int(0)
    a = rays.start[k]
    fa = along_ray(meridian, origin, direction, pose.tip, pose.axis, a)
    while a < rays.end[k]:
        # the stretch [a, b], and what of it is still to be looked at behind b, as a stack
        b = wp.min(a + wp.max(probe, wp.abs(fa)), rays.end[k])
        ends[0] = b
        values[0] = along_ray(meridian, origin, direction, pose.tip, pose.axis, b)
        top = int(1)
        while top > 0:
            b = ends[top - 1]
            fb = values[top - 1]
            crosses = (fa > f64(0.0)) != (fb > f64(0.0))
            apart = wp.abs(fa) + wp.abs(fb)
            # a chord or a gap can hide where the way is longer than both distances; beside a crossing, a short one may
            room = wp.where(crosses, CLOSE, SHORTEST)
            if apart < b - a and apart > ZERO and b - a > room and top < DEEP:
                ends[top] = f64(0.5) * (a + b)
                values[top] = along_ray(meridian, origin, direction, pose.tip, pose.axis, ends[top])
                top += 1
                continue
            if crosses:
                if found < tau_out.shape[1]:
                    tau = root_between(meridian, origin, direction, pose.tip, pose.axis, a, b, fa, fb)
                    point = origin + tau * direction
                    tau_out[i, found] = tau
                    rate = distance_rate(meridian, point, left)
                    before_out[i, found] = rate[1]
                    rate = distance_rate(meridian, point, right)
                    after_out[i, found] = rate[1]
                found += 1
            a = b
            fa = fb
            top -= 1
    count_out[i] = found
