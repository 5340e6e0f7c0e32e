import numpy as np
import pytest

from gearsim.cutters.apt import conical
from gearsim.cutters.end_mills import ball
from gearsim.cutters.grinding import face_mill_head
from gearsim.cutters.undercut import t_slot
from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.motion.sources import CLMotion
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.in_order import cut_in_order, row_tree
from gearsim.simulation.intervals import nothing, stretches, subtract, whole
from gearsim.simulation.operation import operation
from gearsim.simulation.removal import Job, cut_jobs
from gearsim.simulation.tools import row_groups

BLOCK = Block(np.zeros(3), np.array([12.0, 8.0, 4.0]))


@pytest.fixture(scope="module")
def rays():
    box = DexelBox(Rigid(np.eye(3), np.zeros(3)), np.full(3, -0.3), np.array([12.4, 8.3, 4.2]), 0.3)
    return join_rays([box.rays(axis) for axis in range(3)])


def wandering(rng, cutter, points=16):
    """A tool that goes to and fro through the block and over it, its axis turning."""
    tips = rng.uniform([-3, -3, 1], [15, 11, 6], (points, 3))
    tilt = rng.normal(0.0, 0.03, (points, 2))
    axes = np.column_stack([tilt, np.ones(points)])
    return operation("wandering", cutter, [CLMotion(tips, axes / np.linalg.norm(axes, axis=1)[:, None])], 1e-9)


def material_of(rays):
    ray, lo, hi = BLOCK.chords(rays.origin, rays.direction)
    return stretches(len(rays), ray, np.maximum(lo, 0.0), np.minimum(hi, rays.end[ray]))


def one_by_one(rays, material, op):
    """Twin: row after row by the removal road, each from what is left."""
    left, lengths = material, []
    for alone in cut_jobs([Job(rays, op.table.part(np.array([row])), op.cutter) for row in range(len(op))]):
        after = subtract(left, alone.require_trust().removed)
        lengths.append(left.length - after.length)
        left = after
    return np.array(lengths), left


@pytest.mark.parametrize("cutter", [ball(2.0, 6.0), conical(0.8, 0.5, 0.2, 8.0), t_slot(4.0, 1.0, 2.0, 8.0)])
def test_rows_take_what_those_before_have_left(cutter, rays, rng, device):
    op, material = wandering(rng, cutter), material_of(rays)
    expected, left = one_by_one(rays, material, op)
    found = cut_in_order(rays, material, op, device=device)
    assert np.count_nonzero(expected > 1.0) > 10
    assert np.allclose(found.length, expected, atol=1e-5)
    mine = subtract(material, found.removed)
    assert np.array_equal(mine.first, left.first)
    assert np.allclose(mine.lo, left.lo, atol=3e-9)
    assert np.allclose(mine.hi, left.hi, atol=3e-9)
    assert found.length.sum() == pytest.approx(material.length - mine.length, abs=4e-9 * len(rays))


def test_a_second_pass_along_the_same_way_takes_nothing(rays):
    """The exact case: every end of the second pass is one of the first's."""
    tips = np.array([[-3.0, 4.0, 2.0], [15.0, 4.0, 2.0], [-3.0, 4.0, 2.0]])
    op = operation("to and fro", ball(2.0, 6.0), [CLMotion(tips, np.tile([0.0, 0.0, 1.0], (3, 1)))], 1e-9)
    length = cut_in_order(rays, material_of(rays), op).length
    assert length[0] > 100.0
    assert length[1] <= 1e-6


def test_nothing_is_taken_from_nothing(rays):
    op = operation(
        "line", ball(2.0, 6.0), [CLMotion(np.array([[0, 4, 2], [9, 4, 2.0]]), np.tile([0, 0, 1.0], (2, 1)))], 1e-9
    )
    assert np.all(cut_in_order(rays, nothing(len(rays)), op).length == 0.0)
    none = RayBundle(np.empty((0, 3)), np.empty((0, 3)), np.empty(0), np.empty(0))
    assert np.all(cut_in_order(none, nothing(0), op).length == 0.0)


def test_the_tree_holds_every_group_in_order_within_its_boxes(rng):
    op = wandering(rng, ball(1.0, 5.0), 50)
    groups = row_groups(op.table, op.cutter)
    tree = row_tree(groups, "cpu")
    leaf, after = tree.group.numpy(), tree.after.numpy()
    assert leaf[leaf >= 0].tolist() == list(range(len(groups.spread)))
    assert after[0] == len(leaf) == 2 * len(groups.spread) - 1
    for node in range(len(leaf)):
        below = leaf[node : after[node]]
        below = below[below >= 0]
        assert np.array_equal(tree.lower.numpy()[node], groups.lower[below].min(axis=0))
        assert np.array_equal(tree.upper.numpy()[node], groups.upper[below].max(axis=0))


def test_rings_are_refused(rays):
    head = face_mill_head(63.5, 3.0, 0.3, 0.3, 0.3, 10.0)
    still = CLMotion(np.zeros((2, 3)), np.tile([0.0, 0.0, 1.0], (2, 1)))
    with pytest.raises(InputError, match="a ring's rows are not cut in order"):
        cut_in_order(rays, whole(rays), operation("head", head, [still], 1e-9))
