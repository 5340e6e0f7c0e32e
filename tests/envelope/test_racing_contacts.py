"""Contacts that race around the tool while it all but stands still: found wherever they are on the tool."""

import numpy as np
import pytest

from gearsim.cutters.catalogue import flat
from gearsim.envelope import machined_along
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.series import Series
from gearsim.motion.sources import CurveMotion

RADIUS = 2.5
MILL = flat(2.0 * RADIUS, 20.0)


def turning_back(narrow, start=-0.9, end=1.1):
    """A mill whose axis runs along the parabola x = phi², y = narrow phi: at its vertex it turns back."""

    def poses(phi, order):
        at = Series.variable(phi, order)
        nil = Series(np.zeros_like(at.c))
        return PoseSeries(series.stack([at * at, at * narrow, nil]), series.stack([nil, nil, nil + 1.0]))

    return CurveMotion(poses, start, end)


def outside(narrow, angle):
    """Points of the outer offset curve, at angles from -x, and the ways to the mill's axis, both (n, 3)."""
    phi = 0.5 * narrow * np.tan(angle)
    inward = np.column_stack([np.cos(angle), -np.sin(angle), 0.0 * angle])
    return np.column_stack([phi * phi, narrow * phi, 0.0 * angle + 5.0]) - RADIUS * inward, inward


@pytest.mark.parametrize("narrow", [1.0, 1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("off", [0.0, 3e-4, -0.03])
def test_the_offset_curve_of_a_narrow_parabola(narrow, off):
    """The outer offset curve is machined; from ``off`` beside it along the normal the surface lies at -off."""
    steepest = min(1.5, np.arctan(1.6 / narrow))
    point, normal = outside(narrow, np.linspace(-steepest, steepest, 23))
    window = np.full(len(point), 0.1)
    rays = RayBundle(point + off * normal, normal, -window, window)
    found = machined_along(rays, [turning_back(narrow)], MILL)
    assert np.allclose(found.deviation, -off, atol=1e-9)
