"""Shanks and holders as profiles above a cutter."""

import numpy as np
import pytest

from gearsim.cutters.holder import holder
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
