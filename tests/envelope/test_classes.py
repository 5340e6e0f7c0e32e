"""The four closed-form classes of the machined surface, each where it must appear, against a search."""

from math import radians

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt, conical, face_mill_head
from gearsim.envelope import machined_along
from gearsim.envelope.candidates import Candidates
from gearsim.envelope.crossings import Kind
from gearsim.envelope.surface import envelope_points
from gearsim.envelope.swept import Swept
from gearsim.geometry.rays import RayBundle
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation.removal import cut
from tests.envelope.twins.charts import arc_jet
from tests.motion.test_sources import random_cl

UP = np.array([0.0, 0.0, 1.0])
BALL = apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0)
FLAT = apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0)
CONE = conical(1.0, 1.5, radians(15.0), 25.0)


def rays_into(points, normals, inward=1.0, outward=1.0):
    """Rays with material behind their origins."""
    normals = np.asarray(normals, dtype=float)
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    n = len(points)
    return RayBundle(np.asarray(points, dtype=float), normals, np.full(n, -inward), np.full(n, outward))


def by_removal(rays, source, cutter):
    found = cut(rays, compile_motion(source, cutter.reach), cutter).require_trust().removed
    return np.array(
        [found.lo[found.first[i]] if found.first[i] < found.first[i + 1] else np.nan for i in range(len(rays))]
    )


def test_inside_a_straight_move_the_envelope_is_a_cylinder():
    source = CLMotion(np.array([[0.0, 0, 0], [10.0, 0, 0]]), np.tile(UP, (2, 1)))
    x, z = np.linspace(1, 9, 9), np.linspace(4, 15, 9)
    rays = rays_into(np.column_stack([x, np.full(9, 3.05), z]), np.tile([0.0, -1.0, 0.0], (9, 1)))
    road = machined_along(rays, [source], BALL)
    assert np.all(road.kind == Kind.ENVELOPE)
    assert np.allclose(road.deviation, 0.05, atol=1e-11)
    trough = rays_into(np.column_stack([x, np.zeros(9), np.full(9, -0.1)]), np.tile(UP, (9, 1)))
    road = machined_along(trough, [source], BALL)
    assert np.all(road.kind == Kind.ENVELOPE)
    assert np.allclose(road.deviation, 0.1, atol=1e-11)


def test_at_a_corner_of_the_path_the_joint_pose_itself_is_the_surface():
    """A right-angled turn: round the outside of the corner the ball stands still in the joint pose."""
    source = CLMotion(np.array([[0.0, 0, 0], [10.0, 0, 0], [10.0, 10.0, 0]]), np.tile(UP, (3, 1)))
    angle = np.radians([-80.0, -60.0, -45.0, -30.0, -10.0])
    out = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    rays = rays_into(np.array([10.0, 0.0, 6.0]) + 3.02 * out, -out)
    road = machined_along(rays, [source], BALL)
    assert np.all(road.kind == Kind.JOINT)
    assert np.allclose(road.deviation, 0.02, atol=1e-11)


def test_at_the_paths_ends_the_tool_stands_there():
    source = CLMotion(np.array([[0.0, 0, 0], [10.0, 0, 0]]), np.tile(UP, (2, 1)))
    angle = np.radians([-70.0, -20.0, 0.0, 45.0, 80.0])
    for end, turn in ((10.0, 0.0), (0.0, np.pi)):
        out = np.column_stack([np.cos(angle + turn), np.sin(angle + turn), 0 * angle])
        rays = rays_into(np.array([end, 0.0, 6.0]) + 2.9 * out, -out)
        road = machined_along(rays, [source], BALL)
        assert np.all(road.kind == Kind.PATH_END)
        assert np.allclose(road.deviation, -0.1, atol=1e-11)


def test_a_sharp_edge_sweeps_a_surface_of_its_own():
    """A flat end mill tilted sideways against its path leaves a floor cut by the edge: an ellipse's arc."""
    tilt = radians(20.0)
    axis = np.array([0.0, np.sin(tilt), np.cos(tilt)])
    source = CLMotion(np.array([[0.0, 0, 0], [20.0, 0, 0]]), np.tile(axis, (2, 1)))
    y = np.linspace(-0.8, 2.6, 9)
    rays = rays_into(np.column_stack([np.full(9, 10.0), y, np.full(9, -2.0)]), np.tile(UP, (9, 1)), 1.0, 6.0)
    road = machined_along(rays, [source], FLAT)
    lowest = Swept(source, FLAT).least_distance(rays.origin + road.deviation[:, None] * rays.direction)
    assert np.abs(lowest).max() < 1e-9
    turned = CLMotion(np.array([[0.0, 0, 0], [0.0, 20.0, 0]]), np.tile(axis, (2, 1)))
    x = np.linspace(-2.6, 2.6, 9)
    rays = rays_into(np.column_stack([x, np.full(9, 10.0), np.full(9, -3.0)]), np.tile(UP, (9, 1)), 1.0, 6.0)
    road = machined_along(rays, [turned], FLAT)
    assert np.all(road.kind == Kind.EDGE)
    assert np.allclose(road.deviation, 3.0 - np.sin(tilt) * np.sqrt(9.0 - x**2), atol=1e-9)


