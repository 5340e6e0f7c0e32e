"""Whole bundles cut tile by tile, against every ray cut alone; and the bounds that turn branches away."""

from math import radians

import numpy as np
import pytest
import warp as wp

from gearsim.cutters.catalogue import apt
from gearsim.cutters.end_mills import ball, barrel
from gearsim.errors import NumericalError
from gearsim.geometry.rigid import frame
from gearsim.kernels.branches import Branches, Tile, at_end, branch_at, reach_of
from gearsim.kernels.pose import Motion, place_at
from gearsim.kernels.profile import Cutters, convex_part
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation import tiles
from gearsim.simulation.branches import branch_data, halved, roots_of
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, subtract
from gearsim.simulation.removal import cut
from gearsim.simulation.tiles import TileCutter
from gearsim.simulation.tools import cutter_data, motion_data
from tests.cutters.shapes import lollipop

TOLERANCE = 1e-7
PLAIN = frame(np.zeros(3), np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0]))
ASKEW = frame(np.array([0.3, -0.2, 0.1]), np.array([0.8, 0.6, 0.0]), np.array([0.0, 0.0, 1.0]))
CUTTERS = {
    "ball": ball(2.0, 12.0),
    "flat": apt(2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0),
    "bull": apt(3.0, 0.5, 1.0, 0.5, 0.0, 0.0, 6.0),
    "lollipop": lollipop(),
    "barrel": barrel(3.0, 12.0, 3.0, 7.0, 0.5),
}


def ramps(points=40):
    """Zigzag in five axes over a block of 8 x 6 mm, down to 1 mm above its floor, with a rapid's jump in it."""
    t = np.linspace(0.0, 1.0, points)
    tips = np.stack([9.0 * (0.5 - 0.5 * np.cos(9.0 * t)) - 0.5, 7.0 * t - 0.5, 1.5 + 0.5 * np.sin(11.0 * t)], axis=1)
    tilt, turn = radians(15.0) * np.sin(5.0 * t), 7.0 * t
    axes = np.stack([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)], axis=1)
    return CLMotion(tips, axes)


def box_of(place, pitch=0.25):
    return DexelBox(place, np.zeros(3), np.array([8.0, 6.0, 3.0]), pitch)


def slab(box, axis):
    """Two plates of material along every ray, tagged as an operation before left them."""
    n = int(np.delete(box.counts, axis).prod())
    length = float(box.upper[axis] - box.lower[axis])
    lo, hi = (np.tile(length * np.array(ends), n) for ends in ((0.0, 0.55), (0.5, 1.0)))
    lo_tag, hi_tag = (np.tile(np.array(tags, dtype=np.int32), n) for tags in ((-1, 3), (2, -1)))
    return IntervalSet(2 * np.arange(n + 1), lo, hi, lo_tag, hi_tag)


def one_by_one(box, axis, left, table, cutter, first_tag):
    removed = cut(box.rays(axis), table, cutter, tolerance=TOLERANCE, slots=32).require_trust().removed
    tags = (np.where(k >= 0, k + first_tag, -1) for k in (removed.lo_segment, removed.hi_segment))
    return subtract(left, IntervalSet(removed.first, removed.lo, removed.hi, *tags))


def same(a, b):
    return all(np.array_equal(getattr(a, n), getattr(b, n)) for n in ("first", "lo", "hi", "lo_segment", "hi_segment"))


@pytest.mark.parametrize("name", CUTTERS)
@pytest.mark.parametrize("place", [PLAIN, ASKEW], ids=["plain", "askew"])
def test_tiles_leave_what_rays_cut_one_by_one_leave(name, place):
    cutter, box = CUTTERS[name], box_of(place)
    table = compile_motion(ramps(), cutter.reach)
    shop = TileCutter(table, cutter, "cpu", TOLERANCE)
    for axis in range(3):
        left = slab(box, axis)
        ours, theirs = shop.cut(box, axis, left, 10), one_by_one(box, axis, left, table, cutter, 10)
        assert np.array_equal(ours.first, theirs.first)
        assert 0.0 < ours.length < left.length
        for end, tag in (("lo", "lo_segment"), ("hi", "hi_segment")):
            assert np.abs(getattr(ours, end) - getattr(theirs, end)).max() <= TOLERANCE
            stays = getattr(theirs, tag) < 10
            assert np.array_equal(getattr(ours, tag)[stays], getattr(theirs, tag)[stays])
            assert np.all(getattr(ours, tag)[~stays] >= 10)


