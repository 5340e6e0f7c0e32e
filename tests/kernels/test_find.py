"""Planes between ray and cutter, and the search that they make certain, against signed distances and dense scans."""

from math import radians

import numpy as np
import pytest
import warp as wp

from gearsim.cutters.catalogue import apt, conical
from gearsim.kernels.find import HIT, LOST, NONE, find_pose, least_clearance
from gearsim.kernels.gaps import find_gap
from gearsim.kernels.look import look_at
from gearsim.kernels.pose import Motion, pose_at
from gearsim.kernels.profile import Cutters, convex_part
from gearsim.kernels.support import apart, clearance, support_point
from gearsim.motion.segments import SegmentTable, compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation.tools import cutter_data, motion_data
from tests.cutters.shapes import barrel, spindle

CUTTERS = {
    "conical": conical(1.0, 1.5, radians(15.0), 25.0),
    "ball": apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0),
    "flat": apt(8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0),
    "bull": apt(10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0),
    "barrel": barrel(),
    "spindle": spindle(),
}
EXTENT = 200.0


@wp.kernel(enable_backward=False)
def support_kernel(cutters: Cutters, n: wp.array(dtype=wp.vec2d), out: wp.array(dtype=wp.vec2d)):
    i = wp.tid()
    out[i] = support_point(convex_part(cutters, 0, wp.float64(EXTENT)), n[i][0], n[i][1])


@wp.kernel(enable_backward=False)
def apart_kernel(
    cutters: Cutters, motion: Motion, x: wp.float64, origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d), n_out: wp.array(dtype=wp.vec3d), gap_out: wp.array(dtype=wp.float64),
):  # fmt: skip
    i = wp.tid()
    part = convex_part(cutters, 0, wp.float64(EXTENT))
    pose = pose_at(motion, 0, x)
    n_out[i] = apart(part, pose, origin[i], direction[i])
    gap_out[i] = clearance(part, pose, origin[i], n_out[i])


@wp.kernel(enable_backward=False)
def bound_kernel(
    cutters: Cutters, motion: Motion, stretch: wp.vec2d, origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d), hits_out: wp.array(dtype=wp.int32), least_out: wp.array(dtype=wp.float64),
):  # fmt: skip
    i = wp.tid()
    part = convex_part(cutters, 0, wp.float64(EXTENT))
    a = look_at(part, motion, 0, origin[i], direction[i], stretch, wp.float64(-1.0), 0)
    b = look_at(part, motion, 0, origin[i], direction[i], stretch, wp.float64(1.0), 0)
    hits_out[i] = a.hit + b.hit
    if a.hit + b.hit == 0:
        least_out[i] = least_clearance(part, motion, 0, a, b)


@wp.kernel(enable_backward=False)
def find_kernel(
    cutters: Cutters, motion: Motion, stretch: wp.vec2d, origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d), outcome_out: wp.array(dtype=wp.int32), x_out: wp.array(dtype=wp.float64),
):  # fmt: skip
    i = wp.tid()
    part = convex_part(cutters, 0, wp.float64(EXTENT))
    find = find_pose(part, motion, 0, origin[i], direction[i], wp.float64(-1.0), wp.float64(1.0), stretch, 0)
    outcome_out[i] = find.outcome
    x_out[i] = find.x


@wp.kernel(enable_backward=False)
def gap_kernel(
    cutters: Cutters, motion: Motion, origin: wp.array(dtype=wp.vec3d), direction: wp.array(dtype=wp.vec3d),
    x: wp.array(dtype=wp.vec2d), outcome_out: wp.array(dtype=wp.int32),
):  # fmt: skip
    i = wp.tid()
    part = convex_part(cutters, 0, wp.float64(EXTENT))
    outcome_out[i] = find_gap(part, motion, 0, origin[i], direction[i], x[i][0], x[i][1]).outcome


def one_row(rng, turn: float, travel: float) -> SegmentTable:
    """A row of a CL step of random direction."""
    axis, side = rng.normal(size=(2, 3))
    axis /= np.linalg.norm(axis)
    side = np.cross(axis, side) / np.linalg.norm(np.cross(axis, side))
    axes = np.array([axis, np.cos(turn) * axis + np.sin(turn) * side])
    tips = np.array([rng.uniform(-20, 20, 3), np.zeros(3)])
    tips[1] = tips[0] + travel * rng.normal(size=3)
    table = compile_motion(CLMotion(tips, axes), 30.0)
    return table.part(slice(0, 1))


