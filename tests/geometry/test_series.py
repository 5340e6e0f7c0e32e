import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.geometry import series
from gearsim.geometry.series import Series

reals = st.floats(-2.0, 2.0)


def test_a_composite_has_the_derivatives_of_its_closed_form():
    """f = exp(-t²) sin t / (2 + t); derivatives by hand up to the second."""
    t0 = 0.3
    t = Series.variable(np.array([t0]), 2)
    f = series.exp(-(t * t)) * series.exp(t * 1j).imag / (t + 2.0)
    e, s, c, d = np.exp(-t0 * t0), np.sin(t0), np.cos(t0), 2.0 + t0
    u, u1, u2 = e * s, e * (c - 2 * t0 * s), e * ((4 * t0**2 - 3) * s - 4 * t0 * c)
    value, first, second = (x[0] for x in f.derivatives())
    assert value == pytest.approx(u / d, abs=1e-15)
    assert first == pytest.approx(u1 / d - u / d**2, abs=1e-14)
    assert second == pytest.approx(u2 / d - 2 * u1 / d**2 + 2 * u / d**3, abs=1e-14)


@given(reals, reals, reals)
def test_inverse_operations_give_back_the_series(a, b, c):
    x = Series(np.array([a + 5.0, b, c]))
    y = Series(np.array([c + 4.0, a, b]))
    assert np.allclose(((x * y) / y).c, x.c, atol=1e-12)
    assert np.allclose((series.sqrt(x) * series.sqrt(x)).c, x.c, atol=1e-12)
    assert np.allclose(series.log(series.exp(x)).c, x.c, atol=1e-12)
    assert np.allclose(((x - y) + y).c, x.c, atol=1e-12)
    assert np.allclose((3.0 - x).c, (-x + 3.0).c)


def test_differentiation_is_linear_and_obeys_the_product_rule(rng):
    a, b = (Series(rng.normal(size=(5, 4, 3))) for _ in range(2))
    left = series.cross(a, b).derivative()
    right = series.cross(a.derivative(), b) + series.cross(a, b.derivative())
    assert np.allclose(left.c, right.c)
    assert np.allclose(
        series.dot(a, b).derivative().c, (series.dot(a.derivative(), b) + series.dot(a, b.derivative())).c
    )


def test_a_unit_series_keeps_its_length(rng):
    u = series.unit(Series(rng.normal(size=(4, 7, 3))))
    length2 = series.dot(u, u)
    assert np.allclose(length2.c[0], 1.0)
    assert np.allclose(length2.c[1:], 0.0, atol=1e-12)


def test_composition_is_the_chain_rule():
    """exp(x) about x = 0.3 at x(t) = 0.3 + t - t^2 is the exponential of that series; scalar and vector."""
    inner = Series(np.array([[0.3], [1.0], [-1.0], [0.0]]))
    outer = series.exp(Series.variable(np.array([0.3]), 3))
    assert np.allclose(series.compose(outer, inner - 0.3).c, series.exp(inner).c)
    vector = series.compose(series.stack([outer, outer * 2.0]), inner - 0.3)
    assert np.allclose(vector.c[..., 1], 2.0 * series.exp(inner).c)
