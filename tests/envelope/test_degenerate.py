"""Motions under which a grazing point is missing or is not single: nothing may break, and both roads agree."""

import warnings
from math import cos, radians, sin

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt, ball, conical, face_mill_head, grinding_wheel
from gearsim.envelope import envelope_grid, machined_along
from gearsim.envelope.crossings import Kind
from gearsim.envelope.surface import envelope_points
from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.grazing import PoseJet, grazing_points
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.series import Series
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.simulation.removal import cut
from tests.envelope.twins.charts import arc_jet, disc_jet, line_jet
from tests.helpers import conical_distance

UP = np.array([0.0, 0.0, 1.0])
SIDE = np.array([1.0, 0.0, 0.0])
LEAN = np.array([sin(0.3), 0.0, cos(0.3)])
TAPER = radians(15.0)
BALL = apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0)
FLAT = apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0)
CONE = conical(1.0, 1.5, TAPER, 25.0)
RING = face_mill_head(30.0, 2.0, radians(10.0), radians(25.0), 0.0, 8.0)
WHEEL = grinding_wheel(100.0, 3.0, radians(20.0), 8.0, 0.5)
CUTTERS = {"ball": BALL, "flat": FLAT, "conical": CONE}


@pytest.fixture(autouse=True)
def no_warnings():
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def path(tips, axes):
    return CLMotion(np.array(tips, dtype=float), np.array(axes, dtype=float))


def spinning(turns=1.0, foot=(60.0, -80.0, 40.0)):
    """The tool turns about its own axis, far from the origin; what is left of the pose's rate is round-off."""
    foot = np.array(foot)

    def curve(t, order):
        angle = series.exp(Series.variable(t, order) * (2j * np.pi * turns))

        def turned(v):
            lengthwise = (LEAN @ v) * LEAN
            return angle.real.column * (v - lengthwise) + angle.imag.column * np.cross(LEAN, v) + lengthwise

        drift = foot - (LEAN @ foot) * LEAN
        return PoseSeries(turned(foot) - turned(drift) + drift, turned(LEAN))

    return CurveMotion(curve, 0.0, 1.0)


def grazes(cutter, element, tip_rate, axis_rate=(0.0, 0.0, 0.0)):
    """Whether circles in the middle of an element have a grazing point, axis upright, both branches."""
    n = 6
    meridian = cutter.elements[element].at(np.linspace(0.2, 0.8, n) * cutter.elements[element].length)
    vectors = (0.0 * UP, UP, tip_rate, axis_rate, 0.0 * UP, 0.0 * UP)
    pose = PoseJet(*(np.tile(np.asarray(v, dtype=float), (n, 1)) for v in vectors))
    found = [grazing_points(pose, meridian, np.full(n, b)) for b in (1.0, -1.0)]
    for g in found:
        assert np.all(np.isfinite(g.point) == g.exists[:, None])
    assert np.array_equal(found[0].exists, found[1].exists)
    return found[0].exists


DISC, FILLET, FLANK = 0, 1, 2


@pytest.mark.parametrize(
    ("cutter", "element", "tip_rate", "axis_rate", "expected"),
    [
        (FLAT, 1, SIDE, 0 * UP, True),  # a cylinder's side moved across
        (CONE, FLANK, SIDE, 0 * UP, True),
        (BALL, 0, SIDE, 0 * UP, True),
        (CONE, DISC, SIDE, 0 * UP, False),  # slides in its own plane: all of it grazes
        (FLAT, 1, UP, 0 * UP, False),  # along the axis: a cylinder slides in itself,
        (CONE, FLANK, -UP, 0 * UP, False),  # a cone and a fillet leave themselves behind,
        (CONE, FILLET, -UP, 0 * UP, False),
        (CONE, DISC, -UP, 0 * UP, False),  # and a disc moves off square to itself
        (FLAT, 1, 0 * UP, 0 * UP, False),  # at rest
        (CONE, DISC, 0 * UP, SIDE, True),  # rocks about the tip: contact along the disc's line of rotation
        (BALL, 0, -3.0 * SIDE, SIDE, False),  # a ball turned about its centre stays where it is
        (FLAT, 1, (1e-17, 1e-15, 3.0), (1e-17, 0.0, 0.0), False),  # along the axis but for round-off
    ],
)
def test_where_no_single_point_grazes_existence_says_so(cutter, element, tip_rate, axis_rate, expected):
    assert np.all(grazes(cutter, element, tip_rate, axis_rate) == expected)


