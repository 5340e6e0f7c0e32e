"""The removal road against closed forms and against a search that shares no code with it."""

from dataclasses import fields, replace
from math import radians

import numpy as np
import pytest

from gearsim.cutters.catalogue import apt, conical, flat
from gearsim.envelope.swept import Swept
from gearsim.errors import InputError, NumericalError, Status
from gearsim.geometry.rays import RayBundle
from gearsim.motion.segments import SegmentTable, compile_motion, join
from gearsim.motion.sources import CLMotion
from gearsim.simulation import removal
from gearsim.simulation.removal import Job, cut, cut_jobs
from tests.cutters.shapes import every_shape, ring

UP = np.array([0.0, 0.0, 1.0])
FLAT = apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0)
BALL = apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0)
CUTTERS = [conical(1.0, 1.5, radians(15.0), 25.0), BALL, FLAT, conical(0.5, 0.3, radians(3.0), 12.0)]


def straight(start, end, axis=UP):
    return CLMotion(np.array([start, end], dtype=float), np.tile(axis / np.linalg.norm(axis), (2, 1)))


def bundle(origin, direction, start=-50.0, end=50.0):
    origin = np.atleast_2d(origin).astype(float)
    n = len(origin)
    direction = np.broadcast_to(np.asarray(direction, dtype=float), (n, 3))
    direction = direction / np.linalg.norm(direction, axis=1, keepdims=True)
    return RayBundle(origin, direction, np.full(n, start), np.full(n, end))


def removed(rays, source, cutter, device="cpu", **options):
    return cut(rays, compile_motion(source, cutter.reach), cutter, device=device, **options)


def test_a_flat_end_mill_moved_straight_cuts_a_stadium(device, rng):
    """Rays up through a slot of width 6 with round ends, floor at z = 0, top at the tool's."""
    xy = rng.uniform([-6, -6], [16, 6], (400, 2))
    result = removed(
        bundle(np.column_stack([xy, np.full(400, -5.0)]), UP), straight([0, 0, 0], [10, 0, 0]), FLAT, device
    )
    inside = np.hypot(xy[:, 0] - np.clip(xy[:, 0], 0, 10), xy[:, 1]) < 3.0
    assert np.array_equal(np.diff(result.removed.first), inside.astype(int))
    assert np.allclose(result.removed.lo, 5.0, atol=1e-9)
    assert np.allclose(result.removed.hi, 25.0, atol=1e-9)


def test_a_ball_moved_straight_cuts_a_trough(device, rng):
    y, x = rng.uniform(-2.9, 2.9, 300), rng.uniform(0.0, 10.0, 300)
    rays = bundle(np.column_stack([x, y, np.full(300, -5.0)]), UP)
    result = removed(rays, straight([0, 0, 0], [10, 0, 0]), BALL, device)
    assert np.allclose(result.removed.lo, 8.0 - np.sqrt(9.0 - y**2), atol=1e-9)


def test_plunging_along_the_axis_cuts_the_tool_itself_made_longer(device, rng):
    cutter, radius = CUTTERS[0], rng.uniform(0.0, 6.0, 200)
    angle = rng.uniform(0, 6.28, 200)
    origin = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(200, -10.0)])
    result = removed(bundle(origin, UP), straight([0, 0, 0], [0, 0, 15]), cutter, device)
    still = removed(bundle(origin, UP), straight([0, 0, 0], [0, 0, 1e-9]), cutter, device)
    assert np.allclose(result.removed.lo, still.removed.lo, atol=2e-9)
    assert np.allclose(result.removed.hi, 50.0, atol=1e-9)