@pytest.mark.parametrize("cutter", [BALL, FLAT, CONE], ids=["ball", "flat", "conical"])
@pytest.mark.parametrize("turn_deg", [0.0, 3.0])
def test_both_roads_agree_on_a_winding_path(cutter, turn_deg, rng):
    """Rays up into the floor and walls of a winding five-axis pass: every class, one nanometre."""
    n = 9
    x = np.linspace(0.0, 16.0, n)
    tips = np.column_stack([x, 2.0 * np.sin(0.5 * x), 0.3 * np.cos(0.7 * x)])
    lean = np.radians(turn_deg) * np.column_stack([np.cos(x), np.sin(1.3 * x), 0 * x])
    axes = UP + lean
    source = CLMotion(tips, axes / np.linalg.norm(axes, axis=1, keepdims=True))
    origin = np.column_stack([rng.uniform(-2, 18, 400), rng.uniform(-5, 5, 400), np.full(400, -3.0)])
    rays = rays_into(origin, np.tile(UP, (400, 1)) + 0.2 * rng.normal(size=(400, 3)), 1.0, 9.0)
    road, removal = machined_along(rays, [source], cutter), by_removal(rays, source, cutter)
    removal[removal > 9.0] = np.nan
    both = road.valid & np.isfinite(removal)
    assert both.sum() > 150
    assert np.array_equal(road.valid, np.isfinite(removal))
    assert np.abs(road.deviation - removal)[both].max() < 1e-6
    expected = {Kind.ENVELOPE, Kind.JOINT, Kind.PATH_END} | ({Kind.EDGE} if cutter is FLAT else set())
    assert expected <= set(road.kind[both])


def test_candidates_are_more_than_what_survives():
    """The far branch and the run past the window are candidates too; trimming chooses."""
    source = CLMotion(np.array([[0.0, 0, 0], [10.0, 0, 0]]), np.tile(UP, (2, 1)))
    rays = rays_into(np.array([[5.0, 3.5, 6.0]]), np.array([[0.0, -1.0, 0.0]]), 1.0, 8.0)
    found = Candidates(Swept(source, BALL)).along(rays)
    assert np.allclose(np.unique(np.round(found.tau, 6)), [0.5, 6.5])
    assert machined_along(rays, [source], BALL).deviation[0] == pytest.approx(0.5, abs=1e-11)


def test_nothing_reaches_a_ray_far_away():
    source = CLMotion(np.array([[0.0, 0, 0], [10.0, 0, 0]]), np.tile(UP, (2, 1)))
    road = machined_along(rays_into(np.array([[5.0, 40.0, 6.0]]), np.array([[0.0, -1.0, 0.0]])), [source], BALL)
    assert not road.valid[0]
    assert np.isnan(road.deviation[0])
    assert road.share() == {"envelope": 0.0, "joint": 0.0, "path_end": 0.0, "edge": 0.0}


def test_the_second_chart_of_arcs_holds_for_inner_edges_of_rings(rng):
    """Their normals point towards the axis; the chart must give the points of the first one there too."""
    head = face_mill_head(63.5, 2.54, radians(22.0), radians(22.0), 0.8, 12.0)
    arcs = [i for i, e in enumerate(head.elements) if e.is_arc]
    source = random_cl(rng, 2)
    n = 2000
    piece, t, angle = np.zeros(n, dtype=int), rng.uniform(0.0, 1.0, n), rng.uniform(0.0, 2.0 * np.pi, n)
    for element in arcs:
        label = np.full(n, element)
        point, _, _, s, branch = arc_jet(source, head, piece, t, label, angle)
        on = (s >= 0.0) & (s <= head.elements[element].length)
        assert on.sum() > 20
        other = envelope_points(source, head, piece[on], t[on], label[on], s[on], branch[on])
        assert np.allclose(other.point, point[on], atol=1e-9)