@pytest.mark.parametrize(("beta_deg", "expected"), [(14.999, False), (15.001, True), (164.999, True), (165.001, False)])
def test_a_cone_grazes_down_to_its_half_angle(beta_deg, expected):
    """|cos alpha| <= sin beta, beta from the axis to the velocity; here |cos alpha| = sin 15 deg, alpha > 90 deg."""
    beta = radians(beta_deg)
    assert np.all(grazes(CONE, FLANK, (sin(beta), 0.0, cos(beta))) == expected)


def standing_rays(tip, axis, rng, n=150):
    """Rays through a tool's neighbourhood from all sides."""
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    aim = tip + rng.uniform(-1.0, 26.0, (n, 1)) * axis + rng.uniform(-4.0, 4.0, (n, 3))
    return RayBundle(aim - 30.0 * direction, direction, np.zeros(n), np.full(n, 60.0))


@pytest.mark.parametrize("kind", ["zero-length segment", "several", "spinning in place"])
def test_a_tool_that_goes_nowhere_removes_exactly_itself(kind, rng):
    """The removal road against the tool's own signed distance, written from its construction."""
    source = {
        "zero-length segment": path([[1.0, 2, 3]] * 2, [LEAN] * 2),
        "several": path([[1.0, 2, 3]] * 4, [LEAN] * 4),
        "spinning in place": spinning(foot=(1.0, 2.0, 3.0)),
    }[kind]
    tip = source.pose(np.zeros(1, dtype=int), np.zeros(1), 0).tip.value[0]
    rays = standing_rays(tip, LEAN, rng)
    removed = cut(rays, compile_motion(source, CONE.reach), CONE).require_trust().removed

    def distance(tau):
        q = rays.origin[:, None] + tau[..., None] * rays.direction[:, None] - tip
        z = q @ LEAN
        return conical_distance(np.linalg.norm(q - z[..., None] * LEAN, axis=-1), z, 1.0, 1.5, TAPER, 25.0)

    hit = np.diff(removed.first)
    assert np.all(hit <= 1)
    assert 30 < hit.sum() < len(rays)
    scan = distance(np.tile(np.linspace(0.0, 60.0, 6001), (len(rays), 1))).min(axis=1)
    assert np.all(scan[hit == 0] > 0.0)
    assert np.all(scan[hit == 1] < 1e-4)
    ends = np.full((len(rays), 2), np.nan)
    ends[hit == 1] = np.column_stack([removed.lo, removed.hi])
    assert np.nanmax(np.abs(distance(ends))) < 1e-9


def first_removed(rays, source, cutter):
    """The first air each ray meets beyond its origin, nan if none within its window."""
    removed = cut(rays, compile_motion(source, cutter.reach), cutter).require_trust().removed
    first = np.full(len(rays), np.nan)
    for i in range(len(rays)):
        lo = removed.lo[removed.first[i] : removed.first[i + 1]]
        lo = lo[(lo >= 0.0) & (lo <= rays.end[i])]
        first[i] = lo[0] if len(lo) else np.nan
    return first


def outside(points, source, cutter):
    """Whether points lie outside the tool at 400 poses of every piece."""
    piece = np.repeat(np.arange(source.pieces), 400)
    pose = source.pose(piece, np.tile(np.linspace(0.0, 1.0, 400), source.pieces), 0)
    q = points[:, None] - pose.tip.value
    z = np.einsum("ijk,jk->ij", q, pose.axis.value)
    r = np.linalg.norm(q - z[..., None] * pose.axis.value, axis=-1)
    return cutter.signed_distance(r, z).min(axis=1) > 0.02