@pytest.fixture(scope="module")
def bull():
    table = compile_motion(ramps(), CUTTERS["bull"].reach)
    return TileCutter(table, CUTTERS["bull"], "cpu", TOLERANCE)


def test_threads_do_not_change_a_bit(bull):
    box = box_of(PLAIN, 0.1)
    told = []
    one = bull.cut(box, 2, slab(box, 2), 10, threads=1)
    two = bull.cut(box, 2, slab(box, 2), 10, threads=2, progress=told.append)
    assert same(one, two)
    assert sum(told) == len(one.first) - 1 == 80 * 60
    assert len(told) > 1


def test_a_ray_in_more_pieces_than_slots_is_cut_again_with_more(bull):
    box = box_of(PLAIN)
    few, many = (bull.cut(box, 0, slab(box, 0), 10, slots=n) for n in (1, 32))
    assert np.array_equal(few.first, many.first)
    assert np.abs(few.lo - many.lo).max() <= TOLERANCE
    assert np.diff(few.first).max() + 1 > 1 + 2  # air before, between and behind; slots: 1 and the stock's pieces


def test_what_cannot_be_trusted_is_refused(bull, monkeypatch):
    monkeypatch.setattr(tiles, "_MOST_SLOTS", 1)
    box = box_of(PLAIN)
    with pytest.raises(NumericalError, match=r"of \d+ tiles of rays cannot be trusted: .*interval list"):
        bull.cut(box, 0, slab(box, 0), 10, slots=1)


def test_rays_without_material_and_cuts_without_effect_stay(bull):
    box = box_of(PLAIN)
    n = int(np.delete(box.counts, 2).prod())
    none = IntervalSet(np.zeros(n + 1, dtype=int), *np.zeros((2, 0)), *np.zeros((2, 0), dtype=np.int32))
    assert same(bull.cut(box, 2, none, 10), none)
    low = DexelBox(PLAIN, np.array([0.0, 0.0, -3.0]), np.array([8.0, 6.0, -1.0]), 0.25)
    left = slab(low, 2)
    assert same(bull.cut(low, 2, left, 10), left)


