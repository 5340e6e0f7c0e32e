"""The decision by curvature against the tool's signed distance from the part: no curvature there."""

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball
from gearsim.gouging.clearance import least_clearance, quadric
from gearsim.gouging.pairs import BAND, NEIGHBOURHOOD, agreement
from gearsim.gouging.tensors import principal_tensor


def test_the_decision_is_that_of_the_clearance():
    found = agreement(2000, seed=17)
    assert found.pairs == 2000
    assert 800 < found.gouging < 1600
    assert found.near > 100
    assert found.outside == 0
    assert found.widest <= BAND


def test_the_clearance_of_a_ball_over_a_bowl_is_the_difference_of_their_curvatures():
    part = principal_tensor(np.full((2, 1), 0.05), np.full((2, 1), 0.05))
    theta = np.array([0.0, 0.6])
    found = least_clearance(ball(20.0, 40.0), theta, quadric(part), NEIGHBOURHOOD)
    assert np.allclose(found, 0.1 - 0.05, atol=1e-5)


def test_a_quadric_touches_its_plane_and_has_the_tensor():
    part, step = principal_tensor(np.array([[0.1]]), np.array([[-0.05]]), 0.4), 1e-3
    height = quadric(part, np.array([[[0.3, -0.2]]]), np.array([[0.5]]))
    for alpha in (0.0, 0.4, 1.0, 2.0):
        x, y = step * np.cos(alpha), step * np.sin(alpha)
        bend = (height(x, y) + height(-x, -y)) / step**2
        assert bend[0, 0] == pytest.approx(float(part.at(alpha)[0, 0]), rel=1e-5)
    x, y = 0.4, -0.3
    h = height(x, y)[0, 0]
    q = float(part.a[0, 0] * x * x + 2 * part.b[0, 0] * x * y + part.c[0, 0] * y * y)
    assert h == pytest.approx(0.5 * q + h * (0.3 * x - 0.2 * y) + 0.25 * h * h)
