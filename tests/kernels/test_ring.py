"""The ring's kernel functions against NumPy twins and finite differences."""

import numpy as np
import pytest
import warp as wp

from gearsim.kernels.interval import IntervalLists, free_stretch
from gearsim.kernels.pose import Motion
from gearsim.kernels.ring import Ring, gap_of, over_line, section_distance, window_of
from gearsim.kernels.ring_search import least_in
from gearsim.motion.segments import compile_motion
from gearsim.simulation.tools import motion_data, ring_data
from tests.cutters.shapes import every_shape, ring
from tests.simulation.test_removal import random_path

RINGS = {"ring": every_shape()["ring"], "sharp ring": every_shape()["sharp ring"], "head": ring()}
F64 = wp.float64


@wp.kernel(enable_backward=False)
def section_kernel(ring: Ring, rz: wp.array(dtype=wp.vec2d), out: wp.array(dtype=wp.vec3d)):
    i = wp.tid()
    out[i] = section_distance(ring, rz[i][0], rz[i][1])


@wp.kernel(enable_backward=False)
def gap_kernel(
    ring: Ring, motion: Motion, row: wp.array(dtype=int), origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d), at: wp.array(dtype=wp.vec2d), box: wp.array(dtype=wp.vec2d),
    gap_out: wp.array2d(dtype=F64),
):  # fmt: skip
    i = wp.tid()
    g = gap_of(ring, motion, row[i], origin[i], direction[i], at[i][0], at[i][1])
    window = window_of(ring, motion, row[i], origin[i], direction[i])
    gap_out[i, 0] = g.f
    gap_out[i, 1] = g.push
    gap_out[i, 2] = g.steep
    gap_out[i, 3] = least_in(ring, motion, row[i], g, box[i][0], box[i][1])[0]
    gap_out[i, 4] = window[0]
    gap_out[i, 5] = window[1]
    gap_out[i, 6] = F64(-1.0e9)
    gap_out[i, 7] = F64(-1.0e9)
    for k in range(ring.lines.shape[0]):
        over = over_line(ring, g, k)
        gap_out[i, 6] = wp.max(gap_out[i, 6], over.f)
        gap_out[i, 7] = wp.max(gap_out[i, 7], least_in(ring, motion, row[i], over, box[i][0], box[i][1])[0])


@wp.kernel(enable_backward=False)
def free_kernel(lists: IntervalLists, lo: F64, hi: F64, margin: F64, out: wp.array(dtype=wp.vec2d)):
    ray = wp.tid()
    out[ray] = free_stretch(lists, ray, lo, hi, margin)


class Pairs:
    """Random segment rows and rays near a ring moved along them; evaluated by the kernel."""

    def __init__(self, cutter, rng, n, device):
        self.cutter, self.device, self.n = cutter, device, n
        self.table = compile_motion(random_path(rng), cutter.reach)
        self.row = rng.integers(len(self.table), size=n)
        self.direction = rng.normal(size=(n, 3))
        self.direction /= np.linalg.norm(self.direction, axis=1, keepdims=True)
        low_r, high_r, low_z, high_z = cutter.box
        tip, axis = self.table.tip[self.row, 0], self.table.axis[self.row, 0]
        u = np.cross(axis, rng.normal(size=(n, 3)))
        u /= np.linalg.norm(u, axis=1, keepdims=True)
        r, z = rng.uniform(low_r - 2, high_r + 2, (n, 1)), rng.uniform(low_z - 2, high_z + 2, (n, 1))
        self.origin = tip + z * axis + r * u

    def kernel(self, x, tau, hx, ht):
        def vectors(a, dtype):
            return wp.array(np.ascontiguousarray(a), dtype=dtype, device=self.device)

        out = wp.zeros((self.n, 8), dtype=F64, device=self.device)
        inputs = [
            ring_data(self.cutter, 100.0, self.device), motion_data(self.table, self.device),
            vectors(self.row.astype(np.int32), int), vectors(self.origin, wp.vec3d), vectors(self.direction, wp.vec3d),
            vectors(np.column_stack([x, tau]), wp.vec2d), vectors(np.column_stack([hx, ht]), wp.vec2d),
        ]  # fmt: skip
        wp.launch(gap_kernel, dim=self.n, inputs=inputs, outputs=[out], device=self.device)
        return out.numpy()

    def distance(self, x, tau):
        """The same distance in NumPy, from the meridian's own."""
        powers = np.power.outer(x, np.arange(6))
        tip = np.einsum("nk,nkc->nc", powers, self.table.tip[self.row])
        axis = np.einsum("nk,nkc->nc", powers, self.table.axis[self.row])
        q = self.origin + tau[:, None] * self.direction - tip
        z = np.sum(q * axis, axis=1)
        return self.cutter.signed_distance(np.linalg.norm(q - z[:, None] * axis, axis=1), z)


