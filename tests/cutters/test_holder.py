"""Shanks and holders as profiles above a cutter."""

import numpy as np
import pytest

from gearsim.cutters.end_mills import ball, conical, flat
from gearsim.cutters.flutes import fluted
from gearsim.cutters.holder import holder, standing_on
from gearsim.errors import InputError


def test_sections_stand_on_one_another():
    body = holder(25.0, [(6.0, 6.0, 20.0), (20.0, 30.0, 15.0), (24.0, 24.0, 10.0)])
    assert body.box == (0.0, 15.0, 25.0, 70.0)
    r = np.array([2.9, 3.1, 9.9, 14.9, 12.1, 11.9, 0.0])
    z = np.array([44.9, 44.9, 45.1, 59.9, 60.1, 69.9, 24.9])
    assert ((body.signed_distance(r, z) < 0.0) == [True, False, True, True, False, True, False]).all()


def test_sections_that_go_on_need_no_step_between_them():
    assert len(holder(5.0, [(8.0, 8.0, 3.0), (8.0, 12.0, 3.0)]).elements) == 4
    pointed = holder(0.0, [(4.0, 4.0, 3.0)])
    assert pointed.is_convex


def test_a_body_of_no_length_is_refused():
    with pytest.raises(InputError, match="holder"):
        holder(5.0, [(8.0, 12.0, 0.0)])


@pytest.mark.parametrize(
    ("cutter", "length"),
    [(flat(10.0, 30.0), 12.0), (ball(8.0, 30.0), 2.5), (ball(8.0, 30.0), 4.0), (conical(1.0, 0.8, 0.26, 25.0), 7.0)],
    ids=["flat", "ball, within it", "ball, at its end", "conical"],
)
def test_a_cutter_is_parted_where_its_flutes_end(cutter, length):
    """Every point is in the flutes, in the upper part, or in neither, as it is in the cutter below or above there."""
    low, high = fluted(cutter, length), standing_on(cutter, length, [("holder", [(20.0, 20.0, 5.0)])])
    r, z = (a.ravel() for a in np.meshgrid(np.linspace(0.01, 12.0, 60), np.linspace(0.013, 34.0, 120)))
    inside = cutter.signed_distance(r, z) < 0.0
    held = (z > cutter.height) & (z < cutter.height + 5.0) & (r < 10.0)
    assert np.array_equal(low.signed_distance(r, z) < 0.0, inside & (z < length))
    assert np.array_equal(high.signed_distance(r, z) < 0.0, (inside & (z > length)) | held)
    assert [high.called(h) for h in (length, cutter.height - 0.1, cutter.height)] == ["upper part"] * 2 + ["holder"]


def test_flutes_as_long_as_the_cutter_leave_no_upper_part_and_longer_ones_are_refused():
    assert standing_on(flat(10.0, 30.0), 30.0, ()) is None
    for length in (31.0, 1e-10):
        with pytest.raises(InputError, match=r"flute_length_mm = .*expected less than the cutter's height of 30 mm"):
            standing_on(flat(10.0, 30.0), length, ())