def test_turning_about_the_tip_sweeps_the_same_for_either_direction(device, rng):
    """Invariance under reversal of time, of the ray, and under splitting of the motion."""
    cutter = CUTTERS[0]
    a, b = np.array([0.0, 0.3, 1.0]), np.array([0.4, 0.0, 1.0])
    a, b = a / np.linalg.norm(a), b / np.linalg.norm(b)
    source, back = CLMotion(np.zeros((2, 3)), np.array([a, b])), CLMotion(np.zeros((2, 3)), np.array([b, a]))
    rays = bundle(rng.uniform(-8, 8, (300, 3)) + np.array([0, 0, 10]), rng.normal(size=(300, 3)))
    first = removed(rays, source, cutter, device).removed
    other = removed(rays, back, cutter, device).removed
    assert np.array_equal(first.first, other.first)
    assert np.allclose(first.lo, other.lo, atol=3e-9)
    reverse = removed(RayBundle(rays.origin, -rays.direction, rays.start, rays.end), source, cutter, device).removed
    for i in range(len(rays)):
        one, two = (slice(s.first[i], s.first[i + 1]) for s in (first, reverse))
        assert np.allclose(first.lo[one], -reverse.hi[two][::-1], atol=3e-9)
    fine = cut(rays, compile_motion(source, cutter.reach, max_rotation=radians(0.1)), cutter, device=device).removed
    assert np.array_equal(first.first, fine.first)
    assert np.allclose(first.lo, fine.lo, atol=3e-9)


def grazing_rays(rng, source, cutter, n):
    """Rays tangent to the tool at random poses, most of them within a micrometre of tangency."""
    rays = []
    for _ in range(n):
        piece, t = np.array([rng.integers(source.pieces)]), np.array([rng.uniform()])
        pose = source.pose(piece, t, 0)
        tip, axis = pose.tip.value[0], pose.axis.value[0]
        element = cutter.elements[rng.integers(len(cutter.elements))]
        p = element.at(np.array(rng.uniform(0.0, element.length)))
        u = np.cross(axis, rng.normal(size=3))
        u /= np.linalg.norm(u)
        normal = p.nr * u + p.nz * axis
        tangent = np.cross(normal, rng.normal(size=3))
        direction = tangent / np.linalg.norm(tangent) + rng.choice([0, 1e-4, 1e-2, 1]) * rng.normal(size=3)
        direction /= np.linalg.norm(direction)
        off = rng.choice([0, 1e-6, 1e-4, 1e-2]) * rng.normal()
        rays.append((tip + p.z * axis + p.r * u - rng.uniform(0, 20) * direction + off * normal, direction))
    origin, direction = map(np.array, zip(*rays, strict=True))
    return bundle(origin, direction, -60.0, 60.0)


def random_path(rng):
    axes, tips = [rng.normal(size=3)], [rng.uniform(-50, 50, 3)]
    axes[0] /= np.linalg.norm(axes[0])
    for _ in range(rng.integers(1, 4)):
        turn = radians(rng.choice([0.0, 0.1, 1.0, 4.0]))
        side = np.cross(axes[-1], rng.normal(size=3))
        side /= np.linalg.norm(side)
        axes.append(np.cos(turn) * axes[-1] + np.sin(turn) * side)
        tips.append(tips[-1] + rng.choice([0.05, 0.5, 3.0]) * rng.normal(size=3))
    return CLMotion(np.array(tips), np.array(axes))


@pytest.mark.parametrize("seed", range(4))
def test_torture_no_hit_is_lost_and_no_gap_spanned(device, seed):
    """300 grazing rays a seed against the least distance over the exact motion, which knows no intervals.

    Every point of a ray outside the removed intervals must be outside the swept volume, every point inside
    them inside it, and every end on its boundary.
    """
    rng = np.random.default_rng(seed)
    for _ in range(30):
        cutter, source = CUTTERS[rng.integers(len(CUTTERS))], random_path(rng)
        rays = grazing_rays(rng, source, cutter, 10)
        result = removed(rays, source, cutter, device).require_trust()
        for i in range(len(rays)):
            own = slice(result.removed.first[i], result.removed.first[i + 1])
            ends = np.column_stack([result.removed.lo[own], result.removed.hi[own]])
            near = np.concatenate([10.0 ** np.arange(-8, 0), -(10.0 ** np.arange(-8, 0))])
            tau = np.concatenate([rng.uniform(-60, 60, 40), *(e + near for e in ends.ravel()), ends.mean(axis=1)])
            inside = ((tau[:, None] >= ends[:, 0]) & (tau[:, None] <= ends[:, 1])).any(axis=1)
            at = np.concatenate([tau, ends.ravel()])
            distance = Swept(source, cutter).least_distance(rays.origin[i] + at[:, None] * rays.direction[i])
            assert np.all(distance[: len(tau)][~inside] > -1e-9)
            assert np.all(distance[: len(tau)][inside] < 1e-9)
            assert np.all(np.abs(distance[len(tau) :]) < 2e-9)


