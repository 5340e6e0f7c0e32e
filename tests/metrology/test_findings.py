"""What is told of samples: depths measured, and depths that are no more than the measuring window's."""

from math import inf
from types import SimpleNamespace

import numpy as np
import pytest

from gearsim.metrology.convergence import Convergence
from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.findings import cross_cut, out_of_tolerance, root_findings, stock_left
from gearsim.metrology.samples import SampleGrid
from gearsim.surfaces.part import Tolerance

UNCUT, MEASURED, THROUGH = (int(c) for c in (Crossing.UNCUT, Crossing.MEASURED, Crossing.THROUGH))
OVERCUT_ALONE = Tolerance(5.0, inf)


def row(name="bottom", window=2.0):
    """Three samples of a surface, points 1 mm apart, measured as far as the window [mm]."""
    points, none, far = np.array([[[float(k), 0.0, 0.0] for k in range(3)]]), np.zeros((1, 3)), np.full((1, 3), window)
    patch = SimpleNamespace(name=name, blank=None)
    return SampleGrid(patch, np.arange(3.0), np.zeros(1), none, none, points, points, far, far)


def deviation(mm, crossing=(MEASURED,) * 3):
    value = np.where(np.array([crossing]) == MEASURED, np.array([mm], dtype=float), np.nan)
    return Deviation(value, np.array([crossing]), np.full((1, 3), -1), np.zeros((1, 3), dtype=bool))


def test_the_most_material_left_is_told_where_only_overcut_is_limited():
    (found,) = stock_left(row(), deviation((0.1, 0.4528, -0.2)), OVERCUT_ALONE)
    assert (found.kind, found.fails, found.place_mm) == ("stock_left", False, (1.0, 0.0, 0.0))
    assert found.told == "stock is left on the bottom land, which no tolerance limits (+452.8 um)"


@pytest.mark.parametrize(
    ("mm", "crossing", "tolerance"),
    [
        ((0.0, -0.1, 0.0), (MEASURED,) * 3, OVERCUT_ALONE),  # nothing is left
        ((5e-3, 0.0, 0.0), (MEASURED,) * 3, OVERCUT_ALONE),  # no more than may be cut too deep
        ((0.1, 0.1, 0.1), (MEASURED,) * 3, Tolerance.both(5.0)),  # judged
        ((0.1, 0.1, 0.1), (MEASURED,) * 3, None),  # not judged
    ],
)
def test_no_stock_is_told_where_there_is_none_or_a_tolerance_speaks(mm, crossing, tolerance):
    assert list(stock_left(row(), deviation(mm, crossing), tolerance)) == []


def test_uncut_samples_fail_only_where_what_is_left_is_limited():
    """One rule for every road into a job: planned, CL data and G-code."""
    crossing = (MEASURED, UNCUT, MEASURED)
    some = row(), deviation((0.1, 0.0, 0.3), crossing)
    assert list(out_of_tolerance(*some, OVERCUT_ALONE, "under program")) == []
    (found,) = stock_left(*some, OVERCUT_ALONE)
    assert (found.depth_um, found.fails) == (2000.0, False)
    assert found.text == "stock is left on the bottom land beyond the measuring window, which no tolerance limits"
    uncut = [f.kind for f in out_of_tolerance(*some, Tolerance.both(500.0), "under program") if f.fails]
    assert uncut == ["uncut"]


@pytest.mark.parametrize(
    ("crossing", "beyond"), [((MEASURED,) * 3, ""), ((MEASURED, UNCUT, MEASURED), " beyond the measuring window")]
)
def test_stock_that_fills_the_window_is_told_as_a_bound(crossing, beyond):
    (found,) = root_findings([(row(), deviation((0.1, 0.5, 0.3), crossing))], [OVERCUT_ALONE])
    depth = 2000.0 if beyond else 500.0
    assert found.text == f"stock is left on the bottom land{beyond}; it takes a pass of its own"
    assert found.depth_um == pytest.approx(depth)
    assert not found.fails


@pytest.mark.parametrize(
    ("excess", "crossing", "kinds", "fails"),
    [
        (500.0, (MEASURED,) * 3, [], []),  # exactly at the limit
        (499.9, (MEASURED,) * 3, ["root_stock"], [True]),
        (5000.0, (UNCUT, MEASURED, MEASURED), ["root_stock"], [True]),  # nobody knows how much stands there
    ],
)
def test_stock_within_a_limit_that_is_set_needs_no_pass_of_its_own(excess, crossing, kinds, fails):
    found = root_findings([(row(), deviation((0.1, 0.5, 0.3), crossing))], [Tolerance(5.0, excess)])
    assert [f.kind for f in found] == kinds
    assert [f.fails for f in found] == fails


@pytest.mark.parametrize(
    ("crossing", "beyond"), [((MEASURED,) * 3, ""), ((MEASURED, THROUGH, MEASURED), " beyond the measuring window")]
)
def test_a_cut_through_the_window_is_told_as_a_bound(crossing, beyond):
    cut = deviation((0.0, -0.5, 0.0), crossing)
    depth = -2000.0 if beyond else -500.0
    (root,) = root_findings([(row(), cut)], [OVERCUT_ALONE])
    (other,) = cross_cut(row("convex"), cut, OVERCUT_ALONE)
    assert root.text == f"the bottom land is overcut{beyond}"
    assert other.text == f"another pass cuts the convex surface beyond its intended form{beyond}"
    assert [root.depth_um, other.depth_um] == pytest.approx([depth, depth])
    assert root.fails
    assert other.fails


@pytest.mark.parametrize(
    ("worst", "expected"),
    [
        ((4.0, 1.0, 0.25), [2.0, 2.0]),
        ((0.2, 1e-10, 1.2e-10), [np.nan, np.nan]),  # exact from the second on: what differs is rounding
        ((2.5e-7, 2.5e-7, 2.5e-7), [np.nan, np.nan]),
        ((0.0, 0.0, 0.0), [np.nan, np.nan]),
    ],
)
def test_changes_of_rounding_have_no_order(worst, expected):
    assert Convergence((3, 5, 9), worst).orders == pytest.approx(expected, nan_ok=True)
