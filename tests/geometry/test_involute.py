from math import atan, pi, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.geometry.involute import inv, inverse_inv, inverse_roll_inv, roll_inv

ANGLES = st.floats(1e-7, 1.55)


def by_quadrature(angle):
    """The integral of tan²(a) from 0, by Gauss-Legendre on a fine mesh: no difference of near-equal numbers."""
    x, w = np.polynomial.legendre.leggauss(24)
    edges = np.linspace(0.0, angle, 41)
    half, middle = 0.5 * np.diff(edges)[:, None], 0.5 * (edges[1:] + edges[:-1])[:, None]
    return float(np.sum(half * w * np.tan(middle + half * x) ** 2))


@pytest.mark.parametrize("angle", [1e-6, 1e-3, 0.1, 0.1488, 0.1490, 0.35, 0.8, 1.3])
def test_inv_keeps_its_digits_down_to_the_base_circle(angle):
    assert float(inv(angle)) == pytest.approx(by_quadrature(angle), rel=3e-14)


def test_inv_of_20_degrees_is_the_tabulated_0_014904():
    assert float(inv(np.radians(20.0))) == pytest.approx(0.0149043839, abs=5e-11)


@given(ANGLES)
def test_inverses_undo_the_function(angle):
    assert float(inverse_inv(inv(angle))) == pytest.approx(angle, rel=1e-13)
    assert float(inverse_roll_inv(roll_inv(tan(angle)))) == pytest.approx(tan(angle), rel=2e-13)


@given(st.floats(-50.0, 50.0))
def test_the_function_undoes_the_inverse_on_both_sides_of_zero(value):
    angle = float(inverse_inv(value))
    assert -0.5 * pi < angle < 0.5 * pi
    assert float(roll_inv(inverse_roll_inv(value))) == pytest.approx(value, rel=2e-13)
    assert float(inverse_inv(-value)) == -angle


def test_zero_and_arrays_keep_their_place():
    values = np.array([[0.0, 1.0], [-1e-9, 200.0]])
    roll = inverse_roll_inv(values)
    assert roll.shape == (2, 2)
    assert roll[0, 0] == 0.0
    assert np.allclose(roll - np.arctan(roll), values, rtol=1e-12, atol=1e-18)
    assert roll[1, 1] == pytest.approx(200.0 + atan(roll[1, 1]), rel=1e-15)
