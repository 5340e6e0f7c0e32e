"""Indices and slopes of functions whose indices and slopes are known; and what cannot be told is told."""

import numpy as np
import pytest
from scipy.stats import linregress, qmc

from gearsim.studies.importance import importance


def named(found):
    return {e.name: e for e in found.effects}


def ishigami(n, seed=3):
    """A = 7, B = 0.1 on [-pi, pi]^3; Ishigami and Homma, ISUMA 1990; indices in closed form."""
    x = np.pi * (2.0 * qmc.Sobol(3, seed=np.random.default_rng(seed)).random(n) - 1.0)
    y = np.sin(x[:, 0]) + 7.0 * np.sin(x[:, 1]) ** 2 + 0.1 * x[:, 2] ** 4 * np.sin(x[:, 0])
    return {"a": x[:, 0], "b": x[:, 1], "c": x[:, 2]}, y


def ishigami_indices():
    a, b = 7.0, 0.1
    v1, v2, v13 = 0.5 * (1.0 + b * np.pi**4 / 5.0) ** 2, a**2 / 8.0, 8.0 * b**2 * np.pi**8 / 225.0
    whole = v1 + v2 + v13
    return {"a": (v1 / whole, (v1 + v13) / whole), "b": (v2 / whole,) * 2, "c": (0.0, v13 / whole)}


@pytest.mark.parametrize(("n", "within"), [(256, 0.04), (512, 0.01)])
def test_ishigami_s_indices(n, within):
    columns, y = ishigami(n)
    found = importance("y", y, columns, "sobol", seed=1)
    assert found.shares_by == "expansion"
    assert found.explained > 1.0 - within
    for name, (first, total) in ishigami_indices().items():
        effect = named(found)[name]
        assert effect.first.value == pytest.approx(first, abs=within)
        assert effect.total.value == pytest.approx(total, abs=within)
        assert effect.total.low <= effect.total.value <= effect.total.high
    assert any("linear regression does not explain" in text for text in found.told)
    assert found == importance("y", y, columns, "sobol", seed=1)


def linear_case(n, rng, noise=0.0):
    """y = 3 a - 2 b + 0 c with b of any distribution: first order = total = the share of variance."""
    columns = {"a": rng.normal(0.0, 2.0, n), "b": rng.uniform(-1.0, 1.0, n), "c": rng.triangular(0.0, 1.0, 5.0, n)}
    return columns, 3.0 * columns["a"] - 2.0 * columns["b"] + noise * rng.normal(size=n)


def test_a_linear_figure_has_the_shares_and_slopes_by_hand():
    columns, y = linear_case(500, np.random.default_rng(0))
    found = importance("y", y, columns, "monte-carlo")
    effects, spread = named(found), {k: np.std(v) for k, v in columns.items()}
    whole = (3.0 * spread["a"]) ** 2 + (2.0 * spread["b"]) ** 2
    for name, slope in (("a", 3.0), ("b", -2.0), ("c", 0.0)):
        effect = effects[name]
        assert effect.slope.value == pytest.approx(slope, abs=1e-9)
        assert effect.standardised.value == pytest.approx(slope * spread[name] / np.std(y), abs=1e-9)
        assert effect.first.value == pytest.approx((slope * spread[name]) ** 2 / whole, abs=1e-9)
        assert effect.total.value == pytest.approx(effect.first.value, abs=1e-9)
    assert [e.name for e in found.effects] == ["a", "b", "c"]
    assert found.r2 == pytest.approx(1.0)
    assert found.explained == pytest.approx(1.0)


def test_of_one_parameter_the_slope_and_its_interval_are_those_of_the_textbook():
    rng = np.random.default_rng(5)
    x = rng.normal(size=12)
    y = 0.7 * x + rng.normal(size=12)
    slope = importance("y", y, {"x": x}, "list").effects[0].slope
    theirs = linregress(x, y)
    assert slope.value == pytest.approx(theirs.slope, rel=1e-12)
    assert slope.high - slope.value == pytest.approx(2.228139 * theirs.stderr, rel=1e-6)  # t of 10 degrees, 97.5 %


def test_intervals_hold_the_truth_about_as_often_as_they_say():
    """40 studies of 120 jobs, half the variance noise: of 95 % intervals 38 are expected to hold it."""
    inside = np.zeros((40, 4), dtype=bool)
    for k in range(40):
        columns, y = linear_case(120, np.random.default_rng(k), noise=6.0)
        a, c = (named(importance("y", y, columns, "monte-carlo", k))[name] for name in "ac")
        whole = 36.0 + 4.0 / 3.0 + 36.0
        truths = ((a.slope, 3.0), (c.slope, 0.0), (a.first, 36.0 / whole), (c.first, 0.0))
        inside[k] = [e.low <= truth <= e.high or np.isnan(e.value) for e, truth in truths]
    assert (inside.sum(axis=0) >= 34).all(), inside.sum(axis=0)