def test_cpu_threads_and_tiles_are_bit_identical(rng, monkeypatch):
    source, cutter = random_path(rng), CUTTERS[0]
    rays = grazing_rays(rng, source, cutter, 500)
    table = compile_motion(source, cutter.reach)
    one = cut(rays, table, cutter, threads=1)
    monkeypatch.setattr(removal, "SLICE_RAYS", 37)
    monkeypatch.setattr(removal, "tile_rays", lambda slots: 130)
    many = cut(rays, table, cutter, threads=2)
    for f in fields(one.removed):
        assert np.array_equal(getattr(one.removed, f.name), getattr(many.removed, f.name))
    assert (one.pairs, one.candidates) == (many.pairs, many.candidates)


def test_every_which_row_first_removes_the_same(device, rng, monkeypatch):
    """Rays whose first rows lie anywhere in the order; ends in the window to the tolerance of two searches."""
    for cutter in CUTTERS:
        source = random_path(rng)
        rays, table = grazing_rays(rng, source, cutter, 200), compile_motion(source, cutter.reach)
        at_once = cut(rays, table, cutter, device=device).removed
        monkeypatch.setattr(removal, "_COARSE_FROM", 1)
        first = cut(rays, table, cutter, device=device).removed
        monkeypatch.undo()
        assert np.array_equal(at_once.first, first.first)
        assert np.allclose(at_once.lo, first.lo, atol=2e-9, rtol=0.0)
        assert np.allclose(at_once.hi, first.hi, atol=2e-9, rtol=0.0)


def test_a_gap_that_a_first_look_does_not_decide_is_told_though_a_later_row_cuts_all(device, monkeypatch):
    """Of nine rows, so near each other that they are looked at in turn, the first and the last come before all.

    The first runs 40 mm along y and down in an arc, 2 pm into a wall that the ray lies in. The chords at its poses
    overlap so little, and its way bends so much, that it takes more looks than are allowed to see that they make one
    stretch. The last takes all of that, so that the first is then passed over as cut. The others miss the ray.
    """
    tool = flat(600.0, 400.0)
    ramp, beside, over_all = (
        compile_motion(straight(start, end), tool.reach)
        for start, end in (([0, -20, 0], [0, 20, 0]), ([-5, 0, 0], [-5, 1, 0]), ([50, 0, 0], [50, 1, 0]))
    )
    tip = ramp.tip.copy()
    tip[0, 2, 2] = -4.0
    ramp = replace(ramp, tip=tip, speed=np.hypot(ramp.speed, 8.0), acceleration=ramp.acceleration + 8.0)
    table = join([ramp, *[beside] * (removal._COARSE_STEP - 1), over_all])
    ray = bundle([300.0 - 2e-9, 0.0, 100.0], [0.0, 1.0, 0.0])
    monkeypatch.setattr(removal, "_COARSE_FROM", len(table))
    for rows, status in (([0], Status.GAP_UNDECIDED), (range(1, len(table)), Status.OK)):
        assert cut(ray, table.part(np.array(rows)), tool, device=device).status == status
    assert cut(ray, table, tool, device=device).status == Status.GAP_UNDECIDED


