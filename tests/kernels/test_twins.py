"""Every layer of the kernels against a NumPy twin."""

from math import radians

import numpy as np
import pytest
import warp as wp

from gearsim.cutters.catalogue import apt, conical
from gearsim.envelope.surface import envelope_grid, envelope_points
from gearsim.kernels.cull import near_stretch
from gearsim.kernels.distance import surface_distance
from gearsim.kernels.interval import IntervalLists, insert
from gearsim.kernels.pose import Motion, pose_at
from gearsim.kernels.profile import Cutters, convex_part, cutter_interval
from gearsim.kernels.tool_ray import tool_ray
from gearsim.motion.segments import DEGREE, compile_motion
from gearsim.simulation.tools import cutter_data, motion_data
from gearsim.toolpaths.flank import FlankPath
from tests.cutters.shapes import barrel, spindle
from tests.motion.test_sources import random_cl

CUTTERS = [
    conical(1.0, 1.5, radians(15.0), 25.0),
    apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0),
    apt(8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0),
    apt(10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0),
    barrel(),
    spindle(),
]
NAMES = ["conical", "ball", "flat", "bull", "barrel", "spindle"]


@wp.kernel(enable_backward=False)
def interval_kernel(
    cutters: Cutters,
    origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d),
    spread: wp.float64,
    window: wp.vec2d,
    found_out: wp.array(dtype=wp.int32),
    ends_out: wp.array(dtype=wp.vec2d),
    near_out: wp.array(dtype=wp.vec2d),
):
    i = wp.tid()
    zero = wp.float64(0.0)
    tip = wp.vec3d(zero, zero, zero)
    axis = wp.vec3d(zero, zero, wp.float64(1.0))
    part = convex_part(cutters, 0, wp.float64(0.0))
    ray = tool_ray(tip, axis, part.middle, origin[i], direction[i])
    hit = cutter_interval(part, ray)
    found_out[i] = hit.found
    ends_out[i] = wp.vec2d(hit.lo + ray.shift, hit.hi + ray.shift)
    near_out[i] = near_stretch(part, tip, axis, spread, origin[i], direction[i], window)


@wp.kernel(enable_backward=False)
def distance_kernel(cutters: Cutters, rz: wp.array(dtype=wp.vec2d), out: wp.array(dtype=wp.vec3d)):
    i = wp.tid()
    out[i] = surface_distance(convex_part(cutters, 0, wp.float64(0.0)), rz[i][0], rz[i][1])


@wp.kernel(enable_backward=False)
def pose_kernel(motion: Motion, x: wp.float64, out: wp.array2d(dtype=wp.vec3d)):
    i = wp.tid()
    pose = pose_at(motion, i, x)
    out[i, 0] = pose.tip
    out[i, 1] = pose.axis
    out[i, 2] = pose.tip_rate
    out[i, 3] = pose.axis_rate


@wp.kernel(enable_backward=False)
def insert_kernel(lists: IntervalLists, lo: wp.array2d(dtype=wp.float64), hi: wp.array2d(dtype=wp.float64),
                  fits: wp.array(dtype=wp.int32)):  # fmt: skip
    ray = wp.tid()
    for k in range(lo.shape[1]):
        if not insert(lists, ray, lo[ray, k], hi[ray, k], k, k, wp.float64(1.0e-9)):
            fits[ray] = 0


def distance_along(cutter, origin, direction, tau):
    p = origin + tau[..., None] * direction
    return cutter.signed_distance(np.hypot(p[..., 0], p[..., 1]), p[..., 2])


def chord_twin(cutter, origin, direction):
    """Chord by convex minimisation of the signed distance and bisection: no slabs, no quadratics."""
    a, b = np.full(len(origin), -80.0), np.full(len(origin), 80.0)
    golden = 0.5 * (np.sqrt(5.0) - 1.0)
    for _ in range(90):
        x1, x2 = b - golden * (b - a), a + golden * (b - a)
        left = distance_along(cutter, origin, direction, x1) < distance_along(cutter, origin, direction, x2)
        a, b = np.where(left, a, x1), np.where(left, x2, b)
    middle = 0.5 * (a + b)
    ends = []
    for outside in (-80.0, 80.0):
        out, inner = np.full(len(origin), outside), middle.copy()
        for _ in range(70):
            half = 0.5 * (out + inner)
            inside = distance_along(cutter, origin, direction, half) < 0.0
            out, inner = np.where(inside, out, half), np.where(inside, half, inner)
        ends.append(inner)
    return distance_along(cutter, origin, direction, middle), ends[0], ends[1]


