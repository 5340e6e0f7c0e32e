"""The benchmark's methods against each other and against brute force; no assertion on time."""

import numpy as np
import pytest

from gearsim.bench import envelope as bench
from gearsim.errors import NumericalError


@pytest.fixture(scope="module")
def work():
    return bench.workload(12)


def test_the_workload_is_zhous_convex_flank(work):
    """1200 points within the face (cone distances of table 3.3), on the gear's tooth, toe to heel."""
    point, _ = bench.closed_form(work)
    distance = np.linalg.norm(point, axis=1)
    angle = np.degrees(np.arctan2(np.hypot(point[:, 0], point[:, 1]), point[:, 2]))
    assert len(point) == 1200
    assert 55.17 < distance.min() < 56.0
    assert 82.0 < distance.max() < 82.68
    assert angle.min() > 69.5  # above the root cone
    assert angle.max() < 78.5


def test_points_lie_on_the_boundary_of_the_moving_blade(work):
    """No pose of the roll comes deeper than the claimed one: the cone's distance to a fixed point, scanned."""
    some = slice(None, None, 37)
    point, normal = (a[some] for a in bench.closed_form(work))
    claimed = np.repeat(np.linspace(*bench._ROLL, 100), 12)[some]
    for offset, least in ((0.0, 0.0), (1e-3, 1e-3), (-1e-3, -1e-3)):
        near = claimed + np.linspace(-0.02, 0.02, 41)[:, None]
        frames = bench._GENERATOR.frames(near.ravel(), 0)
        p = np.broadcast_to(point + offset * normal, (41, *point.shape)).reshape(-1, 3) - frames.pose.tip.value
        axis = frames.pose.axis.value
        z = np.sum(p * axis, axis=1)
        r = np.linalg.norm(p - z[:, None] * axis, axis=1)
        # the blade's inner side is the cone r = tip - z tan(22 deg); the blade lies outside of it
        depth = (bench._TIP - z * np.tan(bench._BLADE) - r) * np.cos(bench._BLADE)
        assert np.allclose(depth.reshape(near.shape).min(axis=0), least, atol=1e-9)


def test_all_ways_to_points_agree(work):
    first = bench.closed_form(work)
    for method in bench._MESHING.values():
        assert bench.disagreement(method(work), first) < 1e-11


def test_all_ways_to_curvature_agree(work):
    first = bench.fundamental(work)
    for method in bench._CURVATURE.values():
        assert bench.disagreement(method(work), first) < 1e-9


def test_a_wrong_method_is_not_timed(work):
    wrong = {"right": bench.closed_form, "wrong": lambda w: tuple(1.001 * x for x in bench.closed_form(w))}
    with pytest.raises(NumericalError, match="wrong disagrees"):
        bench._race(wrong, work, 12)
    lost = {"right": bench.closed_form, "lost": lambda w: tuple(np.nan * x for x in bench.closed_form(w))}
    with pytest.raises(NumericalError, match="lost disagrees"):
        bench._race(lost, work, 12)


def test_the_report_fits_its_columns_and_tells_zhous_ratios(monkeypatch):
    monkeypatch.setattr(bench, "_PER_LINE", (100,))
    monkeypatch.setattr(bench, "_ROUNDS", 2)
    report = bench.envelope("cpu", "small")
    assert len(report["rows"]) == 9
    assert all(set(row) == set(report["columns"]) for row in report["rows"])
    assert {row["ratio in Zhou"] for row in report["rows"]} == {"-", 0.652, 0.848, 0.836}
    assert all(row["agrees to"] < 1e-9 for row in report["rows"])
    assert "0.652" in report["notes"][-1]
    assert "0.836" in report["notes"][-1]