def test_a_grid_has_the_analysis_of_variance_by_hand():
    """y = a + 2 b + a b on {-1, 0, 1} x {-1, 1}: variances 2/3, 4 and 2/3."""
    a, b = (v.ravel() for v in np.meshgrid([-1.0, 0.0, 1.0], [-1.0, 1.0], indexing="ij"))
    found = importance("y", a + 2.0 * b + a * b, {"a": a, "b": b}, "grid")
    effects, whole = named(found), 2 / 3 + 4.0 + 2 / 3
    assert effects["a"].first.value == pytest.approx(2 / 3 / whole)
    assert effects["b"].first.value == pytest.approx(4.0 / whole)
    assert effects["a"].total.value == pytest.approx(4 / 3 / whole)
    assert effects["b"].total.value == pytest.approx((4.0 + 2 / 3) / whole)
    assert dict(found.together)["a with b"] == pytest.approx(2 / 3 / whole)
    assert np.isnan(effects["a"].first.low)


def test_levels_with_names_have_shares_but_no_slope():
    rng = np.random.default_rng(2)
    words, flag = rng.choice(["linear", "nurbs", "arc"], 300), rng.choice([True, False], 300)
    y = np.select([words == "nurbs", words == "arc"], [2.0, 1.0], 0.0) + 3.0 * flag
    found = importance("y", y, {"path": words.astype(object), "tcp": flag}, "monte-carlo")
    effects = named(found)
    assert np.isnan(effects["path"].slope.value)
    assert effects["tcp"].slope.value == pytest.approx(3.0)
    assert effects["tcp"].first.value + effects["path"].first.value == pytest.approx(1.0, abs=0.02)
    assert effects["path"].first.value == pytest.approx(np.var(y - 3.0 * flag) / np.var(y), abs=0.02)


def test_what_cannot_be_told_is_told():
    rng = np.random.default_rng(4)
    x, z = rng.normal(size=(2, 40))

    def said(y, columns, method="monte-carlo", **more):
        found = importance("y", y, columns, method, **more)
        return " | ".join(found.told), found

    assert "no parameter matters" in said(np.full(40, 1.7), {"x": x})[0]
    assert "no parameter matters" in said(1.7 + 1e-4 * x, {"x": x}, noise=1e-3)[0]
    assert "nothing can be said" in said(np.full(40, np.nan), {"x": x})[0]
    text, found = said(x, {"x": x, "still": np.ones(40)})
    assert "still: the same in all jobs" in text
    assert [e.name for e in found.effects] == ["x"]
    text, found = said(x + z, {"x": x, "twice": 2.0 * x + 1.0, "z": z})
    assert "x and twice move together" in text
    assert {e.name for e in found.effects} == {"x and twice", "z"}
    text, found = said(x, {"x": x, "z": z, "sum": x + z})
    assert "cannot tell their effects apart" in text
    assert all(np.isnan(e.slope.value) for e in found.effects)
    few = {name: rng.normal(size=5) for name in "abcd"}
    assert "5 jobs are too few for a regression on 4 parameters: it needs 6" in said(few["a"], few)[0]
    text, found = said(rng.normal(size=40), {"x": x, "z": z})
    assert "no polynomial predicts the figure" in text
    assert not found.shares_by
    assert "a list has no distribution" in said(x, {"x": x}, "list")[0]
    assert "are correlated" in said(x + z, {"x": x, "z": z + 2.0 * x})[0]


def test_jobs_without_a_value_are_left_out_and_counted():
    rng = np.random.default_rng(6)
    columns, y = linear_case(100, rng)
    y[:7] = np.nan
    found = importance("y", y, columns, "monte-carlo")
    assert (found.used, found.left_out) == (93, 7)
    assert named(found)["a"].slope.value == pytest.approx(3.0)
    assert "7 of 100 jobs have no value" in found.told[0]
    a, b = (v.ravel() for v in np.meshgrid([0.0, 1.0, 2.0], [0.0, 1.0, 2.0]))
    holed = np.where(a * b == 4.0, np.nan, a + b)
    assert any("grid is not whole" in t for t in importance("y", holed, {"a": a, "b": b}, "grid").told)


def test_parameters_that_move_together_value_by_value_are_one():
    a, b = (v.ravel() for v in np.meshgrid([1.0, 2.0, 3.0], [0.0, 1.0]))
    found = importance("y", a + b, {"a": a, "squared": a**2, "b": b}, "grid")
    assert {e.name for e in found.effects} == {"a and squared", "b"}
    assert found.shares_by == "grid"