@pytest.mark.parametrize("coarse_from", [10**9, 3])
def test_jobs_in_one_launch_are_bit_identical_to_separate_cuts(rng, monkeypatch, coarse_from):
    """Convex, undercut and ring-shaped tools, motions of one row and of many, and a job without rays."""
    monkeypatch.setattr(removal, "_COARSE_FROM", coarse_from)
    cutters = [*CUTTERS, ring(), every_shape()["T-slot"]]
    jobs = []
    for i in range(24):
        cutter, source = cutters[i % len(cutters)], random_path(rng)
        rays = grazing_rays(rng, source, cutter, 40).part(slice(0, 0 if i == 9 else 1 + i))
        if i == 7:
            source = straight([0, 0, 0], [0.1, 0, 0])
        jobs.append(Job(rays, compile_motion(source, cutter.reach), cutter))
    monkeypatch.setattr(removal, "tile_rays", lambda slots: 50)
    for job, joint in zip(jobs, cut_jobs(jobs), strict=True):
        alone = cut(*job)
        for f in fields(alone.removed):
            assert np.array_equal(getattr(alone.removed, f.name), getattr(joint.removed, f.name))
        assert np.array_equal(alone.ray_status, joint.ray_status)
        assert (alone.pairs, alone.candidates) == (joint.pairs, joint.candidates)
        assert np.all(joint.removed.lo_segment < len(job.table))
    assert cut_jobs([]) == []


def test_ends_beyond_a_window_are_beyond_it_and_those_inside_exact(device, rng):
    """Windows that end inside what is removed change no end in them."""
    cutter, source = CUTTERS[0], random_path(rng)
    rays = grazing_rays(rng, source, cutter, 200)
    whole = removed(rays, source, cutter, device).removed
    start = np.full(200, -60.0)
    start[whole.ray] = 0.5 * (whole.lo + whole.hi)
    narrow = removed(RayBundle(rays.origin, rays.direction, start, rays.end), source, cutter, device).removed
    kept = whole.hi > start[whole.ray]
    assert np.array_equal(whole.ray[kept], narrow.ray[narrow.hi > start[narrow.ray]])
    assert np.allclose(whole.hi[kept], narrow.hi[narrow.hi > start[narrow.ray]], atol=2e-9)
    cut_off = kept & (whole.lo < start[whole.ray])
    assert np.count_nonzero(cut_off) > 50
    assert np.all(np.isin(whole.ray[cut_off], narrow.ray[narrow.lo < start[narrow.ray]]))


def test_progress_is_told_of_every_ray(rng):
    source = random_path(rng)
    told = []
    removed(grazing_rays(rng, source, BALL, 300), source, BALL, progress=told.append)
    assert sum(told) == 300


def test_a_full_interval_list_is_an_error_not_a_truncation(device):
    """A comb of 8 separate plunges across one ray, with room for 4."""
    tips, axes = [], []
    for x in range(0, 80, 10):
        for z in (0.0, 50.0):
            tips.append([x, 0.0, z])
            axes.append(UP)
        tips.append([x + 10.0, 0.0, 50.0])
        axes.append(UP)
    source = CLMotion(np.array(tips), np.array(axes))
    ray = bundle([-20.0, 0.0, 2.0], [1.0, 0.0, 0.0], 0.0, 120.0)
    assert len(removed(ray, source, FLAT, device, slots=16).require_trust().removed.lo) == 8
    short = removed(ray, source, FLAT, device, slots=4)
    assert short.status == Status.INTERVALS_OVERFLOW
    with pytest.raises(NumericalError, match=r"raise `simulation\.interval_slots`"):
        short.require_trust()


def test_no_rays_and_unknown_devices(rng):
    source = random_path(rng)
    empty = removed(bundle(np.empty((0, 3)), np.empty((0, 3))), source, BALL)
    assert (len(empty.removed.lo), empty.pairs) == (0, 0)
    with pytest.raises(InputError, match="no device 'tpu:7'; this machine has cpu"):
        removed(bundle([0, 0, 0], UP), source, BALL, device="tpu:7")


def test_counts_say_what_culling_saved(rng):
    """A ray far away costs nothing; one through the tool costs candidates and pairs."""
    source = straight([0, 0, 0], [10, 0, 0])
    assert removed(bundle([0, 500, 0], UP), source, BALL).candidates == 0
    hit = removed(bundle([5, 0, -5], UP), source, BALL)
    assert hit.candidates >= hit.pairs >= 1
    assert isinstance(compile_motion(source, BALL.reach), SegmentTable)
