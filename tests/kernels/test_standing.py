"""How rows stand to what rays have left, against many poses of the tool looked at one by one."""

from math import radians

import numpy as np
import pytest
import warp as wp

from gearsim.cutters.catalogue import apt, conical
from gearsim.kernels.interval import IntervalLists
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import Cutters, convex_part
from gearsim.kernels.standing import NOTHING_NEW, standing_of
from gearsim.motion.segments import DEGREE, compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation.tools import cutter_data, interval_lists, motion_data, row_groups
from tests.cutters.shapes import barrel, spindle
from tests.motion.test_sources import random_cl

CUTTERS = {
    "conical": conical(1.0, 1.5, radians(15.0), 25.0),
    "ball": apt(6.0, 3.0, 0.0, 3.0, 0.0, 0.0, 20.0),
    "flat": apt(8.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0),
    "bull": apt(10.0, 1.0, 4.0, 1.0, 0.0, 0.0, 15.0),
    "barrel": barrel(),
    "spindle": spindle(),
}
RAYS, WINDOW, TOLERANCE = 3000, (-2.0, 4.0), 1e-9


@wp.kernel(enable_backward=False)
def standing_kernel(
    cutters: Cutters,
    motion: Motion,
    row: wp.array(dtype=wp.int32),
    origin: wp.array(dtype=wp.vec3d),
    direction: wp.array(dtype=wp.vec3d),
    window: wp.vec2d,
    tolerance: wp.float64,
    lists: IntervalLists,
    clear_out: wp.array(dtype=wp.float64),
    more_out: wp.array(dtype=wp.int32),
):
    i = wp.tid()
    part = convex_part(cutters, 0, wp.float64(100.0))
    now = standing_of(part, motion, row[i], origin[i], direction[i], window, tolerance, i, lists)
    clear_out[i] = now.clear
    more_out[i] = now.more


def standings(device, cutter, table, row, origin, direction, lo, hi):
    """What the kernel says of each ray and its row, where [lo, hi] is cut already."""
    n = len(row)
    lists = interval_lists(n, 2, device)
    lists.lo, lists.hi = (wp.array(np.stack([a, a], axis=1), dtype=wp.float64, device=device) for a in (lo, hi))
    lists.count = wp.array(np.ones(n), dtype=wp.int32, device=device)
    clear, more = wp.zeros(n, dtype=wp.float64, device=device), wp.zeros(n, dtype=wp.int32, device=device)
    rays = [wp.array(a, dtype=wp.vec3d, device=device) for a in (origin, direction)]
    inputs = [cutter_data([cutter], device), motion_data(table, device), wp.array(row, dtype=wp.int32, device=device)]
    wp.launch(
        standing_kernel, dim=n, inputs=[*inputs, *rays, wp.vec2d(*WINDOW), TOLERANCE, lists],
        outputs=[clear, more], device=device,
    )  # fmt: skip
    return clear.numpy(), more.numpy()


def distances(cutter, table, row, x, points):
    """Signed distances of points, shape (n, m, 3), to the tool at x of each row."""
    tip, axis = (np.einsum("k,nkc->nc", x ** np.arange(DEGREE + 1), c[row])[:, None] for c in (table.tip, table.axis))
    q = points - tip
    z = np.sum(q * axis, axis=2)
    return cutter.signed_distance(np.linalg.norm(q - z[..., None] * axis, axis=2), z)


@pytest.mark.parametrize("name", CUTTERS)
def test_rows_that_take_no_more(name, device, rng):
    cutter = CUTTERS[name]
    table = compile_motion(random_cl(rng), cutter.reach, max_rotation=radians(4.0))
    row = rng.integers(0, len(table), RAYS)
    height = rng.uniform(-1.0, 1.1, RAYS) * cutter.box[3]
    origin = table.tip[row, 0] + height[:, None] * table.axis[row, 0] + rng.uniform(-9.0, 9.0, (RAYS, 3))
    direction = rng.normal(size=(RAYS, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    lo, hi = rng.uniform(-1.0, 1.0, RAYS), rng.choice([1.5, 3.0, 4.0, 9.0], RAYS)
    clear, more = standings(device, cutter, table, row, origin, direction, lo, hi)
    tau = np.linspace(*WINDOW, 49)
    left = (tau < lo[:, None]) | (tau > hi[:, None])
    points = origin[:, None] + tau[:, None] * direction[:, None]
    nearest = [
        np.where(left, distances(cutter, table, row, x, points), np.inf).min(axis=1) for x in np.linspace(-1, 1, 17)
    ]
    assert np.all(nearest[8] >= clear - 1e-9)
    reached = np.min(nearest, axis=0)
    spared = more == NOTHING_NEW
    assert reached[spared].min() > -1e-9
    assert 0.03 < spared.mean() < 0.97
    assert np.count_nonzero(spared & (clear < table.speed[row])) > 10  # of these a bound of displacement is not enough


def test_rows_that_cut_the_same_add_nothing(device):
    table = compile_motion(CLMotion(np.array([[0.0, 0, 0], [8, 0, 0], [16, 0, 0]]), np.array([[0.0, 0, 1]] * 3)), 25.0)
    rays = np.array([[4.0, -10.0, 5.0], [12.0, -10.0, 5.0]]), np.array([[0.0, 1.0, 0.0]] * 2)
    flat, row, cut = CUTTERS["flat"], np.array([1, 0]), np.array([6.0, 6.0])
    _, more = standings(device, flat, table, row, *rays, cut - 10.0, cut + 8.0)
    assert np.all(more == NOTHING_NEW)


def test_travel_bounds_how_far_the_tool_moves(rng):
    cutter, table = CUTTERS["conical"], compile_motion(random_cl(rng), 25.0)
    groups = row_groups(table, cutter)
    for i, j in ((0, 1), (2, 9), (0, len(table) - 1)):
        grown = groups.travel[j] - groups.travel[i]
        for z in (0.0, 25.0):
            moved = [t[0] + z * a[0] for t, a in ((table.tip[i], table.axis[i]), (table.tip[j], table.axis[j]))]
            assert np.linalg.norm(moved[1] - moved[0]) <= grown + 1e-12
