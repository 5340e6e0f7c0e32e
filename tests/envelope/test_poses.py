"""The table of an exact motion against the motion itself."""

import numpy as np
import pytest

from gearsim.envelope.poses import pose_table
from gearsim.errors import NumericalError
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion
from tests.motion.test_sources import random_cl

REACH = 30.0


def evaluated(table, piece, t):
    """Tip, its rate, axis and its rate by the table."""
    count = np.diff(table.first)[piece]
    along = (t + 0.5) * count / 2.0
    k = np.clip(np.where(t > 0.5, np.ceil(along) - 1.0, np.floor(along)).astype(int), 0, count - 1)
    x = (2.0 * (along - k) - 1.0)[:, None]
    found = []
    for coefficients in (table.tip, table.axis):
        value, rate = np.zeros((len(t), 3)), np.zeros((len(t), 3))
        for i in reversed(range(coefficients.shape[1])):
            rate = rate * x + value
            value = value * x + coefficients[table.first[piece] + k, i]
        found += [value, rate * count[:, None]]
    return found


def helix(values, order):
    """Six turns of a helix of 40 mm, the axis leaning along: needs many spans."""
    t = Series.variable(values, order)
    turn = series.exp(t * 12j * np.pi)
    lean = series.exp(t * 0.7j)
    return PoseSeries(
        series.stack([turn.real * 20.0 + 300.0, turn.imag * 20.0, t * 3.0]),
        series.stack([lean.imag, t * 0.0, lean.real]),
    )


def slow(values, order):
    """A nanometre's way, far from the origin."""
    t = Series.variable(values, order)
    bend = series.exp(t * 1j)
    zero = t * 0.0
    return PoseSeries(
        series.stack([bend.real * 1e-6 + 400.0, bend.imag * 1e-6, zero]), series.stack([zero, zero, zero + 1.0])
    )


@pytest.mark.parametrize(
    ("source", "speed"),
    [
        (random_cl(np.random.default_rng(5), 12), 20.0),
        (CurveMotion(helix, 0.0, 1.0), 754.0),
        (CurveMotion(slow, 0.0, 1.0), 1e-6),
        (CLMotion(np.array([[1.0, 2, 3], [1, 2, 3], [2, 2, 3]]), np.tile([0.0, 0, 1.0], (3, 1))), 1.0),
    ],
    ids=["CL", "helix", "nanometre", "standing"],
)
def test_poses_and_rates_are_true_to_rounding(source, speed, rng):
    piece, t = rng.integers(0, source.pieces, 4000), rng.uniform(-0.5, 1.5, 4000)
    t[:8] = [-0.5, 0.0, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5]
    tip, axis = (s.derivatives() for s in source.pose(piece, t, 1))
    found = evaluated(pose_table(source, REACH), piece, t)
    for ours, truth, limit in zip(found, (*tip, *axis), (4e-13, 4e-14 * speed, 1e-15, 2e-14 * (1.0 + speed / REACH)),
                                  strict=True):  # fmt: skip
        assert np.abs(ours - truth).max() < limit


def test_a_standing_tool_has_one_term():
    table = pose_table(CLMotion(np.ones((2, 3)), np.tile([0.0, 0, 1.0], (2, 1))), REACH)
    assert table.terms.tolist() == [1]


def test_few_terms_and_spans_serve_small_steps():
    source = CLMotion(np.array([[0.0, 0, 0], [1.0, 0, 0], [2.0, 0, 0]]), np.tile([0.0, 0, 1.0], (3, 1)))
    table = pose_table(source, REACH)
    assert table.terms.tolist() == [2, 2]
    assert table.first.tolist() == [0, 1, 2]


def test_a_piece_with_a_kink_is_refused():
    def kinked(values, order):
        t = Series.variable(values, order)
        c = np.zeros((order + 1, len(t.value), 3))
        c[0, :, 0] = np.abs(t.value - 0.3)
        if order:
            c[1, :, 0] = np.sign(t.value - 0.3)
        up = np.zeros_like(c)
        up[0, :, 2] = 1.0
        return PoseSeries(Series(c), Series(up))

    with pytest.raises(NumericalError, match="not smooth on piece 1 of 1"):
        pose_table(CurveMotion(kinked, 0.0, 1.0), REACH)


def test_a_motion_that_ends_with_its_piece_needs_no_poses_beyond():
    """A root at the piece's end: poses are nan behind it."""

    def rooted(values, order):
        t = Series.variable(values, order)
        with np.errstate(invalid="ignore"):
            inside = t.value <= 1.0
        t = Series(np.where(inside, t.c, np.nan))
        zero = t * 0.0
        return PoseSeries(series.stack([t, zero, zero]), series.stack([zero, zero, zero + 1.0]))

    table = pose_table(CurveMotion(rooted, 0.0, 1.0), REACH)
    t = np.linspace(0.0, 1.0, 50)
    tip = evaluated(table, np.zeros(50, dtype=int), t)[0]
    assert np.allclose(tip[:, 0], t, atol=1e-14)
