"""The envelope road's kernels against their NumPy twins."""

import numpy as np
import pytest

from gearsim.envelope.nearby import PointCloud
from gearsim.envelope.surface import envelope_points
from gearsim.envelope.swept import Chart, Guess, Swept
from gearsim.geometry.rays import RayBundle
from tests.cutters.shapes import every_shape
from tests.envelope.twins import charts, newton, trim
from tests.simulation.test_removal import CUTTERS, grazing_rays, random_path

SHAPES = [*CUTTERS, *every_shape().values()]
NAMES = [f"{c.name} {len(c.elements)}" for c in SHAPES]
SAME = 1e-12


def envelope_jet(source, cutter, *where):
    g = envelope_points(source, cutter, *where)
    return g.point, g.point_t, g.point_s


def jets(source, cutter):
    """Every chart's twin, as a function of (piece, t, element, place, branch), and its elements."""
    kinds = {"arc": Chart.ARC, "flat": Chart.DISC, "line": Chart.LINE}
    twins = {Chart.ARC: charts.arc_jet, Chart.DISC: charts.disc_jet, Chart.LINE: charts.line_jet}
    yield Chart.ENVELOPE, lambda *w: envelope_jet(source, cutter, *w), list(range(len(cutter.elements)))
    yield Chart.CIRCLE, lambda p, t, e, a, _=None: charts.edge_jet(source, cutter, p, t, e, a), list(cutter.edges)
    for kind, chart in kinds.items():
        elements = [i for i, e in enumerate(cutter.elements) if e.kind == kind]
        yield chart, lambda p, t, e, a, _=None, c=chart: twins[c](source, cutter, p, t, e, a)[:3], elements


def places(rng, source, cutter, chart, elements, n):
    """Random places of a chart."""
    element = rng.choice(elements, n)
    length = np.array([e.length for e in cutter.elements])[element]
    place = rng.uniform(0, length) if chart == Chart.ENVELOPE else rng.uniform(0, 2 * np.pi, n)
    piece, t = rng.integers(0, source.pieces, n), rng.uniform(0, 1, n)
    return Guess(np.arange(n), piece, t, element, place, rng.choice([-1.0, 1.0], n))


@pytest.mark.parametrize("cutter", SHAPES, ids=NAMES)
def test_least_distances_agree(cutter, rng, device):
    source = random_path(rng)
    points = source.tips.mean(axis=0) + 6.0 * source.axes[0] + 5.0 * rng.normal(size=(300, 3))
    swept = Swept(source, cutter, device)
    twin = trim.path_distance(source, cutter, points)
    # both are certain to 1e-11 mm only; the pose that they find is nearly always the same
    assert np.abs(swept.least_distance(points) - twin).max() < 2e-11
    assert np.quantile(np.abs(swept.least_distance(points) - twin), 0.9) < SAME
    clear = np.abs(twin) > 2e-11
    assert np.array_equal((swept.least_distance(points, floor=0.0, enough=0.0) < 0.0)[clear], (twin < 0.0)[clear])


@pytest.mark.parametrize("cutter", SHAPES, ids=NAMES)
def test_points_of_all_charts_agree(cutter, rng, device):
    source = random_path(rng)
    swept, compared = Swept(source, cutter, device), 0
    for chart, jet, elements in jets(source, cutter):
        if elements:
            where = places(rng, source, cutter, chart, elements, 400)
            twin, ours = jet(*where[1:])[0], swept.points(chart, where)
            there = np.isfinite(twin[:, 0])
            assert np.mean(there == np.isfinite(ours[:, 0])) > 0.99  # the two sides of where a chart ends
            both = there & np.isfinite(ours[:, 0])
            assert np.abs(ours - twin)[both].max(initial=0.0) < 1e3 * SAME  # next to that end
            assert np.quantile(np.abs(ours - twin)[both], 0.95) < SAME if both.any() else True
            compared += int(both.sum())
    assert compared > 200


