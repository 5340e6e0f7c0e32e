"""The removal road for rings, barrels and undercut tools: closed forms, and searches that share no code with it."""

from dataclasses import fields
from math import radians, tan

import numpy as np
import pytest

from gearsim.envelope.swept import Swept
from gearsim.errors import Status
from gearsim.simulation import removal
from gearsim.simulation.removal import cut
from tests.cutters.shapes import every_shape, ring
from tests.simulation.test_removal import UP, bundle, compile_motion, grazing_rays, random_path, removed, straight

SHAPES = {**every_shape(), "head": ring(), "sharp head": ring(edge=0.0)}
SHARP = every_shape()["sharp ring"]  # radius 6, point width 1, height 6, flanks 19 deg inside, 23 deg outside
HEIGHT = 6.0


def inner(z):
    return 5.5 - z * tan(radians(19.0))


def outer(z):
    return 6.5 + z * tan(radians(23.0))


def floor(r):
    """Height of the sharp ring's lower side at radius r."""
    return np.maximum(np.maximum((5.5 - r) / tan(radians(19.0)), (r - 6.5) / tan(radians(23.0))), 0.0)


def test_a_plunged_ring_leaves_the_core(device, rng):
    """Rays across the axis meet the ring's section, widened by the depth of the plunge, twice."""
    z, depth = rng.uniform(-3.9, 5.9, 100), 4.0
    angle = rng.uniform(0.0, 6.28, 100)
    direction = np.column_stack([np.cos(angle), np.sin(angle), np.zeros(100)])
    rays = bundle(-20.0 * direction + z[:, None] * UP, direction)
    result = removed(rays, straight([0, 0, 0], [0, 0, -depth]), SHARP, device).require_trust().removed
    assert np.array_equal(np.diff(result.first), np.full(100, 2))
    top = np.minimum(z + depth, HEIGHT)
    expected = np.column_stack([20 - outer(top), 20 - inner(top), 20 + inner(top), 20 + outer(top)])
    ours = np.stack([result.lo, result.hi], axis=1).reshape(100, 4)
    assert np.allclose(ours, expected, atol=1e-9)


def test_a_ring_moved_across_its_axis_cuts_a_slot_as_deep_as_its_radii_reach(device, rng):
    """Rays along the axis: the lowest part of the section among the radii that pass over the ray."""
    x, y = rng.uniform(-14.0, 19.0, 400), rng.uniform(-10.0, 10.0, 400)
    rays = bundle(np.column_stack([x, y, np.full(400, -10.0)]), UP)
    result = removed(rays, straight([0, 0, 0], [5, 0, 0]), SHARP, device).require_trust().removed
    nearest, farthest = np.hypot(x - np.clip(x, 0.0, 5.0), y), np.hypot(np.maximum(np.abs(x), np.abs(x - 5.0)), y)
    low = np.minimum(floor(nearest), floor(farthest))
    low[(nearest < 6.5) & (farthest > 5.5)] = 0.0
    cut_at_all = low < HEIGHT
    assert 100 < np.count_nonzero(cut_at_all) < 390
    assert np.array_equal(np.diff(result.first), cut_at_all.astype(int))
    assert np.allclose(result.lo, 10.0 + low[cut_at_all], atol=1e-9)
    assert np.allclose(result.hi, 10.0 + HEIGHT, atol=1e-9)


def test_a_t_slot_cutter_leaves_the_lips_of_its_slot(device):
    """A ray up through the lip passes the disc only; beside it, through the neck, all of the tool."""
    source, tool = straight([0, 0, 0], [30, 0, 0]), SHAPES["T-slot"]
    rays = bundle([[15.0, 5.0, -5.0], [15.0, 2.0, -5.0], [15.0, -7.0, -5.0], [15.0, 8.5, -5.0]], UP)
    result = removed(rays, source, tool, device).require_trust().removed
    assert np.allclose(result.lo, 5.0, atol=1e-9)
    assert np.allclose(result.hi, [9.0, 25.0, 9.0], atol=1e-9)


def test_a_ray_down_the_axis_of_a_pointed_tool_meets_both_points(device):
    source = straight([0, 0, 0], [0, 0, 1.0])
    result = removed(bundle([0, 0, -5], UP), source, SHAPES["spindle"], device).require_trust().removed
    assert np.allclose([result.lo[0], result.hi[0]], [5.0, 14.0], atol=1e-9)


