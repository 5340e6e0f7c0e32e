"""B-spline functions against the recursion in exact polynomials, and what must hold for all of them."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.geometry.nurbs import BSplineBasis, clamped_knots, order_knots, surface_derivatives


def exact_functions(knots, degree, span):
    """Coefficients of every N_i on one span by Cox and de Boor's recursion (2.9) with 0/0 = 0, as fractions."""
    t = [Fraction(k) for k in knots]
    functions = [[Fraction(int(i == span))] for i in range(len(t) - 1)]
    for q in range(1, degree + 1):
        raised = []
        for i in range(len(t) - 1 - q):
            total = [Fraction(0)] * (q + 1)
            for f, width, zero, sign in (
                (functions[i], t[i + q] - t[i], t[i], 1),
                (functions[i + 1], t[i + q + 1] - t[i + 1], t[i + q + 1], -1),
            ):
                for power, c in enumerate(f if width else []):
                    total[power + 1] += sign * c / width
                    total[power] -= sign * c * zero / width
            raised.append(total)
        functions = raised
    return functions


def derivative(coefficients, x, order):
    for _ in range(order):
        coefficients = [k * c for k, c in enumerate(coefficients)][1:]
    return float(sum(c * x**k for k, c in enumerate(coefficients)))


@st.composite
def bases(draw):
    """Clamped or not, with knots of any multiplicity up to the degree inside and one more at the ends."""
    degree = draw(st.integers(1, 5))
    inner = draw(st.lists(st.tuples(st.integers(1, 9), st.integers(1, degree)), max_size=5))
    ends = [draw(st.integers(1, degree + 1)) for _ in range(2)]
    knots, at = [0.0] * ends[0], 0
    for step, repeat in [*inner, *[(1, 1)] * degree]:
        at += step
        knots += [0.125 * at] * repeat
    knots += [0.125 * (at + 1)] * ends[1]
    while len(knots) < 2 * degree + 2:
        knots.append(knots[-1] + 0.5)
    return degree, np.array(knots)


@given(bases(), st.lists(st.integers(0, 64), min_size=1, max_size=4))
@settings(max_examples=60, deadline=None)
def test_functions_and_derivatives_are_those_of_the_exact_recursion(basis, places):
    degree, knots = basis
    functions = BSplineBasis(degree, knots)
    low, high = functions.domain
    u = low + (high - low) * np.array(places) / 64.0
    span, table = functions.functions(u, 3)
    for n, x in enumerate(u):
        s = int(span[n])
        assert knots[s] <= x <= knots[s + 1]
        assert knots[s] < knots[s + 1]
        exact = exact_functions(knots, degree, s)
        for order in range(4):
            wanted = [derivative(exact[i], Fraction(x), order) for i in range(s - degree, s + 1)]
            np.testing.assert_allclose(
                table[order, :, n], wanted, rtol=1e-12, atol=1e-13 * max(1.0, np.abs(wanted).max())
            )


@given(bases(), st.lists(st.floats(0.0, 1.0), min_size=1, max_size=20))
@settings(max_examples=60, deadline=None)
def test_functions_are_positive_and_sum_to_one(basis, fractions):
    functions = BSplineBasis(*basis)
    low, high = functions.domain
    u = np.clip(low + (high - low) * np.array(fractions), low, high)
    _, table = functions.functions(u, 2)
    assert table[0].min() >= 0.0
    np.testing.assert_allclose(table[0].sum(axis=0), 1.0, atol=1e-14)
    for order in (1, 2):
        np.testing.assert_allclose(table[order].sum(axis=0), 0.0, atol=1e-13 * np.abs(table[order]).max(initial=1.0))


def test_the_last_span_is_closed_and_interior_knots_belong_to_the_right():
    basis = BSplineBasis(2, np.array([0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0]))
    span, table = basis.functions(np.array([0.0, 1.0, 2.0]), 1)
    np.testing.assert_array_equal(span, [2, 4, 4])
    np.testing.assert_array_equal(table[0].T, [[1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def test_derivatives_agree_with_complex_steps():
    basis = BSplineBasis(4, clamped_knots(9, 4, -1.0, 3.0))
    u = np.random.default_rng(1).uniform(-1.0, 3.0, 50)
    _, table = basis.functions(u, 2)
    _, stepped = basis.functions(u + 1e-30j, 1)
    np.testing.assert_allclose(stepped.imag / 1e-30, table[1:], rtol=1e-13, atol=1e-13)


def test_knots_of_the_thesis():
    """(2.11), and the ranges of table 9-3; its v1 in [0, 4] with five points is of order 2, not 4 (erratum)."""
    np.testing.assert_array_equal(order_knots(5, 2), [0, 0, 1, 2, 3, 4, 4])
    np.testing.assert_array_equal(order_knots(3, 3), [0, 0, 0, 1, 1, 1])
    assert [order_knots(n, 4)[-1] for n in (13, 12, 4, 5)] == [10, 9, 1, 2]
    assert order_knots(5, 2)[-1] == 4


def test_a_bilinear_surface_and_a_weighted_line():
    line = BSplineBasis(1, clamped_knots(2, 1))
    net = np.zeros((2, 2, 4))
    net[..., 0] = [[0.0, 0.0], [4.0, 4.0]]
    net[..., 1] = [[0.0, 6.0], [0.0, 6.0]]
    net[..., 2] = [[0.0, 0.0], [0.0, 8.0]]
    net[..., 3] = 1.0
    u, v = np.array([0.25, 1.0]), np.array([0.5, 1.0])
    d = surface_derivatives(line, line, net, u, v)
    np.testing.assert_allclose(d.r, np.stack([4 * u, 6 * v, 8 * u * v], axis=1))
    np.testing.assert_allclose(d.ru, np.stack([4 + 0 * u, 0 * u, 8 * v], axis=1))
    np.testing.assert_allclose(d.ruv, [[0, 0, 8]] * 2)
    net[1, :] *= 3.0  # x = 12 u / (1 + 2 u), whose derivatives are 12/(1 + 2u)² and -48/(1 + 2u)³
    d = surface_derivatives(line, line, net, u, v)
    np.testing.assert_allclose(d.r[:, 0], 12 * u / (1 + 2 * u))
    np.testing.assert_allclose(d.ru[:, 0], 12 / (1 + 2 * u) ** 2)
    np.testing.assert_allclose(d.ruu[:, 0], -48 / (1 + 2 * u) ** 3)


@pytest.mark.parametrize(
    ("degree", "knots", "said"),
    [
        (2, [0, 0, 0, 2, 1, 3, 3, 3], "knot 5 is 1 after 2"),
        (2, [0, 0, 1, 1, 1], "at least 6"),
        (2, [0, 0, 0, 1, 1, 1, 2, 2, 2], "stands 3 times; at most 2"),
        (1, [0, 0, 0, 1, 1], "stands 3 times; at most 2"),
        (1, [5, 5, 5, 5], "stands 4 times"),
        (0, [0, 1], "degree in u must be at least 1"),
        (1, [0, 0, np.nan, 1], "finite"),
        (1, [0, 0, "x", 1], "numbers"),
    ],
)
def test_impossible_knots_are_refused(degree, knots, said):
    with pytest.raises(InputError, match=said):
        BSplineBasis(degree, knots)


def test_impossible_counts_are_refused():
    with pytest.raises(InputError, match="at least 4 control points"):
        clamped_knots(3, 3)
    with pytest.raises(InputError, match="order must lie between 2"):
        order_knots(3, 4)
