"""Rays that are none are refused where they are made."""

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle, join_rays

ORIGIN, Z, WINDOW = np.zeros((2, 3)), np.tile([0.0, 0.0, 1.0], (2, 1)), np.ones(2)


def test_rays_of_unit_length_and_rays_that_are_not_there_pass():
    assert len(RayBundle(ORIGIN, Z, -WINDOW, WINDOW)) == 2
    assert len(RayBundle(ORIGIN[:0], Z[:0], WINDOW[:0], WINDOW[:0])) == 0
    nowhere = np.array([[np.nan] * 3, [0.6, 0.0, 0.8]])
    assert len(join_rays([RayBundle(ORIGIN, nowhere, -WINDOW, WINDOW)])) == 2
    assert len(RayBundle(ORIGIN, Z * (1.0 + 0.9e-9), -WINDOW, WINDOW)) == 2


@pytest.mark.parametrize("length", [0.0, 2.0, 1.0 + 1e-8, 1.0 - 1e-8])
def test_directions_of_another_length_are_refused_by_number(length):
    with pytest.raises(InputError, match=r"direction 1 has length .*; expected 1"):
        RayBundle(ORIGIN, Z * np.array([[1.0], [length]]), -WINDOW, WINDOW)


@pytest.mark.parametrize("broken", range(4))
def test_shapes_that_do_not_match_are_refused(broken):
    columns = [ORIGIN, Z, -WINDOW, WINDOW]
    columns[broken] = columns[broken][:1]
    with pytest.raises(InputError, match=r"expected \(n, 3\), \(n, 3\), \(n,\), \(n,\)"):
        RayBundle(*columns)
