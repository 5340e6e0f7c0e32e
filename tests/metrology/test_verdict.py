"""When a verdict says nothing: exact cases of nothing cut, nothing compared, no witness."""

from types import SimpleNamespace

import numpy as np
import pytest

from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.verdict import no_witness, not_compared, untouched

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
    assert no_witness(SimpleNamespace(checked=1)) == []
    assert "no cut end of the tri-dexel" in no_witness(SimpleNamespace(checked=0))[0]
