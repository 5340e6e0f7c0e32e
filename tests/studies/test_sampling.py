import numpy as np
import pytest
from scipy import special, stats

from gearsim.errors import InputError
from gearsim.scene.study import checked_study
from gearsim.studies import quantiles
from gearsim.studies.sampling import parameters, told

FIRST_VALUES = {
    "monte-carlo": ["0x1.edb548bfd0c2cp-1", "0x1.fb18a8a1d11a5p-1", "0x1.1cbc420f588a8p-2", "0x1.1011a39af86c9p+2"],
    "latin-hypercube": ["0x1.2523bea9b3515p+0", "0x1.7df5b23956952p-1", "0x1.0896d054c64b1p-1", "0x1.00dd3ec132563p+1"],
    "sobol": ["0x1.e31787933d45dp-1", "0x1.05490ac2627d6p+0", "0x1.b11cc27f07bbap-3", "0x1.e0f596e5a03f7p+2"],
}


def drawn(*varied, method="monte-carlo", samples=64, seed=1):
    header = {"name": "a", "scene": "b", "method": method, "seed": seed}
    if method not in ("grid", "list"):
        header["samples"] = samples
    study = checked_study({"study": header, "vary": list(varied)}, "a")
    return parameters(study.study, study.vary, "a")


def one(samples=4096, method="monte-carlo", **form):
    return np.array(drawn({"key": "t.k", **form}, samples=samples, method=method)[0].values)


def test_logarithms_and_powers_are_those_of_numpy_but_for_the_last_places(rng):
    x = rng.uniform(-300.0, 300.0, 10_000)
    assert quantiles.logarithm(np.exp(x)) == pytest.approx(np.log(np.exp(x)), rel=1e-15, abs=1e-15)
    assert quantiles.exponential(x) == pytest.approx(np.exp(x), rel=5e-16)
    assert quantiles.logarithm(np.array([1.0, 2.0**-52, 2.0**100])).tolist() == pytest.approx(
        [0.0, np.log(2.0**-52), np.log(2.0**100)], rel=2e-16
    )
    assert quantiles.exponential(np.array([0.0]))[0] == 1.0


def test_normal_quantiles_and_shares_are_those_of_scipy(rng):
    share = np.concatenate([rng.random(10_000), 10.0 ** -np.arange(1.0, 300.0), [0.075, 0.925, 0.5]])
    assert quantiles.standard_normal(share) == pytest.approx(special.ndtri(share), rel=2e-15)
    assert quantiles.standard_normal(np.array([0.5]))[0] == 0.0
    for x in (-1e-3, -1.0, -3.0, -8.0, -37.0):
        assert quantiles.share_below(x) == pytest.approx(special.ndtr(x), rel=1e-12)
    assert [quantiles.share_below(x) for x in (0.0, -40.0)] == [0.5, 0.0]


@pytest.mark.parametrize(
    ("lower", "upper"), [(-1.0, 2.0), (0.0, 3.0), (2.0, 3.0), (6.0, 7.0), (-9.0, -8.0), (-3.0, 3.0)]
)
def test_a_normal_distribution_cut_off_is_that_of_scipy(lower, upper, rng):
    share = rng.random(1000)
    ours = quantiles.normal(share, 10.0, 2.0, 10.0 + 2.0 * lower, 10.0 + 2.0 * upper)
    assert ours == pytest.approx(10.0 + 2.0 * stats.truncnorm.ppf(share, lower, upper), rel=1e-9)
    ends = quantiles.normal(np.array([0.0, 1.0]), 10.0, 2.0, 10.0 + 2.0 * lower, 10.0 + 2.0 * upper)
    assert ends == pytest.approx([10.0 + 2.0 * lower, 10.0 + 2.0 * upper], rel=1e-9)


def test_shares_0_and_1_have_finite_values():
    ends = np.array([0.0, 1.0])
    assert np.isfinite(quantiles.normal(ends, 0.0, 1.0)).all()
    assert quantiles.triangular(ends, -1.0, -1.0, 3.0).tolist() == [-1.0, 3.0]
    assert quantiles.triangular(ends, -1.0, 3.0, 3.0).tolist() == [-1.0, 3.0]
    assert quantiles.log_uniform(ends, 0.1, 10.0).tolist() == [0.1, 10.0]
    assert quantiles.uniform(ends, 0.1, 0.3).tolist() == [0.1, 0.3]


@pytest.mark.parametrize(
    ("form", "law"),
    [
        ({"low": 2.0, "high": 5.0}, stats.uniform(2.0, 3.0)),
        ({"low": 0.01, "high": 10.0, "scale": "log"}, stats.loguniform(0.01, 10.0)),
        ({"distribution": "normal", "mean": 3.0, "deviation": 0.5}, stats.norm(3.0, 0.5)),
        ({"distribution": "normal", "mean": 0.0, "deviation": 2.0, "lower": 0.0}, stats.halfnorm(0.0, 2.0)),
        ({"distribution": "triangular", "low": -1.0, "mode": 0.0, "high": 4.0}, stats.triang(0.2, -1.0, 5.0)),
        ({"distribution": "tolerance", "nominal": 8.0, "tolerance": 0.3}, stats.truncnorm(-3.0, 3.0, 8.0, 0.1)),
    ],
)
def test_what_is_drawn_follows_its_distribution(form, law):
    assert stats.kstest(one(**form), law.cdf).pvalue > 0.01
    assert stats.kstest(one(**form, method="sobol"), law.cdf).statistic < 1e-3
    assert stats.kstest(one(**form, method="latin-hypercube"), law.cdf).statistic < 1e-3