@pytest.mark.parametrize("cutter", CUTTERS, ids=NAMES)
def test_pose_intersection(cutter, device, rng):
    n = 4000
    origin = rng.uniform(-12, 12, (n, 3)) + np.array([0, 0, 10])
    direction = rng.normal(size=(n, 3))
    direction[: n // 4, 2] = 0.0
    direction[n // 4 : n // 3] = [0.0, 0.0, 1.0]
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    deepest, lo, hi = chord_twin(cutter, origin, direction)
    rays = [wp.array(a, dtype=wp.vec3d, device=device) for a in (origin, direction)]
    for spread, window in [(0.0, [-80.0, 80.0]), (0.7, [-80.0, 80.0]), (0.7, [-9.0, 2.0])]:
        found = wp.zeros(n, dtype=wp.int32, device=device)
        ends, near = (wp.zeros(n, dtype=wp.vec2d, device=device) for _ in range(2))
        inputs = [cutter_data([cutter], device), *rays, spread, wp.vec2d(window)]
        wp.launch(interval_kernel, dim=n, inputs=inputs, outputs=[found, ends, near], device=device)
        clear = np.abs(deepest) > 1e-6
        assert np.array_equal((found.numpy() == 1)[clear], (deepest < 0.0)[clear])
        hit = clear & (deepest < 0.0)
        assert hit.sum() > 100
        assert np.allclose(ends.numpy()[hit], np.column_stack([lo, hi])[hit], atol=2e-9)
        check_near_stretch(cutter, origin, direction, spread, window, near.numpy())


def check_near_stretch(cutter, origin, direction, spread, window, near):
    """It holds every point of the window within the spread, and keeps to the window; far misses are empty."""
    tau = np.linspace(*window, 161)
    distance = distance_along(cutter, origin[:, None], direction[:, None], tau[None, :])
    inside = (tau >= near[:, :1] - 1e-12) & (tau <= near[:, 1:] + 1e-12)
    assert np.all(inside[distance <= spread])
    full = near[:, 0] <= near[:, 1]
    assert near[full].min() > window[0] - 1e-12
    assert near[full].max() < window[1] + 1e-12
    assert not np.any(full[distance.min(axis=1) > spread + 4.0])
    assert 0.03 < full.mean() < 0.95


@pytest.mark.parametrize("cutter", CUTTERS, ids=NAMES)
def test_surface_distance(cutter, device, rng):
    r, z = rng.uniform(0.0, 14.0, 5000), rng.uniform(-4.0, 32.0, 5000)
    out = wp.zeros(5000, dtype=wp.vec3d, device=device)
    rz = wp.array(np.column_stack([r, z]), dtype=wp.vec2d, device=device)
    wp.launch(distance_kernel, dim=5000, inputs=[cutter_data([cutter], device), rz], outputs=[out], device=device)
    f, nr, nz = cutter.distance_gradient(r, z)
    outside = f > 1e-9
    assert np.allclose(out.numpy()[outside], np.column_stack([f, nr, nz])[outside], atol=1e-11)
    assert np.allclose(out.numpy()[:, 0], np.abs(f), atol=1e-11)


def test_pose(device, rng):
    table = compile_motion(random_cl(rng), 25.0)
    out = wp.zeros((len(table), 4), dtype=wp.vec3d, device=device)
    wp.launch(pose_kernel, dim=len(table), inputs=[motion_data(table, device), 0.37], outputs=[out], device=device)
    powers = 0.37 ** np.arange(DEGREE + 1)
    rates = np.arange(DEGREE + 1) * np.append(0.0, 0.37 ** np.arange(DEGREE))
    expected = [np.einsum("k,nkc->nc", w, c) for w in (powers, rates) for c in (table.tip, table.axis)]
    assert np.allclose(out.numpy(), np.stack(expected, axis=1), atol=1e-14)


@pytest.mark.parametrize("slots", [16, 3])
def test_interval_lists(device, rng, slots):
    rays, cuts = 300, 12
    lo = rng.uniform(0.0, 40.0, (rays, cuts))
    hi = lo + rng.exponential(1.5, (rays, cuts))
    lists = IntervalLists()
    for name in ("lo", "hi"):
        setattr(lists, name, wp.zeros((rays, slots), dtype=wp.float64, device=device))
        setattr(lists, f"{name}_segment", wp.zeros((rays, slots), dtype=wp.int32, device=device))
    lists.count = wp.zeros(rays, dtype=wp.int32, device=device)
    lists.slots = slots
    fits = wp.array(np.ones(rays), dtype=wp.int32, device=device)
    arrays = [wp.array(a, dtype=wp.float64, device=device) for a in (lo, hi)]
    wp.launch(insert_kernel, dim=rays, inputs=[lists, *arrays], outputs=[fits], device=device)
    for i in range(rays):
        union: list[list[float]] = []
        for a, b in sorted(zip(lo[i], hi[i], strict=True)):
            if union and a <= union[-1][1]:
                union[-1][1] = max(union[-1][1], b)
            else:
                union.append([a, b])
        if fits.numpy()[i]:
            n = lists.count.numpy()[i]
            assert np.allclose(np.column_stack([lists.lo.numpy()[i, :n], lists.hi.numpy()[i, :n]]), union)
            made = lists.lo_segment.numpy()[i, :n]
            assert np.allclose(lo[i, made], [u[0] for u in union])
        else:
            assert slots == 3
    assert fits.numpy().all() == (slots == 16)


def test_envelope_points_agree_to_1e_12_mm(device, tooth, fitting_cutter):
    source = FlankPath(tooth, "concave", fitting_cutter, 8.0).motion
    grid = envelope_grid(source, fitting_cutter, 40, 9, device)
    i, j, k = (a.ravel() for a in np.indices(grid.exists.shape))
    branch = np.array([1.0, -1.0])[k]
    twin = envelope_points(source, fitting_cutter, grid.piece[i], grid.t[i], grid.element[j], grid.s[j], branch)
    exists = grid.exists.ravel()
    assert np.array_equal(exists, twin.exists)
    assert 0.3 < exists.mean() < 1.0
    assert np.abs(grid.point.reshape(-1, 3) - twin.point)[exists].max() < 1e-12
    assert np.abs(grid.normal.reshape(-1, 3) - twin.normal)[exists].max() < 1e-12
