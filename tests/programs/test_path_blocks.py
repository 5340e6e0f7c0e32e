import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.machines.catalogue import MACHINES, table_table_bc
from gearsim.motion.program import ProgramMotion, cutting
from gearsim.motion.sources import CLMotion
from gearsim.programs.cldata import parse_cl
from gearsim.programs.path_blocks import blocks_from_cl, blocks_from_path


def curve(n):
    """A tip on a helix with its axis leaning outward and turning along."""
    t = np.linspace(0.0, 1.5, n)
    tips = np.stack([30.0 * np.cos(t), 30.0 * np.sin(t), 5.0 * t], axis=1)
    axes = np.stack([0.4 * np.cos(t + 0.3), 0.4 * np.sin(t + 0.3), np.sqrt(1.0 - 0.16) + 0.0 * t], axis=1)
    return tips, axes


@pytest.mark.parametrize(
    "name", ["table-table-bc", "table-table-ac", "head-head-cb", "head-b-table-c", "head-b-table-a"]
)
def test_blocks_pass_through_the_path_and_stay_near_it(name):
    machine = MACHINES[name]()
    tips, axes = curve(81)
    blocks = blocks_from_path(machine, tips, axes, 600.0, True)
    tip, axis = machine.forward(np.concatenate([blocks.start[None], blocks.values]))
    assert np.abs(tip - tips).max() < 1e-10
    assert np.abs(axis - axes).max() < 1e-12
    piece, t = np.repeat(np.arange(80), 3), np.tile([0.25, 0.5, 0.75], 80)
    ours, cl = (source.pose(piece, t, 0) for source in (ProgramMotion(blocks), CLMotion(tips, axes)))
    assert np.abs(ours.tip.value - cl.tip.value).max() < 1e-10
    assert np.abs(ours.axis.value - cl.axis.value).max() < 1e-4


def test_no_point_between_tip_and_reach_runs_faster_than_the_feed():
    tips, axes = curve(41)
    steps = np.linalg.norm(np.diff(tips, axis=0), axis=1)
    plain = blocks_from_path(table_table_bc(), tips, axes, 600.0, False)
    assert np.allclose(plain.seconds, steps / 10.0, rtol=1e-12)
    reached = blocks_from_path(table_table_bc(), tips, axes, 600.0, True, reach=20.0)
    for up in (0.0, 7.0, 20.0):
        assert (np.linalg.norm(np.diff(tips + up * axes, axis=0), axis=1) / reached.seconds <= 10.0 + 1e-12).all()
    turning = np.array([[0.0, 0, 1], [0.6, 0, 0.8]])
    still = blocks_from_path(table_table_bc(), np.zeros((2, 3)), turning, 600.0, True, reach=5.0)
    assert still.seconds[0] == pytest.approx(np.hypot(3.0, 1.0) / 10.0)


def test_a_cl_program_becomes_blocks_with_its_rapids():
    cl = parse_cl(
        "FROM/0,0,50,0,0,1\nRAPID\nGOTO/0,0,5,0,0,1\nPPRINT PASS one\nGOTO/6,8,5,0,0,1\nRAPID\nGOTO/6,8,50,0,0,1\n"
        "FROM/20,0,50,0,0,1\nPPRINT PASS two\nGOTO/20,0,44,0,0,1\nFINI\n"
    )
    blocks = blocks_from_cl(table_table_bc(), cl, 120.0, True)
    assert list(blocks.rapid) == [True, False, True, True, False]
    assert np.allclose(blocks.values[:, :3], [[0, 0, 5], [6, 8, 5], [6, 8, 50], [20, 0, 50], [20, 0, 44]])
    assert np.allclose(blocks.seconds[[1, 4]], [5.0, 3.0])
    assert np.isnan(blocks.seconds[[0, 2, 3]]).all()
    assert cutting(blocks).pieces == 2


def test_paths_that_no_machine_runs_are_refused():
    tips, axes = curve(5)
    machine = table_table_bc()
    with pytest.raises(InputError, match="at least 2 points, got 1"):
        blocks_from_path(machine, tips[:1], axes[:1], 100.0, True)
    with pytest.raises(InputError, match="feed must be positive, got 0"):
        blocks_from_path(machine, tips, axes, 0.0, True)
    with pytest.raises(InputError, match="machine table-table-bc: axis C overruns its limit"):
        blocks_from_path(machine.limited(C=(-0.5, 0.5)), tips, axes, 100.0, True)