def rays_at_the_tool(source, cutter, rng, n=110):
    """Rays that enter the tool at random places of random poses, from origins no pose reaches."""
    element = rng.integers(0, len(cutter.elements), n)
    length = np.array([e.length for e in cutter.elements])[element]
    m = cutter.at(element, length * rng.random(n))
    pose = source.pose(rng.integers(0, source.pieces, n), rng.random(n), 0)
    axis = pose.axis.value
    u = np.cross(axis, rng.normal(size=(n, 3)))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    point = pose.tip.value + m.z[:, None] * axis + m.r[:, None] * u
    direction = -(m.nr[:, None] * u + m.nz[:, None] * axis) + 0.3 * rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    origin = point - rng.uniform(0.05, 0.4, (n, 1)) * direction
    good = outside(origin, source, cutter)
    k = int(good.sum())
    return RayBundle(origin[good], direction[good], np.full(k, -0.5), np.full(k, 2.5))


MOTIONS = {
    "pure translation": path([[0, 0, 0], [10, 0, 0]], [UP, UP]),
    "oblique plunge": path([5.0 * LEAN, 0 * UP], [LEAN, LEAN]),
    "slide of a leaning tool": path([[0, 0, 0], [0, 9, 0]], [LEAN, LEAN]),
    "rocking on the tip": path([0 * UP, 0 * UP], [UP, LEAN]),
    "rocking and sliding": path([[0, 0, 0], [6, 0, 0]], [LEAN * [-1, 1, 1], LEAN]),
    "zero-length segment": path([[1.0, 2, 3]] * 2, [LEAN] * 2),
    "a stop on the way": path([[0, 0, 0], [7, 0, 0], [7, 0, 0], [7, 6, 0]], [UP] * 4),
    "spinning in place": spinning(),
}


@pytest.mark.parametrize("cutter", CUTTERS)
@pytest.mark.parametrize("motion", MOTIONS)
def test_both_roads_agree(motion, cutter, rng):
    source, cutter = MOTIONS[motion], CUTTERS[cutter]
    rays = rays_at_the_tool(source, cutter, rng)
    road, first = machined_along(rays, [source], cutter), first_removed(rays, source, cutter)
    assert len(rays) > 8
    assert np.array_equal(road.valid, np.isfinite(first))
    assert np.nanmax(np.abs(road.deviation - first)) < 1e-8
    if motion in ("zero-length segment", "spinning in place"):
        assert np.all(road.kind[road.valid] == Kind.PATH_END)
        assert not envelope_grid(source, cutter, 8, 4).exists.any()


@pytest.mark.parametrize("cutter", CUTTERS)
def test_a_stop_on_the_way_changes_nothing(cutter, rng):
    cutter = CUTTERS[cutter]
    tips = [[0, 0, 0], [7, 0, 0], [7, 6, 0]]
    through, stopping = path(tips, [UP] * 3), path([*tips[:2], tips[1], tips[2]], [UP] * 4)
    rays = rays_at_the_tool(through, cutter, rng)
    with_stop, without = (first_removed(rays, s, cutter) for s in (stopping, through))
    assert np.allclose(with_stop, without, atol=1e-9, equal_nan=True)
    a, b = (machined_along(rays, [s], cutter) for s in (stopping, through))
    assert np.allclose(a.deviation, b.deviation, atol=1e-9, equal_nan=True)