def poses(table: SegmentTable, x: np.ndarray):
    powers = np.vander(np.atleast_1d(x), 6, increasing=True)
    return powers @ table.tip[0], powers @ table.axis[0]


def distance_along(cutter, table, x, origin, direction, tau):
    """Signed distance of each ray's point ``tau`` to the cutter at one pose, or each at its own."""
    tip, axis = poses(table, x)
    q = origin + tau[..., None] * direction - tip
    z = (q * axis).sum(axis=-1)
    return cutter.signed_distance(np.linalg.norm(q - z[..., None] * axis, axis=-1), z)


def rays_near(rng, cutter, table, n):
    tip, axis = (a[0] for a in poses(table, 0.0))
    centre = tip + 0.5 * cutter.height * axis
    direction = rng.normal(size=(n, 3))
    direction[: n // 4] = axis + 1e-3 * direction[: n // 4]
    direction[n // 4 : n // 3] -= (direction[n // 4 : n // 3] @ axis)[:, None] * axis
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    return centre + rng.uniform(-1.4, 1.4, (n, 3)) * max(cutter.max_radius, 6.0), direction


def least_along(cutter, table, x, origin, direction, lo=-60.0, hi=60.0):
    """Least signed distance of a ray's stretch, by golden sections on a function that is convex."""
    n = len(origin)
    a, b = np.full(n, lo), np.full(n, hi)
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    for _ in range(80):
        x1, x2 = b - golden * (b - a), a + golden * (b - a)
        f1, f2 = (distance_along(cutter, table, x, origin, direction, t) for t in (x1, x2))
        a, b = np.where(f1 < f2, a, x1), np.where(f1 < f2, x2, b)
    return distance_along(cutter, table, x, origin, direction, 0.5 * (a + b))


def least_over(cutter, table, x, origin, direction, lo, hi):
    """The least of that over several poses."""
    each = np.repeat(x, len(origin))
    origin, direction = (np.tile(v, (len(x), 1)) for v in (origin, direction))
    return least_along(cutter, table, each, origin, direction, lo, hi).reshape(len(x), -1).min(axis=0)


def arrays(device, *values):
    return [wp.array(v, dtype=wp.vec3d, device=device) for v in values]


@pytest.mark.parametrize("name", CUTTERS)
def test_the_support_point_is_the_farthest_of_all(name, device, rng):
    cutter = CUTTERS[name]
    angle = np.concatenate([rng.uniform(0.0, np.pi, 300), [0.0, 0.5 * np.pi, np.pi]])
    n = np.column_stack([np.sin(angle), np.cos(angle)])
    out = wp.zeros(len(n), dtype=wp.vec2d, device=device)
    inputs = [cutter_data([cutter], device), wp.array(n, dtype=wp.vec2d, device=device)]
    wp.launch(support_kernel, dim=len(n), inputs=inputs, outputs=[out], device=device)
    places = [e.at(np.linspace(0.0, e.length, 2000)) for e in cutter.elements]
    points = np.concatenate([np.column_stack([p.r, p.z]) for p in places])
    reached = np.einsum("ij,ij->i", out.numpy(), n)
    assert np.all(reached >= (points @ n.T).max(axis=0) - 1e-12)
    assert np.allclose(cutter.signed_distance(*out.numpy().T), 0.0, atol=1e-12)


@pytest.mark.parametrize("name", CUTTERS)
def test_the_best_plane_is_as_far_as_the_ray(name, device, rng):
    """Duality: the greatest clearance over all planes along a ray is the ray's distance."""
    cutter, n = CUTTERS[name], 1500
    table = one_row(rng, radians(0.4), 1.0)
    origin, direction = rays_near(rng, cutter, table, n)
    normal, gap = (wp.zeros(n, dtype=t, device=device) for t in (wp.vec3d, wp.float64))
    inputs = [cutter_data([cutter], device), motion_data(table, device), 0.3, *arrays(device, origin, direction)]
    wp.launch(apart_kernel, dim=n, inputs=inputs, outputs=[normal, gap], device=device)
    true = least_along(cutter, table, 0.3, origin, direction)
    misses = true > 1e-9
    assert 0.2 < misses.mean() < 0.98
    assert np.abs(gap.numpy() - true)[misses].max() < 1e-9
    assert np.abs(np.einsum("ij,ij->i", normal.numpy(), direction)).max() < 1e-15
    assert np.allclose(np.linalg.norm(normal.numpy(), axis=1), 1.0, atol=1e-14)


@pytest.mark.parametrize(("turn", "travel"), [(0.0, 2.0), (0.4, 0.0), (0.4, 0.5), (0.1, 5.0)])
def test_no_pose_is_nearer_than_the_bound(turn, travel, device, rng):
    total = 0
    for cutter in CUTTERS.values():
        table = one_row(rng, radians(turn), travel)
        origin, direction = rays_near(rng, cutter, table, 400)
        hits, least = (wp.zeros(400, dtype=t, device=device) for t in (wp.int32, wp.float64))
        inputs = [cutter_data([cutter], device), motion_data(table, device), wp.vec2d(-4.0, 3.0)]
        inputs += arrays(device, origin, direction)
        wp.launch(bound_kernel, dim=400, inputs=inputs, outputs=[hits, least], device=device)
        free = hits.numpy() == 0
        true = least_over(cutter, table, np.linspace(-1, 1, 21), origin[free], direction[free], -4.0, 3.0)
        assert np.all(least.numpy()[free] <= true + 1e-9)
        total += np.count_nonzero(least.numpy()[free] > 0.0)
    assert total > 100


@pytest.mark.parametrize(("turn", "travel"), [(0.0, 3.0), (0.4, 0.0), (0.4, 2.0)])
def test_a_pose_is_found_wherever_one_hits(turn, travel, device, rng):
    found = 0
    for cutter in CUTTERS.values():
        table = one_row(rng, radians(turn), travel)
        origin, direction = rays_near(rng, cutter, table, 300)
        outcome, x = (wp.zeros(300, dtype=t, device=device) for t in (wp.int32, wp.float64))
        inputs = [cutter_data([cutter], device), motion_data(table, device), wp.vec2d(-4.0, 3.0)]
        inputs += arrays(device, origin, direction)
        wp.launch(find_kernel, dim=300, inputs=inputs, outputs=[outcome, x], device=device)
        true = least_over(cutter, table, np.linspace(-1, 1, 41), origin, direction, -4.0, 3.0)
        assert np.all(outcome.numpy()[true < -1e-12] == HIT)
        assert np.all(outcome.numpy() != LOST)
        hit = outcome.numpy() == HIT
        assert np.all(least_along(cutter, table, x.numpy()[hit], origin[hit], direction[hit], -4.0, 3.0) <= 1e-12)
        found += np.count_nonzero((outcome.numpy() == HIT) & (true > -0.1))
    assert found > 20


def test_what_lies_between_two_chords_is_one_stretch_or_has_a_gap(device):
    """A ball led along a ray sweeps one stretch; one that leaves the ray on the way does not."""
    ball = CUTTERS["ball"]
    straight = compile_motion(CLMotion(np.array([[0.0, 0, 0], [40.0, 0, 0]]), np.tile([0.0, 0, 1.0], (2, 1))), 30.0)
    arch = straight.tip.copy()
    arch[:, 2] = [0.0, 0.0, -8.0]
    arch[:, 0, 2] = 8.0
    hump = SegmentTable(**{**vars(straight), "tip": arch, "acceleration": straight.acceleration + 16.0})
    origin, direction = np.array([[-10.0, 2.0, 3.0]]), np.array([[1.0, 0.0, 0.0]])
    for table, expected in ((straight, NONE), (hump, HIT)):
        outcome = wp.zeros(1, dtype=wp.int32, device=device)
        ends = wp.array(np.array([[-1.0, 1.0]]), dtype=wp.vec2d, device=device)
        inputs = [cutter_data([ball], device), motion_data(table, device), *arrays(device, origin, direction), ends]
        wp.launch(gap_kernel, dim=1, inputs=inputs, outputs=[outcome], device=device)
        assert outcome.numpy()[0] == expected