@pytest.mark.parametrize("cutter", SHAPES, ids=NAMES)
def test_newtons_method_comes_to_the_same_places(cutter, rng, device):
    source = random_path(rng)
    swept = Swept(source, cutter, device)
    compared = 0
    for chart, jet, elements in jets(source, cutter):
        if not elements:
            continue
        where = places(rng, source, cutter, chart, elements, 200)
        points = swept.points(chart, where)
        there = np.isfinite(points[:, 0])
        where = Guess(np.arange(there.sum()), *(c[there] for c in where[1:]))
        direction = rng.normal(size=points[there].shape)
        direction /= np.linalg.norm(direction, axis=1, keepdims=True)
        n = len(direction)
        rays = RayBundle(points[there] + 0.05 * rng.normal(size=(n, 3)), direction, np.full(n, -1.0), np.full(n, 1.0))
        for walk in (False, True):
            at, tau, settled = newton.newton(rays, jet, where, 12, source.pieces if walk else 0)
            ours = swept.solve(swept.rays(rays), chart, where, 12, walk=walk)
            assert np.mean(ours.settled == settled) > 0.98
            both = ours.settled & settled & (ours.at.piece == at.piece) & (np.abs(ours.at.t - at.t) < 1e-6)
            assert both.sum() >= 0.97 * settled.sum()
            assert np.quantile(np.abs(ours.tau - tau)[both], 0.95) < 1e-10 if both.any() else True
            compared += int(both.sum())
    assert compared > 200


@pytest.mark.parametrize("cutter", SHAPES, ids=NAMES)
def test_crossings_of_the_tool_at_rest_agree(cutter, rng, device):
    source = random_path(rng)
    rays = grazing_rays(rng, source, cutter, 200)
    joint = rng.integers(0, source.pieces + 1, len(rays))
    tau, which = newton.tool_crossings(rays, source, cutter, joint)
    swept = Swept(source, cutter, device)
    ours = swept.standing(swept.rays(rays), np.arange(len(rays)), joint)
    apart = np.where(ours.pair == which[:, None], np.abs(ours.tau - tau[:, None]), np.inf).min(axis=1)
    assert apart.max() < 1e-10
    assert len(tau) <= len(ours.tau) < len(tau) + 8  # the twin looks less closely for the shortest chords
    assert len(tau) > 20


@pytest.mark.parametrize("count", [0, 1, 23, 24, 25, 700])
def test_the_nearest_of_a_cloud_is_that_of_a_search_through_all(count, rng, device):
    cloud = np.cumsum(rng.normal(size=(count, 3)), axis=0)
    points, reach = 4.0 * rng.normal(size=(300, 3)), rng.uniform(0.0, 8.0, 300)
    nearest = PointCloud(cloud, device).nearest(points, reach)
    if not count:
        assert np.all(nearest == -1)
        return
    apart = np.linalg.norm(points[:, None] - cloud, axis=2)
    expected = np.where(apart.min(axis=1) < reach, apart.argmin(axis=1), -1)
    assert np.array_equal(nearest, expected)


def test_a_point_of_the_cloud_itself_is_found_and_equal_ones_count_once(device):
    cloud = PointCloud(np.zeros((60, 3)), device)
    assert cloud.nearest(np.zeros((2, 3)), np.array([1e-12, 1.0])).tolist() == [0, 0]


def test_the_nearest_poses_of_circles_are_those_of_a_search_through_all(rng, device):
    cutter = CUTTERS[0]
    source = random_path(rng)
    piece, t = rng.integers(0, source.pieces, 90), rng.uniform(0, 1, 90)
    tip, axis = (s.value for s in source.pose(piece, t, 0))
    circles = np.array([[1.0, 0.0], [3.0, 2.0], [0.0, 5.0]])
    points = source.tips.mean(axis=0) + 5.0 * rng.normal(size=(200, 3))
    reach = np.full(200, 6.0)
    q = points[:, None] - tip
    z = np.einsum("ijk,jk->ij", q, axis)
    r = np.linalg.norm(q - z[..., None] * axis, axis=2)
    apart = np.hypot(r[..., None] - circles[:, 0], z[..., None] - circles[:, 1])
    expected = np.where(apart.min(axis=1) <= reach[:, None], apart.argmin(axis=1), -1)
    found = Swept(source, cutter, device).nearest_circles((tip, axis), circles, points, reach)
    assert np.array_equal(found, expected)
