import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from gearsim.cutters.catalogue import flat
from gearsim.envelope import swept
from gearsim.envelope.swept import Swept
from gearsim.errors import NumericalError
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion
from tests.cutters.shapes import every_shape
from tests.envelope.twins import trim
from tests.simulation.test_removal import CUTTERS, random_path


def test_rate_is_the_derivative_of_the_distance(rng):
    source, cutter = random_path(rng), CUTTERS[0]
    points = source.tips.mean(axis=0) + rng.normal(size=(50, 3)) * 8.0
    piece, t, h = np.zeros(50, dtype=int), np.full(50, 0.4), 1e-6

    def at(t):
        tip, axis = (s.derivatives() for s in source.pose(piece, t, 1))
        return trim.distance_rate(cutter, points, tip[0], axis[0], tip[1], axis[1])

    difference = (at(t + h)[0] - at(t - h)[0]) / (2 * h)
    assert np.quantile(np.abs(difference - at(t)[1]), 0.95) < 1e-6


@pytest.mark.parametrize("cutter", [*CUTTERS, *every_shape().values()], ids=lambda c: f"{c.name} {len(c.elements)}")
def test_least_distance_agrees_with_a_fine_scan(cutter, rng):
    for _ in range(4):
        source = random_path(rng)
        middle = source.tips.mean(axis=0) + 6.0 * source.axes[0]
        points = middle + rng.normal(size=(20, 3)) * 5.0
        ours = Swept(source, cutter).least_distance(points)
        for point, least in zip(points, ours, strict=True):

            def distance(x, point=point, source=source):
                x = np.clip(np.atleast_1d(x), 0.0, source.pieces)
                piece = np.minimum(x.astype(int), source.pieces - 1)
                pose = source.pose(piece, x - piece, 0)
                q = point - pose.tip.value
                z = np.sum(q * pose.axis.value, axis=1)
                return cutter.signed_distance(np.linalg.norm(q - z[:, None] * pose.axis.value, axis=1), z)

            x = np.linspace(0.0, source.pieces, 2001)
            f = distance(x)
            k = int(np.argmin(f))
            near = (max(x[k] - 1e-3, 0.0), min(x[k] + 1e-3, source.pieces))
            fine = minimize_scalar(lambda v, d=distance: d(v)[0], bounds=near, options={"xatol": 1e-12}).fun
            exact = min(fine, f[k])
            if len(cutter.parts) > 1 and exact < 0.0:
                assert exact - 1e-6 <= least <= 1e-10  # a depth below the surface of one part
            else:
                assert exact - 1e-6 <= least <= exact + 1e-10


def test_points_of_the_swept_boundary_have_distance_zero(rng):
    """Rigidly carried tool points stay inside or on the swept volume at every pose."""
    source, cutter = random_path(rng), CUTTERS[0]
    element = cutter.elements[2]
    p = element.at(np.linspace(0.1, 0.9, 15) * element.length)
    pose = source.pose(np.zeros(15, dtype=int), np.linspace(0, 1, 15), 0)
    u = np.cross(pose.axis.value, rng.normal(size=3))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    points = pose.tip.value + p.z[:, None] * pose.axis.value + p.r[:, None] * u
    assert np.all(Swept(source, cutter).least_distance(points) <= 1e-12)


def test_above_the_floor_a_distance_is_only_known_to_be_above():
    """A tool whose end slides at a constant height over points: exact below the floor, cheap and larger above it."""
    cutter = flat(4.0, 20.0)
    source = CLMotion(np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    below = np.array([[10.0, 0.5, -0.3], [12.0, -0.7, -2.0]])
    beside = np.array([[15.0, 2.5, 5.0], [15.0, 1.0, 5.0]])
    assert np.all(Swept(source, cutter).least_distance(below, floor=1e-6) > 1e-6)
    assert Swept(source, cutter).least_distance(beside, floor=1.0) == pytest.approx([0.5, -1.0], abs=1e-9)


def test_points_along_which_the_tool_slides_are_refused(monkeypatch):
    """On an arc in the plane of its end: the bound of the curvature needs very small steps there."""

    def curve(values, order):
        t = Series.variable(values, order)
        turn = series.exp(t * 0.5j)
        tip = series.stack([turn.real * 20.0, turn.imag * 20.0, t * 0.0])
        return PoseSeries(tip, series.stack([t * 0.0, t * 0.0, t * 0.0 + 1.0]))

    monkeypatch.setattr(swept, "_MOST_LOOKS", 1000)
    inside = 19.5 * np.array([[np.cos(0.25), np.sin(0.25), 0.0]])
    with pytest.raises(NumericalError, match="move the samples"):
        Swept(CurveMotion(curve, 0.0, 1.0), flat(4.0, 20.0)).least_distance(inside)
