from math import radians

import numpy as np
import pytest

from gearsim.errors import NumericalError
from gearsim.geometry.rigid import Rigid
from gearsim.motion.segments import DEGREE, compile_motion, join
from gearsim.toolpaths.flank import FlankPath
from tests.conftest import random_rotation
from tests.motion.test_sources import random_cl

REACH = 27.0


def table_pose(table, row, x):
    powers = np.vander(np.atleast_1d(x), DEGREE + 1, increasing=True)
    return powers @ table.tip[row], powers @ table.axis[row]


@pytest.fixture(params=["CL", "flank"])
def source(request, rng, tooth, fitting_cutter):
    return (
        random_cl(rng, spread=0.6) if request.param == "CL" else FlankPath(tooth, "convex", fitting_cutter, 5.0).motion
    )


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9, 1e-11])
def test_the_table_meets_its_tolerance_everywhere(source, tolerance):
    table = compile_motion(source, REACH, tolerance)
    x = np.linspace(-1.0, 1.0, 33)
    worst = 0.0
    for row in range(len(table)):
        tip, axis = table_pose(table, row, x)
        t = table.start[row] + 0.5 * (table.end[row] - table.start[row]) * (1.0 + x)
        exact = source.pose(np.full(33, table.piece[row]), t, 0)
        error = np.linalg.norm(tip - exact.tip.value, axis=1) + REACH * np.linalg.norm(axis - exact.axis.value, axis=1)
        worst = max(worst, error.max())
    assert worst < 1.05 * tolerance + 2e-13


def test_rows_cover_the_motion_in_order_and_share_their_end_poses(source):
    table = compile_motion(source, REACH)
    assert (table.start[0], table.end[-1]) == (0.0, 1.0)
    for row in range(len(table) - 1):
        if table.piece[row] == table.piece[row + 1]:
            assert table.end[row] == table.start[row + 1]
        (end_tip, end_axis), (tip, axis) = table_pose(table, row, 1.0), table_pose(table, row + 1, -1.0)
        assert np.allclose(end_tip, tip, atol=1e-13)
        assert np.allclose(end_axis, axis, atol=1e-14)


def test_speed_bounds_every_tool_point(source, rng):
    table, h = compile_motion(source, REACH), 1e-3
    for row in rng.integers(len(table), size=20):
        x = rng.uniform(-0.99, 0.99)
        tips, axes = table_pose(table, row, np.array([x - h, x, x + h]))
        spin = np.cross(axes[1], (axes[2] - axes[0]) / (2 * h))
        offset = rng.normal(size=3)
        offset *= REACH / np.linalg.norm(offset)
        velocity = (tips[2] - tips[0]) / (2 * h) + np.cross(spin, offset)
        assert np.linalg.norm(velocity) <= table.speed[row] * (1 + 1e-6)
        assert np.linalg.norm(spin) <= table.spin[row] * (1 + 1e-6)


def test_acceleration_makes_the_distance_semi_convex(source, rng, published_cutter):
    """F(x + s) >= F + F' s - K s²/2 for the distance of any fixed point: what the kernels' search rests on."""
    table = compile_motion(source, published_cutter.reach)
    x = np.linspace(-1.0, 1.0, 81)
    for row in rng.integers(len(table), size=30):
        tips, axes = table_pose(table, row, x)
        point = tips[40] + axes[40] * rng.uniform(0, 20) + rng.normal(size=3) * 4.0
        q = point - tips
        z = np.sum(q * axes, axis=1)
        f = published_cutter.signed_distance(np.linalg.norm(q - z[:, None] * axes, axis=1), z)
        bent = f + 0.5 * table.acceleration[row] * x**2
        assert np.all(bent[2:] - 2.0 * bent[1:-1] + bent[:-2] > -1e-12)


def test_no_row_turns_by_more_than_asked(source):
    table = compile_motion(source, REACH, max_rotation=radians(0.2))
    start, end = (np.array([table_pose(table, r, x)[1][0] for r in range(len(table))]) for x in (-1.0, 1.0))
    turned = np.arccos(np.clip(np.sum(start * end, axis=1), -1, 1))
    assert turned.max() <= radians(0.2) * (1 + 1e-6)


def test_a_moved_table_is_the_table_of_the_moved_motion(rng):
    from gearsim.motion.sources import MovedMotion

    source, rigid = random_cl(rng), Rigid(random_rotation(rng), 30.0 * rng.normal(size=3))
    moved, expected = compile_motion(source, REACH).moved(rigid), compile_motion(MovedMotion(source, rigid), REACH)
    assert np.allclose(moved.tip, expected.tip, atol=1e-12)
    assert np.allclose(moved.axis, expected.axis, atol=1e-13)


def test_joined_tables_number_their_paths(rng):
    a, b = (compile_motion(random_cl(rng), REACH) for _ in range(2))
    both = join([a, b])
    assert len(both) == len(a) + len(b)
    assert np.array_equal(both.path, [0] * len(a) + [1] * len(b))


def test_a_jump_is_refused():
    from gearsim.geometry.pose import PoseSeries
    from gearsim.geometry.series import Series
    from gearsim.motion.sources import CurveMotion

    def jump(t, order):
        c = np.zeros((order + 1, len(t), 3))
        c[0, :, 0] = np.where(t > 0.3, 1.0, 0.0)
        axis = np.zeros_like(c)
        axis[0, :, 2] = 1.0
        return PoseSeries(Series(c), Series(axis))

    with pytest.raises(NumericalError, match="piece 1 is still off after 4096"):
        compile_motion(CurveMotion(jump, 0.0, 1.0), REACH)