@pytest.mark.parametrize("y", [2.0, 2.125])
def test_a_tool_tangent_to_grid_planes_leaves_no_slivers(y):
    """A flat end mill along x whose floor and sides lie on planes of the lattice, or half way between them."""
    cutter = CUTTERS["flat"]
    path = CLMotion(np.array([[-2.0, y, 1.125], [10.0, y, 1.125]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    box, table = box_of(PLAIN), compile_motion(path, cutter.reach)
    shop = TileCutter(table, cutter, "cpu", TOLERANCE)
    for axis in range(3):
        left = slab(box, axis)
        ours, theirs = shop.cut(box, axis, left, 10), one_by_one(box, axis, left, table, cutter, 10)
        thick = theirs.hi - theirs.lo > TOLERANCE  # rays alone keep slivers between a cut and an older one beside it
        assert np.array_equal(ours.ray, theirs.ray[thick])
        assert np.allclose(ours.lo, theirs.lo[thick], atol=TOLERANCE)
        assert np.allclose(ours.hi, theirs.hi[thick], atol=TOLERANCE)


@wp.kernel(enable_backward=False)
def reach_kernel(
    cutters: Cutters, branches: Branches, node: wp.array(dtype=wp.int32), a: wp.vec3d, b: wp.vec3d,
    origin: wp.array(dtype=wp.vec3d), direction: wp.vec3d, window: wp.vec2d, motion: Motion, way: wp.float64,
    beside: wp.array(dtype=wp.vec2d), out: wp.array2d(dtype=wp.float64),
):  # fmt: skip
    i = wp.tid()
    tile = Tile()
    tile.origin = origin[i]
    tile.direction = direction
    tile.a = a
    tile.b = b
    branch = branch_at(branches, node[i])
    if way != wp.float64(0.0):
        place = place_at(motion, node[i], way)
        branch = at_end(branch, place.tip, place.axis, way)
    reach = reach_of(convex_part(cutters, 0, wp.float64(50.0)), branch, tile, window)
    out[i, 0] = wp.where(reach.found == 1, reach.lo, wp.float64(1.0e30))
    out[i, 1] = wp.where(reach.found == 1, reach.hi, wp.float64(-1.0e30))
    at = wp.vec3d(wp.float64(1.0), beside[i][0], beside[i][1])
    out[i, 2] = wp.max(reach.first, wp.dot(reach.early, at))
    out[i, 3] = wp.min(reach.last, wp.dot(reach.late, at))


def reaches(table, cutter, levels, roots, node, origin, a, b, way=0.0, at=None):
    """(chord, chord, first, last) of tiles' rays ``at`` (s, t), of branches that stand at ``node``."""
    data, tools, n = branch_data(levels, roots, "cpu"), cutter_data([cutter], "cpu"), len(node)
    out = wp.zeros((n, 4), dtype=wp.float64)
    inputs = [tools, data, wp.array(node, dtype=wp.int32), wp.vec3d(*a), wp.vec3d(*b)]
    inputs += [wp.array(origin, dtype=wp.vec3d), wp.vec3d(0.0, 0.0, 1.0), wp.vec2d(-9.0, 9.0)]
    inputs += [motion_data(table, "cpu"), way, wp.array(np.zeros((n, 2)) if at is None else at, dtype=wp.vec2d)]
    wp.launch(reach_kernel, dim=n, inputs=inputs, outputs=[out])
    return out.numpy()


@pytest.mark.parametrize("way", [0.0, -1.0, 1.0])
@pytest.mark.parametrize("name", ["ball", "flat", "bull", "barrel"])
def test_no_ray_of_a_tile_meets_the_tool_outside_a_branch_s_reach(name, way):
    """Rays anywhere in tiles, at poses of rows: of branches of every level, and of a row seen from its end."""
    cutter, rng, n = CUTTERS[name], np.random.default_rng(5), 4000
    table = compile_motion(ramps(), cutter.reach)
    levels = halved(table, cutter.reach)
    roots, _, _ = roots_of(levels, cutter)
    held = np.concatenate([np.arange(i << k, min((i + 1) << k, len(table))) for k, i in roots])
    assert np.array_equal(np.sort(held), np.arange(len(table)))
    a, b = np.array([0.3, 0.0, 0.0]), np.array([0.0, 0.2, 0.0])
    level = rng.integers(0, 5, n) if way == 0.0 else np.zeros(n, dtype=int)
    branch = rng.integers(0, -(-len(table) // (1 << level)))
    row = np.minimum((branch << level) + rng.integers(0, 1 << level), len(table) - 1)
    at = rng.uniform(-1.0, 1.0, (n, 2))
    middle = table.tip[row, 0] * [1, 1, 0] + rng.uniform(-2.0, 2.0, (n, 3)) * [1, 1, 0]
    beside = middle + at[:, :1] * a + at[:, 1:] * b
    first = np.cumsum([0, *(len(k.rest) for k in levels)])
    known = (table, cutter, levels, roots)
    bound = reaches(*known, first[level] + branch, middle, a, b, way, at)
    for pose in (0.0, -1.0, 0.37, 1.0):
        chord = reaches(*known, row, beside, 0.0 * a, 0.0 * b, pose)
        lo, hi = np.maximum(chord[:, 0], -9.0), np.minimum(chord[:, 1], 9.0)
        met = lo < hi
        assert 500 < met.sum() < n
        assert np.all(bound[met, 2] <= lo[met])
        assert np.all(bound[met, 3] >= hi[met])
    assert (bound[:, 2] > bound[:, 3]).sum() > 200
