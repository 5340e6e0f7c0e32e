"""The peers against independent truths, their laws from data with a known law; no assertion on time."""

import sys
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.bench import peers as bench
from gearsim.bench.peer_drop import drop
from gearsim.bench.peer_hulls import cast, hull_sweep, tool_mesh
from gearsim.bench.peer_instants import instants
from gearsim.bench.peer_law import Level, fit_law, fit_laws
from gearsim.bench.peer_work import (
    LOWER,
    UPPER,
    compare,
    dexel_work,
    dexels,
    first_surface,
    normal_work,
    ours,
    raster_work,
    trough,
)
from gearsim.errors import InputError
from gearsim.motion.sources import CurveMotion
from gearsim.simulation.intervals import IntervalSet
from gearsim.verify.brute_force import distance_at


@pytest.fixture(scope="module")
def normals():
    return normal_work(20, 8)


@pytest.fixture(scope="module")
def coarse():
    return dexel_work(1.7)


@pytest.fixture(scope="module")
def raster():
    return raster_work(60, 1.3)


def ball_height(work):
    """Height over the bottom that a ball leaves: a sphere's lower side at each line's point nearest in space."""
    tips, (x, y, _) = work.source.tips, work.rays.origin.T
    r, height = work.cutter.max_radius, work.rays.end.copy()
    for a, b in pairwise(tips):
        for t in np.linspace(0.0, 1.0, 2001):
            p = a + t * (b - a)
            under = r * r - (x - p[0]) ** 2 - (y - p[1]) ** 2
            inside = under > 0.0
            height[inside] = np.minimum(height[inside], p[2] + r - np.sqrt(under[inside]) - LOWER[2])
    return height


@given(
    st.floats(1e-6, 1e6),
    st.floats(-4.0, -0.2),
    st.lists(st.sampled_from([2**k for k in range(17)]), min_size=2, unique=True),
)
def test_a_law_is_found_again(factor, order, resolutions):
    law = fit_law(resolutions, [factor * n**order for n in resolutions])
    assert law.order == pytest.approx(order, abs=1e-6)
    assert law.at(50.0) == pytest.approx(factor * 50.0**order, rel=1e-4)
    assert law.inverse(law.at(50.0)) == pytest.approx(50.0)


def test_laws_tell_time_at_an_error_and_error_in_a_time():
    """error = 3 / n², time = 1e-3 n: 1e-4 mm needs n = sqrt(3e4), so 0.1 sqrt(3) s."""
    laws = fit_laws([Level(n, 1e-3 * n, 3.0 / n**2, 0) for n in (10, 40, 100)])
    assert laws.seconds_at(1e-4) == pytest.approx(0.1 * 3.0**0.5)
    assert laws.error_in(0.1 * 3.0**0.5) == pytest.approx(1e-4)
    assert laws.origin(1e-4) == "extrapolated"
    assert laws.origin(4e-4) == "interpolated"


def test_a_peer_that_does_not_converge_has_no_time():
    row = bench.fitted([Level(10, 1.0, 1e-2, 0), Level(20, 2.0, 1.1e-2, 0)], {t: 1.0 for t in (1e-2, 1e-4, 1e-6)})
    assert row["from"] == "does not converge"
    assert "seconds" not in row


def test_a_row_holds_times_ratios_and_the_error_in_our_time():
    """error = 1 / n, time = n / 100: 1e-2 mm in 1 s, 1e-4 mm in 100 s, 1e-6 mm in 10,000 s; 0.1 mm in our 0.1 s."""
    levels = [Level(n, n / 100.0, 1.0 / n, 0) for n in (10, 100)]
    row = bench.fitted(levels, {1e-2: 0.05, 1e-4: 0.1, 1e-6: 0.2})
    expected = {"seconds": 100.0, "ratio": 1000.0, "ratio at 1e-2": 20.0, "ratio at 1e-6": 5e4, "mm in our time": 0.1}
    assert {k: row[k] for k in expected} == pytest.approx(expected)
    assert row["from"] == "extrapolated"
    assert row["resolutions"] == "10 to 100"


@pytest.mark.parametrize(
    ("n", "values", "says"),
    [([5, 5], [1.0, 1.0], "two resolutions"), ([5], [1.0], "two resolutions"), ([5, 6], [1.0, 0.0], "positive")],
)
def test_no_law_without_data(n, values, says):
    with pytest.raises(InputError, match=says):
        fit_law(n, values)


def test_our_truth_is_the_closed_form_envelope(normals):
    """Rays along normals start 1 mm under the trough's points, which the envelope road gives."""
    assert len(normals.rays) > 200
    assert np.abs(ours(normals, repeats=1).surface - 1.0).max() < 2e-9


def test_first_surface_is_the_first_cut_or_the_end_of_the_window():
    rays = dexels(8.0).part(slice(0, 3))
    removed = IntervalSet(
        np.array([0, 2, 2, 3]),
        np.array([3.0, 7.0, -2.0]),
        np.array([5.0, 9.0, 4.0]),
        np.zeros(3, int),
        np.zeros(3, int),
    )
    assert first_surface(rays, removed).tolist() == [3.0, 12.0, 0.0]


def test_a_jump_is_a_lost_ray_not_an_error():
    error, lost = compare(np.array([1.0, 2.0, np.inf, 9.0]), np.array([1.0, 2.1, 3.0, 7.0]))
    assert error == pytest.approx(0.1)
    assert lost == 2