@pytest.mark.parametrize("name", SHAPES)
def test_torture_no_hit_is_lost_and_no_gap_spanned(device, name):
    """Grazing rays against the least distance over the exact motion, as in test_removal."""
    rng = np.random.default_rng(len(name))
    cutter = SHAPES[name]
    for _ in range(6):
        source = random_path(rng)
        rays = grazing_rays(rng, source, cutter, 10)
        result = removed(rays, source, cutter, device).require_trust()
        tau, inside, ends = [], [], []
        for i in range(len(rays)):
            own = slice(result.removed.first[i], result.removed.first[i + 1])
            mine = np.column_stack([result.removed.lo[own], result.removed.hi[own]])
            near = np.concatenate([10.0 ** np.arange(-8, 0), -(10.0 ** np.arange(-8, 0))])
            tau.append(np.concatenate([rng.uniform(-60, 60, 30), *(e + near for e in mine.ravel()), mine.mean(axis=1)]))
            tau[-1] = tau[-1][np.abs(tau[-1]) < 60.0]
            inside.append(((tau[-1][:, None] >= mine[:, 0]) & (tau[-1][:, None] <= mine[:, 1])).any(axis=1))
            ends.append(mine.ravel()[np.abs(mine.ravel()) < 60.0])

        def distance(along, source=source, rays=rays):
            ray = np.repeat(np.arange(len(rays)), [len(a) for a in along])
            points = rays.origin[ray] + np.concatenate(along)[:, None] * rays.direction[ray]
            return Swept(source, cutter).least_distance(points)

        f, within = distance(tau), np.concatenate(inside)
        assert np.all(f[~within] > -1e-9)
        assert np.all(f[within] < 1e-9)
        assert np.all(np.abs(distance(ends)) < 2e-9)


@pytest.mark.parametrize("name", ["ring", "sharp ring", "T-slot", "spindle"])
def test_intervals_agree_with_a_plain_scan_of_poses_and_ray_points(device, name, rng):
    """No bound, no minimum searched for: 301 poses by 601 points of each ray, the tool standing at each."""
    cutter, source = SHAPES[name], random_path(rng)
    rays = grazing_rays(rng, source, cutter, 12)
    result = removed(rays, source, cutter, device).require_trust().removed
    x = np.linspace(0.0, source.pieces, 301)
    piece = np.minimum(x.astype(int), source.pieces - 1)
    pose = source.pose(piece, x - piece, 0)
    tip, axis = pose.tip.value[:, None], pose.axis.value[:, None]
    step = np.linalg.norm(np.diff(tip, axis=0), axis=2) + cutter.reach * np.linalg.norm(np.diff(axis, axis=0), axis=2)
    tau = np.linspace(-25.0, 25.0, 601)
    for i in range(len(rays)):
        q = rays.origin[i] + tau[:, None] * rays.direction[i] - tip
        z = np.sum(q * axis, axis=2)
        f = cutter.signed_distance(np.linalg.norm(q - z[..., None] * axis, axis=2), z).min(axis=0)
        own = slice(result.first[i], result.first[i + 1])
        inside = ((tau[:, None] >= result.lo[own]) & (tau[:, None] <= result.hi[own])).any(axis=1)
        assert np.all(inside[f < -1e-9])
        assert not np.any(inside[f > 0.51 * step.max()])  # no pose is farther from a scanned one


@pytest.mark.parametrize("name", ["ring", "T-slot"])
def test_cpu_threads_and_tiles_are_bit_identical(name, rng, monkeypatch):
    source, cutter = random_path(rng), SHAPES[name]
    rays = grazing_rays(rng, source, cutter, 300)
    table = compile_motion(source, cutter.reach)
    one = cut(rays, table, cutter, threads=1)
    monkeypatch.setattr(removal, "SLICE_RAYS", 37)
    monkeypatch.setattr(removal, "tile_rays", lambda slots: 130)
    many = cut(rays, table, cutter, threads=2)
    for f in fields(one.removed):
        assert np.array_equal(getattr(one.removed, f.name), getattr(many.removed, f.name))
    assert (one.pairs, one.candidates) == (many.pairs, many.candidates)


def test_a_rings_full_interval_list_is_told(device):
    ray = bundle([-20.0, 0.0, 2.0], [1.0, 0.0, 0.0])
    source = straight([0, 0, 0], [0, 0, -1.0])
    assert removed(ray, source, SHARP, device, slots=2).status == Status.OK
    assert removed(ray, source, SHARP, device, slots=1).status == Status.INTERVALS_OVERFLOW
