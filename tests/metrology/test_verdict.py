"""When a verdict says nothing: exact cases of nothing cut, nothing compared, no witness."""

from types import SimpleNamespace

import numpy as np
import pytest

from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.findings import Finding
from gearsim.metrology.inspection import Reading
from gearsim.metrology.verdict import headline, no_witness, not_compared, partly, untouched, verdict
from gearsim.surfaces.part import Intended, Part, Tolerance

UNCUT, MEASURED, THROUGH, ABSENT = (
    int(c) for c in (Crossing.UNCUT, Crossing.MEASURED, Crossing.THROUGH, Crossing.ABSENT)
)


def deviation(*crossing):
    n = len(crossing)
    return Deviation(np.full(n, np.nan), np.array(crossing, dtype=int), np.full(n, -1), np.zeros(n, dtype=bool))


@pytest.mark.parametrize("crossing", [(), (UNCUT,), (UNCUT, UNCUT), (ABSENT,), (ABSENT, UNCUT)])
def test_a_surface_that_no_ray_finds_cut_is_untouched(crossing):
    assert untouched("the flank", deviation(*crossing)) == ["no operation touches the flank: nothing of it was judged"]


@pytest.mark.parametrize("crossing", [(MEASURED,), (THROUGH,), (UNCUT, THROUGH), (ABSENT, UNCUT, MEASURED)])
def test_one_cut_is_a_touch_also_beyond_the_window(crossing):
    assert untouched("the flank", deviation(*crossing)) == []


@pytest.mark.parametrize(
    ("valid", "silent"), [((), True), ((0,), True), ((0, 0), True), ((0, 1), False), ((7,), False)]
)
def test_roads_compare_something_where_one_sample_is_valid(valid, silent):
    reasons = not_compared("the flank", [SimpleNamespace(valid=n) for n in valid])
    assert bool(reasons) == silent


def test_a_tri_dexel_without_an_end_near_a_flank_is_no_witness():
    assert no_witness(1, 0.0) == []
    assert no_witness(1, 1e-3) == []
    assert "differs from the rays by 0.0011 um" in no_witness(1, 1.1e-3)[0]
    assert "no cut end of the tri-dexel" in no_witness(0, 0.0)[0]


PART = Part("frame", None, {"a": Intended(None, Tolerance.both(1.0)), "b": Intended(None)})


def finding(fails):
    return Finding("out_of_tolerance", "a", 2.0, (0.0, 0.0, 0.0), None, None, fails, "")


@pytest.mark.parametrize(
    ("readings", "expected", "reason"),
    [
        ([], "unchecked", "nothing was judged"),
        ([Reading()], "unchecked", "nothing was judged"),
        ([Reading(judged=("b",))], "unchecked", "a was not measured"),
        ([Reading(judged=("a",))], "pass", "OK"),
        ([Reading(judged=("a", "b"))], "unchecked", "b has no tolerance to be judged by"),
        ([Reading(judged=("a",)), Reading(findings=(finding(False),))], "pass", "OK"),
        ([Reading(judged=("a",), findings=(finding(True),))], "fail", "OK"),
        ([Reading(judged=("a",), findings=(finding(True),), doubts=("x", "x"))], "unchecked", "x"),
    ],
)
def test_a_verdict_rests_on_what_was_judged_and_nothing_in_doubt(readings, expected, reason):
    judged, status = verdict(PART, readings)
    assert judged == expected
    assert status.startswith(reason)
    assert status.count("x") <= 1


def told(*fails, text="x", um=437.84):
    return tuple(Finding("k", "a", um, (0.0, 0.0, 0.0), None, None, f, f"{text} {int(f)}") for f in fails)


WELL, FAILS, KNOWN = "every judged deviation is within tolerance", "x 1 (+437.8 um)", "known beside: x 0 (+437.8 um)"


@pytest.mark.parametrize(
    ("judged", "status", "fails", "expected"),
    [
        ("pass", "OK", (), [WELL]),
        ("pass", "OK", (False, False), [WELL, KNOWN]),
        ("fail", "OK", (True, False, True), [FAILS, KNOWN]),
        ("unchecked", "why", (True, False), ["why", FAILS, KNOWN]),
    ],
)
def test_the_headline_names_all_that_is_known_whatever_the_verdict(judged, status, fails, expected):
    readings = [Reading(findings=told(*fails)), Reading(remarks=("one road",)), Reading(remarks=("one road",))]
    assert headline(judged, status, readings) == "; ".join([*expected, "one road"])


def test_the_headline_of_a_comparison_speaks_of_no_deviation():
    assert headline("pass", "OK", [], cut=False) == "nothing is cut, the comparison ran"


def test_a_collision_has_no_depth_to_tell():
    (touch,) = told(True, text="the rapid touches", um=None)
    assert touch.told == "the rapid touches 1"


@pytest.mark.parametrize(
    ("whole", "judged", "valid", "expected"),
    [
        (9, 9, (9,), []),
        (9, 9, (), []),
        (9, 9, (3, 9), []),
        (9, 8, (8,), ["1 of 9 samples of a do not lie on the machined surface"]),
        (9, 9, (3, 8), ["the two roads were compared at 8 of 9 samples of a"]),
        (9, 9, (0,), []),  # a doubt, told as such
    ],
)
def test_what_was_not_judged_or_compared_is_counted(whole, judged, valid, expected):
    assert partly("a", whole, judged, [SimpleNamespace(valid=n) for n in valid]) == expected


@pytest.mark.parametrize(
    ("overcut", "excess", "um", "inside"),
    [(1.0, 1.0, 1.0, True), (1.0, 1.0, -1.0, True), (1.0, 1.0, 1.0 + 1e-15, False), (1.0, 1.0, 1.1, False),
     (1.0, np.inf, 1e9, True), (1.0, np.inf, -1.1, False), (0.0, 0.0, 0.0, True), (0.0, 0.0, -1e-300, False)],
)  # fmt: skip
def test_a_tolerance_holds_at_its_very_ends(overcut, excess, um, inside):
    assert Tolerance(overcut, excess).allows(um) == inside
