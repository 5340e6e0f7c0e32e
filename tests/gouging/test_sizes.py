"""The largest mills against bisection and enumeration over Euler's formula at many directions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.bench.gouging import waves
from gearsim.gouging.khan.sizes import beside_best
from gearsim.gouging.sizes import largest_ball, largest_mills, largest_shank, least_difference
from gearsim.gouging.standard_mills import khan_mills, metric_mills, ranked
from gearsim.gouging.surface import largest_mill_map, surface_contacts
from gearsim.gouging.tensors import Tensor, principal_tensor

ALPHA = np.linspace(0.0, np.pi, 1441)


def least_by_euler(shank, corner, theta, high, low, alpha0):
    """Least difference of Euler's formulas of a torus and the part."""
    around = np.sin(theta) / (shank - corner + corner * np.sin(theta))
    tool = np.cos(ALPHA) ** 2 / corner + np.sin(ALPHA) ** 2 * around
    return np.min(tool - high * np.cos(ALPHA - alpha0) ** 2 - low * np.sin(ALPHA - alpha0) ** 2)


@settings(max_examples=60, deadline=None)
@given(st.floats(-0.1, 0.3), st.floats(-0.1, 0.3), st.floats(0.0, np.pi), st.floats(0.02, 1.5), st.floats(0.3, 8.0))
def test_the_largest_shank_is_where_eulers_formula_starts_to_gouge(k1, k2, alpha0, theta, corner):
    high, low = max(k1, k2), min(k1, k2)
    size = float(largest_shank(corner, theta, principal_tensor(high, low, alpha0)))
    small = least_by_euler(corner, corner, theta, high, low, alpha0)
    if np.isnan(size):
        assert small < 1e-4
    elif np.isinf(size):
        assert least_by_euler(1e9, corner, theta, high, low, alpha0) > -1e-4
    elif size < 1e4:
        assert least_by_euler(max(0.99 * size, corner), corner, theta, high, low, alpha0) > -1e-4
        assert least_by_euler(1.01 * size, corner, theta, high, low, alpha0) < 1e-5


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3), st.floats(0.0, np.pi), st.floats(0.0, 1.57), st.floats(0.0, 6.0))
def test_the_closed_form_is_a_tie(k1, k2, alpha0, theta, corner):
    part = principal_tensor(max(k1, k2), min(k1, k2), alpha0)
    size = float(largest_shank(corner, theta, part))
    if np.isfinite(size) and corner < size < 1e4 and theta > 1e-6:
        # the condition of the closed form: a large 1/r magnifies rounding, a near tie of the corner does too
        scale = 1.0 + 1.0 / max(corner, 1e-3)
        assert abs(float(least_difference(size, corner, theta, part))) < 1e-9 * scale


def test_the_largest_ball_is_the_bowls():
    bowl = principal_tensor([0.1, -0.01, 0.1], [0.02, -0.1, 0.1])
    assert np.allclose(largest_ball(np.array([0.3, 0.3, 0.0]), bowl), [10.0, np.inf, 10.0])
    wall = Tensor(np.array([-0.2]), np.array([0.0]), np.array([0.05]))
    assert np.allclose(largest_ball(np.array([0.5 * np.pi]), wall), 20.0)


def test_limits_on_the_bottom_and_on_the_shank():
    bottom, shank = 0.0, 0.5 * np.pi
    assert np.isinf(largest_shank(2.0, bottom, principal_tensor(0.0, -0.1)))
    assert largest_shank(2.0, bottom, principal_tensor(0.1, -0.1)) == 2.0  # only the ball
    assert np.isnan(largest_shank(12.0, bottom, principal_tensor(0.1, -0.1)))
    assert np.isnan(largest_shank(2.0, shank, principal_tensor(0.01, 0.0)))  # concave along the shank
    assert largest_shank(2.0, shank, principal_tensor(0.1, 0.0, 0.5 * np.pi)) == pytest.approx(10.0)


def test_catalogues_are_ranked_and_whole():
    for mills in (khan_mills(), metric_mills()):
        assert np.array_equal(mills, ranked(mills[::-1]))
        assert np.all(mills[:, 1] <= mills[:, 0])
        assert len(np.unique(mills, axis=0)) == len(mills)
    assert {30.0, 6.0} <= set(khan_mills()[:, 0])
    assert khan_mills()[:, 1].min() == 2.0


def test_the_chosen_mill_is_the_first_that_fits():
    random = np.random.default_rng(5)
    high, low = np.sort(random.uniform(-0.1, 0.4, (2, 40)), axis=0)[::-1]
    alpha0, theta = random.uniform(0.0, np.pi, 40), random.uniform(0.05, 1.5, 40)
    mills = metric_mills()
    mills = mills[mills[:, 1] > 0.0]
    choice = largest_mills(mills, theta, principal_tensor(high, low, alpha0))
    for i in range(40):
        fits = [least_by_euler(*m, theta[i], high[i], low[i], alpha0[i]) >= -1e-9 for m in mills]
        assert choice.row[i] == (fits.index(True) if any(fits) else -1)


def test_the_joint_mill_fits_everywhere_and_khans_need_not():
    """Two points: one limits r, the other R; the least of both gouges: k_min falls with r."""
    theta = np.array([0.1, 0.1])
    part = principal_tensor([0.24, 0.121], [-0.2, 0.0], [0.0, 0.5 * np.pi])
    found = beside_best(theta, part)
    assert found.khan == (8.0, pytest.approx(1.0 / 0.24))
    assert found.limiting == 1
    assert found.least < -0.01
    assert least_by_euler(*found.khan, 0.1, 0.121, 0.0, 0.5 * np.pi) == pytest.approx(found.least)
    fits = [np.all(least_difference(*m, theta, part) >= -1e-9) for m in khan_mills()]
    assert found.best.row == (fits.index(True) if any(fits) else -1)


def test_a_flat_bottom_leaves_no_flat_mill_in_a_bowl():
    assert np.isnan(largest_shank(0.0, 0.0, principal_tensor(0.1, -0.1)))


def test_the_map_of_a_surface_leaves_out_what_it_cannot_mill():
    u, v = (x.ravel() for x in np.meshgrid(*2 * [np.linspace(0.0, 1.0, 32)], indexing="ij"))
    jet = waves().jet(u, v)
    choice = largest_mill_map(jet, metric_mills())
    theta, part = surface_contacts(jet)
    assert np.all(choice.row >= 0)
    assert np.all(least_difference(choice.shank, choice.corner, theta, part) >= -1e-9)
    assert np.all(largest_mill_map(jet, metric_mills(), axis=(0.0, 0.0, -1.0)).row == -1)