@pytest.mark.parametrize("axis", [UP, LEAN], ids=["level", "leaning"])
def test_the_floor_under_a_bottom_disc_that_slides_in_its_plane_is_cut_by_its_rim(axis, rng):
    """No circle of the disc has a grazing point of its own, and the fillet joins it smoothly: no sharp edge."""
    along = np.cross(axis, [0.2, 0.5, 0.1])
    along /= np.linalg.norm(along)
    across, n = np.cross(axis, along), 150
    source = path([0.0 * along, 30.0 * along], [axis, axis])
    place = (
        rng.uniform(3.0, 27.0, (n, 1)) * along
        + np.append(rng.uniform(-0.9999, 0.9999, n - 30), [0.999] * 30)[:, None] * across
    )
    direction = axis + 0.3 * rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    rays = RayBundle(place - 0.3 * direction, direction, np.full(n, -1.0), np.full(n, 1.0))
    assert np.allclose(machined_along(rays, [source], CONE).deviation, 0.3, atol=1e-9)


@pytest.mark.parametrize("y", [0.0, 1e-12, -1e-9, 1e-7, -1e-4])
def test_the_bottom_of_a_balls_trough_is_found_from_any_side(y, rng):
    """There the two branches meet in the pole, where the circle shrinks to a point."""
    source, n = path([[0, 0, 0], [10, 0, 0]], [UP, UP]), 60
    direction = UP + 0.3 * rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    bottom = np.column_stack([rng.uniform(1.0, 9.0, n), np.full(n, y), np.full(n, 3.0 - np.sqrt(9.0 - y * y))])
    rays = RayBundle(bottom - 0.3 * direction, direction, np.full(n, -1.0), np.full(n, 2.0))
    assert np.allclose(machined_along(rays, [source], BALL).deviation, 0.3, atol=1e-9)


@pytest.mark.parametrize("y", [0.0, 1e-9, -1e-5])
def test_the_floor_under_a_rocking_disc_is_found_where_its_line_of_contact_passes_the_axis(y, rng):
    """Rocking in the plane it slides in: the floor is a cylinder, its middle line the fold of the radius chart."""
    source, n = MOTIONS["rocking and sliding"], 40
    t = rng.uniform(0.4, 0.6, n)
    tip, axis = (s.derivatives() for s in source.pose(np.zeros(n, dtype=int), t, 1))
    rise, spin2 = (np.sum(a * b, axis=1, keepdims=True) for a, b in ((axis[0], tip[1]), (axis[1], axis[1])))
    floor = tip[0] + rise / spin2 * axis[1] + [0.0, y, 0.0]
    direction = axis[0] + 0.2 * rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    rays = RayBundle(floor - 0.3 * direction, direction, np.full(n, -1.0), np.full(n, 1.0))
    assert np.linalg.norm(rise / spin2 * axis[1], axis=1).max() < 1.0
    road = machined_along(rays, [source], CONE)
    assert np.allclose(road.deviation, 0.3, atol=1e-9)
    assert np.allclose(road.deviation, first_removed(rays, source, CONE), atol=1e-8)


@pytest.mark.parametrize(
    ("chart", "cutter", "elements"),
    [(disc_jet, FLAT, [0, 2]), (arc_jet, CONE, [1]), (line_jet, CONE, [2]), (line_jet, RING, [1, 3])],
)
def test_every_chart_agrees_with_grazing_points_and_its_derivatives_with_differences(chart, cutter, elements, rng):
    axes = np.array([UP, [0.3, 0.5, 1.0]])
    source = path([[0, 0, 0], [0.4, 1.0, 0.1]], axes / np.linalg.norm(axes, axis=1, keepdims=True))
    n, d = 2000, 1e-5
    piece, element = np.zeros(n, dtype=int), rng.choice(elements, n)
    t, place = rng.uniform(0.1, 0.9, n), rng.uniform(0.0, 2.0 * np.pi, n)

    def at(t, place):
        return chart(source, cutter, piece, t, element, place)

    point, by_t, by_place, s, branch = at(t, place)
    length = np.array([e.length for e in cutter.elements])[element]
    on = (s > 1e-3) & (s < length - 1e-3)
    assert on.sum() > 20
    g = envelope_points(source, cutter, piece[on], t[on], element[on], s[on], branch[on])
    assert np.allclose(g.point, point[on], atol=1e-8)
    by_places = (at(t, place + d)[0] - at(t, place - d)[0]) / (2 * d)
    size = 1.0 + np.linalg.norm(by_place, axis=1, keepdims=True) ** 3
    assert np.nanmax((np.abs(by_places - by_place) / size)[on]) < 1e-5
    # the angle's zero may turn about the axis meanwhile, which moves the point along by_place
    along = by_place / np.linalg.norm(by_place, axis=1, keepdims=True)
    rest = (at(t + d, place)[0] - at(t - d, place)[0]) / (2 * d) - by_t
    rest -= np.sum(rest * along, axis=1, keepdims=True) * along
    assert np.nanmax((np.abs(rest) / size)[on]) < 1e-5