@pytest.mark.parametrize("name", RINGS)
def test_section_distance_is_the_profiles(name, device, rng):
    cutter, n = RINGS[name], 5000
    low_r, high_r, low_z, high_z = cutter.box
    r, z = rng.uniform(max(low_r - 4.0, 0.0), high_r + 4.0, n), rng.uniform(low_z - 4.0, high_z + 4.0, n)
    out = wp.zeros(n, dtype=wp.vec3d, device=device)
    rz = wp.array(np.column_stack([r, z]), dtype=wp.vec2d, device=device)
    wp.launch(section_kernel, dim=n, inputs=[ring_data(cutter, 0.0, device), rz], outputs=[out], device=device)
    f, nr, nz = cutter.distance_gradient(r, z)
    assert np.allclose(out.numpy()[:, 0], f, atol=2e-11)  # the kernel's ring is smaller by 1e-11 mm
    same = np.hypot(out.numpy()[:, 1] - nr, out.numpy()[:, 2] - nz) < 1e-9
    assert np.mean(same) > 0.999  # the rest sits on the medial axis


@pytest.mark.parametrize("name", RINGS)
def test_distance_and_rates_along_a_motion(name, device, rng):
    pairs, h = Pairs(RINGS[name], rng, 2000, device), 1e-5
    x, tau = rng.uniform(-1, 1, 2000), rng.uniform(-3, 3, 2000)
    ours = pairs.kernel(x, tau, 0 * x, 0 * x)
    assert np.allclose(ours[:, 0], pairs.distance(x, tau), atol=5e-11)
    by_x = (pairs.distance(x + h, tau) - pairs.distance(x - h, tau)) / (2 * h)
    by_tau = (pairs.distance(x, tau + h) - pairs.distance(x, tau - h)) / (2 * h)
    assert np.mean(np.abs(ours[:, 1] - by_x) < 1e-5) > 0.99
    assert np.mean(np.abs(ours[:, 2] - by_tau) < 1e-5) > 0.99


@pytest.mark.parametrize("name", RINGS)
def test_the_bound_of_a_box_holds_and_is_sharp_to_second_order(name, device, rng):
    n = 4000
    pairs = Pairs(RINGS[name], rng, n, device)
    hx, ht = 10.0 ** rng.uniform(-3, 0, n), 10.0 ** rng.uniform(-3, 0.7, n)
    x, tau = rng.uniform(-1, 1, n) * (1 - hx), rng.uniform(-3, 3, n)
    ours = pairs.kernel(x, tau, hx, ht)
    corners = [pairs.distance(x + a * hx, tau + b * ht) for a in (-1, 0, 1) for b in (-1, 0, 1)]
    inner = [pairs.distance(x + a * hx, tau + b * ht) for a, b in rng.uniform(-1, 1, (40, 2))]
    least = np.min(corners + inner, axis=0)
    assert np.all(ours[:, 3] <= least + 1e-10)
    assert np.all(ours[:, 7] <= least + 1e-10)  # the lines' own bounds
    assert np.all(ours[:, 6] <= ours[:, 0] + 1e-12)
    assert np.mean(ours[:, 6] > ours[:, 0] - 1e-12) > 0.2
    small = (hx < 3e-3) & (ht < 3e-3)
    assert np.quantile((least - ours[:, 3])[small], 0.9) < 1e-4


def test_no_ring_is_met_outside_its_window(device, rng):
    pairs = Pairs(RINGS["ring"], rng, 500, device)
    zero = np.zeros(500)
    lo, hi = pairs.kernel(zero, zero, zero, zero)[:, 4:6].T
    for _ in range(200):
        x, tau = rng.uniform(-1, 1, 500), rng.uniform(-30, 30, 500)
        outside = (lo > hi) | (tau < lo) | (tau > hi)
        assert np.all(pairs.distance(x, tau)[outside] > 0.0)


def test_free_stretch_is_the_first_that_no_interval_covers(device):
    rows = [[], [(0.0, 2.0)], [(-1.0, 1.0)], [(-1.0, 1.0), (4.0, 6.0)], [(-1.0, 11.0)], [(-5.0, -3.0), (9.0, 12.0)]]
    lists = IntervalLists()
    for k, name in enumerate(("lo", "hi")):
        values = np.zeros((len(rows), 2))
        for i, row in enumerate(rows):
            values[i, : len(row)] = [interval[k] for interval in row]
        setattr(lists, name, wp.array(values, dtype=F64, device=device))
        setattr(lists, f"{name}_segment", wp.zeros((len(rows), 2), dtype=wp.int32, device=device))
    lists.count = wp.array([len(r) for r in rows], dtype=wp.int32, device=device)
    lists.slots = 2
    out = wp.zeros(len(rows), dtype=wp.vec2d, device=device)
    wp.launch(free_kernel, dim=len(rows), inputs=[lists, 0.5, 10.0, 0.25], outputs=[out], device=device)
    expected = [(0.5, 10.0), (2.25, 10.0), (1.25, 10.0), (1.25, 3.75), (1.0, 0.0), (0.5, 8.75)]
    assert np.allclose(out.numpy(), expected)