def test_values_are_the_same_on_every_machine():
    """Bit for bit: a change here makes every data set that exists another one."""
    form = {"distribution": "normal", "mean": 1.0, "deviation": 0.1}
    log = {"low": 0.1, "high": 10.0, "scale": "log"}
    for method, expected in FIRST_VALUES.items():
        found = drawn({"key": "t.a", **form}, {"key": "t.b", **log}, method=method)
        assert [x.hex() for p in found for x in p.values[:2]] == expected


def test_a_key_of_monte_carlo_has_a_stream_of_its_own_and_more_samples_go_on():
    a, b = {"key": "t.a", "low": 0.0, "high": 1.0}, {"key": "t.b", "low": 0.0, "high": 1.0}
    (alone,) = drawn(b)
    first, second = drawn(a, b, samples=100)
    assert second.values[:64] == alone.values
    assert not set(first.values) & set(second.values)
    assert drawn(b, seed=2)[0].values != alone.values


def test_a_latin_hypercube_has_one_sample_in_every_stripe():
    for p in drawn(*({"key": f"t.{k}", "low": 0.0, "high": 1.0} for k in "abc"), method="latin-hypercube", samples=50):
        assert sorted(int(50 * x) for x in p.values) == list(range(50))


def test_sobol_samples_are_balanced_at_powers_of_two_and_go_on():
    varied = [{"key": f"t.{k}", "low": 0.0, "high": 1.0} for k in "ab"]
    fine = drawn(*varied, method="sobol", samples=64)
    boxes = {(int(8 * x), int(8 * y)) for x, y in zip(fine[0].values, fine[1].values, strict=True)}
    assert len(boxes) == 64
    assert [p.values[:50] for p in fine] == [p.values for p in drawn(*varied, method="sobol", samples=50)]


@pytest.mark.parametrize(
    ("samples", "method", "count"),
    [(1000, "sobol", 1), (1024, "sobol", 0), (1, "sobol", 0), (1000, "monte-carlo", 0)],
)
def test_sobol_samples_that_are_no_power_of_two_are_told(samples, method, count):
    header = {"name": "a", "scene": "b", "method": method, "samples": samples}
    notes = told(checked_study({"study": header, "vary": [{"key": "t.k", "low": 0.0, "high": 1.0}]}, "a").study)
    assert len(notes) == count
    assert all("512 or 1024 would be" in note for note in notes)


def test_a_grid_has_every_combination_and_the_last_key_changes_first():
    a, b, c = drawn(
        {"key": "t.a", "values": [1, 2]}, {"keys": ["t.b", "t.c"], "values": [["x", 0.5], ["y", 1]]}, method="grid"
    )
    assert (a.values, b.values, c.values) == ((1, 1, 2, 2), ("x", "y", "x", "y"), (0.5, 1.0, 0.5, 1.0))
    assert [type(v) for v in c.values] == [float] * 4
    (steps,) = drawn({"key": "t.a", "low": 0.0, "high": 1.0, "count": 5}, method="grid")
    assert (steps.values, steps.lower, steps.upper) == ((0.0, 0.25, 0.5, 0.75, 1.0), 0.0, 1.0)
    (log,) = drawn({"key": "t.a", "low": 0.01, "high": 100.0, "count": 5, "scale": "log"}, method="grid")
    assert log.values == pytest.approx([0.01, 0.1, 1.0, 10.0, 100.0], rel=1e-15)


def test_a_list_takes_values_side_by_side():
    a, b = drawn({"key": "t.a", "values": [1, 2, 3]}, {"key": "t.b", "values": [True, False, True]}, method="list")
    assert list(zip(a.values, b.values, strict=True)) == [(1, True), (2, False), (3, True)]
    with pytest.raises(InputError, match=r"got t\.a 3, t\.b 2"):
        drawn({"key": "t.a", "values": [1, 2, 3]}, {"key": "t.b", "values": [1, 2]}, method="list")


def test_listed_values_are_drawn_alike():
    values = one(values=["p", "q", "r"], samples=3000)
    assert all(900 < np.sum(values == v) < 1100 for v in "pqr")
    assert set(one(values=[7], samples=5)) == {7}


def test_bounds_say_where_values_may_lie():
    tolerance, normal, free = drawn(
        {"key": "t.a", "distribution": "tolerance", "nominal": 8.0, "tolerance": 0.5},
        {"key": "t.b", "distribution": "normal", "mean": 0.0, "deviation": 1.0, "lower": -2.0},
        {"key": "t.c", "values": [1.0, 2.0]},
    )
    assert (tolerance.lower, tolerance.upper, normal.lower) == (7.5, 8.5, -2.0)
    assert np.isnan([normal.upper, free.lower, free.upper]).all()
    assert min(normal.values) >= -2.0