def test_a_circle_whose_effective_centre_stands_still_grazes_all_round(rng):
    """A ring turned about a point of its axis: the inner flank's circle normal to that point cuts a sphere."""
    source, n = path([0 * UP, 0 * UP], [UP, LEAN]), 60
    angle = radians(10.0)
    inside = 29.0 * cos(angle)  # distance of the flank from the tip, 29 mm from the axis in the tip plane
    t, turn = rng.uniform(0.2, 0.8, n), rng.uniform(0.3, np.pi - 0.3, n)
    axis = source.pose(np.zeros(n, dtype=int), t, 0).axis.value
    side = np.cross(axis, [0.0, 1.0, 0.0])
    u = np.cos(turn)[:, None] * [0.0, 1.0, 0.0] + np.sin(turn)[:, None] * side
    out = -(cos(angle) * u + sin(angle) * axis)
    rays = RayBundle(-(inside - 0.05) * out, -out, np.full(n, -0.04), np.full(n, 0.5))
    road, first = machined_along(rays, [source], RING), first_removed(rays, source, RING)
    assert np.allclose(first, 0.05, atol=1e-9)
    assert np.allclose(road.deviation, first, atol=1e-8)
    assert np.all(road.kind == Kind.ENVELOPE)


@pytest.mark.parametrize("motion", ["oblique plunge", "rocking and sliding", "a stop on the way"])
def test_both_roads_agree_on_a_wheel_wide_against_its_motion(motion, rng):
    source = MOTIONS[motion]
    rays = rays_at_the_tool(source, WHEEL, rng)
    road, first = machined_along(rays, [source], WHEEL), first_removed(rays, source, WHEEL)
    assert len(rays) > 10
    assert np.allclose(road.deviation, first, atol=1e-8, equal_nan=True)


def test_a_short_chord_through_the_standing_tool_is_not_missed():
    """Under 45 deg through the bottom rim, 10 um inside: a chord of 14 um where probes lie 0.55 mm apart."""
    source = path([[0, 0, 0]] * 2, [UP] * 2)
    angle = np.linspace(0.0, 6.0, 9)
    out = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    direction = (out + UP) / np.sqrt(2.0)
    rays = RayBundle(2.99 * out - 10.3 * direction, direction, np.full(9, -1.0), np.full(9, 25.0))
    assert np.allclose(machined_along(rays, [source], FLAT).deviation, 10.3, atol=1e-9)


def test_opposite_axes_are_refused_with_a_reason():
    with pytest.raises(InputError, match=r"CL points 1 and 2 have opposite tool axes.*put a point between them"):
        path([[0, 0, 0], [10, 0, 0]], [LEAN, -LEAN])


def test_no_rays_meet_nothing():
    motion = CLMotion(np.array([[0.0, 0.0, 0.0], [9.0, 0.0, 0.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    none = RayBundle(np.empty((0, 3)), np.empty((0, 3)), np.empty(0), np.empty(0))
    road = machined_along(none, [motion], ball(6.0, 20.0))
    assert len(road.deviation) == len(road.kind) == 0
    assert not road.valid.any()