@pytest.mark.parametrize("culled", [True, False])
def test_an_instant_cuts_where_the_tool_at_rest_begins(culled):
    """At one pose, every surface found lies on the tool, and all rays that pass through the tool are found."""
    work = dexel_work(0.5)
    surface = instants(work, 1, culled)
    assert np.all(surface == work.rays.end)  # the first pose is outside of the block
    at = surface_of_pose(work, 0.4, culled)
    found = at < work.rays.end
    assert np.count_nonzero(found) > 50
    points = (work.rays.origin + at[:, None] * work.rays.direction)[found]
    assert np.abs(depth(work, points, 0.4)).max() < 1e-9
    steps = np.linspace(0.0, 12.0, 241)
    scan = work.rays.origin[:, None] + steps[:, None] * work.rays.direction[:, None]
    inside = (depth(work, scan.reshape(-1, 3), 0.4).reshape(scan.shape[:2]) < -1e-9).any(axis=1)
    assert np.all(found[inside])


def surface_of_pose(work, t, culled):
    return instants(work._replace(source=CurveMotion(work.source.curve, t, 1.0)), 1, culled)


def depth(work, points, t):
    n = len(points)
    return distance_at(work.source, work.cutter, points, np.zeros(n, dtype=int), np.full(n, t))


def test_instants_leave_material_and_converge_with_order_two(normals):
    truth = ours(normals, repeats=1).surface
    errors = []
    for poses in (201, 401, 801):  # each contains the poses before
        surface = instants(normals, poses)
        assert np.all(surface > truth - 1e-8)
        errors.append(compare(surface, truth)[0])
    assert -2.3 < fit_law((200, 400, 800), errors).order < -1.7


def test_culling_changes_nothing(coarse, normals):
    for work in (coarse, normals):
        assert np.array_equal(instants(work, 300), instants(work, 300, culled=False))


def test_our_dexels_on_straight_lines_are_swept_spheres(raster):
    error, lost = compare(ours(raster, repeats=1).surface, ball_height(raster))
    assert lost == 0
    assert error < 2e-4  # the scan's own, next to the ball's equator


def test_the_drop_cutter_upside_down_cuts_dexels(raster):
    opencamlib = pytest.importorskip("opencamlib")
    error, lost = compare(drop(opencamlib, raster), ours(raster, repeats=1).surface)
    assert lost == 0
    assert error < 1e-8


def test_the_tools_mesh_straddles_the_tool():
    """Vertices lie out of the tool by at most half a facet's sagitta in each direction; more facets, closer."""
    _, cutter = trough()
    farthest = []
    for facets in (16, 32):
        x, y, z = tool_mesh(cutter, facets).T
        d = cutter.signed_distance(np.hypot(x, y), z)
        assert d.min() > -1e-9
        farthest.append(d.max())
    widest = 0.5 * cutter.max_radius * (1.0 - np.cos(np.pi / 16))
    assert farthest[0] < 2.2 * widest
    assert 3.5 < farthest[0] / farthest[1] < 4.5


def test_hulls_converge_to_our_surface(normals):
    manifold3d = pytest.importorskip("manifold3d")
    truth = ours(normals, repeats=1).surface
    errors = [compare(cast(hull_sweep(manifold3d, normals, n, n * n // 5), normals), truth)[0] for n in (8, 16)]
    assert errors[1] < 0.4 * errors[0] < 0.2


def test_a_block_that_nothing_cuts_keeps_its_top():
    manifold3d = pytest.importorskip("manifold3d")
    work = dexel_work(5.0)
    block = manifold3d.Manifold.cube((UPPER - LOWER).tolist()).translate(LOWER.tolist())
    assert np.allclose(cast(block, work), 12.0)


@pytest.fixture
def tiny(monkeypatch):
    monkeypatch.setitem(bench.SIZES, "small", bench.Size(3.0, (6, 3), (20, 40), (100, 200), (8, 12), (8, 16)))


def test_missing_peers_are_rows_that_say_how_to_get_them(tiny, monkeypatch):
    for name in bench.PEERS:
        monkeypatch.setitem(sys.modules, name, None)
    report = bench.peers("cpu")
    missing = [row for row in report["rows"] if "pip install" in str(row["from"])]
    assert {row["from"].split()[-1] for row in missing} == set(bench.PEERS)
    assert {row["method"] for row in missing} == {"manifold3d hulls", "opencamlib drop cutter"}
    assert all(set(report["columns"]) <= set(row) for row in report["rows"])
    assert "manifold3d not installed" in report["notes"][-1]
    assert sum(row["ratio"] == 1.0 for row in report["rows"]) == 4
    instants_rows = [row for row in report["rows"] if row["method"].startswith("NumPy")]
    assert len(instants_rows) == 4
    assert all(row["seconds"] > 0.0 and len(row["levels"]) == 2 for row in instants_rows)


def test_installed_peers_are_measured(tiny):
    for name in bench.PEERS:
        pytest.importorskip(name)
    rows = bench.peers("cpu")["rows"]
    assert not [row for row in rows if "install" in row["from"]]
    droppers = [row for row in rows if row["method"].startswith("opencamlib")]
    assert len(droppers) == 2
    assert all("exact" in row["from"] and row["seconds"] > 0.0 for row in droppers)
    hulls = next(row for row in rows if row["method"] == "manifold3d hulls" and "normals" in row["case"])
    assert hulls["error ~ n^"] < -1.0
    assert hulls["ratio at 1e-6"] > hulls["ratio"] > hulls["ratio at 1e-2"]
