import numpy as np
import pytest

from gearsim.cutters.catalogue import apt
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.turned import Turned
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion
from gearsim.simulation.dexels import DexelBox, machined_stock
from gearsim.simulation.removal import cut
from tests.conftest import random_rotation

DISC = Turned(np.array([[0.0, 0.0], [20.0, 0.0], [20.0, 8.0], [0.0, 8.0]]))


def slot_volumes(pitch, rotation, device):
    """A slot 4 deep and 6 wide, right across a disc of 40 mm, seen by three bundles in a turned frame."""
    tool = apt(6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 30.0)
    source = CLMotion(np.array([[-40.0, 0.0, 4.0], [40.0, 0.0, 4.0]]), np.tile([0.0, 0.0, 1.0], (2, 1)))
    table = compile_motion(source, tool.reach)
    box = DexelBox(Rigid(rotation, np.zeros(3)), np.full(3, -36.0), np.full(3, 36.0), pitch)
    return [
        machined_stock(box, axis, DISC, cut(box.rays(axis), table, tool, device=device).require_trust().removed)
        for axis in range(3)
    ]


def exact_slot():
    """Area of the strip |y| < 3 of a disc of radius 20, times the depth."""
    return 4.0 * 2.0 * (3.0 * np.sqrt(400.0 - 9.0) + 400.0 * np.arcsin(3.0 / 20.0))


@pytest.mark.parametrize("turned", [False, True])
def test_three_bundles_find_the_volume(device, rng, turned):
    rotation = random_rotation(rng) if turned else np.eye(3)
    for bundle in slot_volumes(0.5, rotation, device):
        assert bundle.removed_volume == pytest.approx(exact_slot(), rel=0.01)
        assert bundle.stock_volume == pytest.approx(np.pi * 400.0 * 8.0, rel=0.01)


def test_the_volume_converges_with_the_pitch(rng):
    rotation = random_rotation(rng)
    errors = [
        np.sqrt(np.mean([(b.removed_volume - exact_slot()) ** 2 for b in slot_volumes(p, rotation, "cpu")]))
        for p in (2.0, 0.5)
    ]
    assert errors[1] < 0.5 * errors[0]


def test_cut_points_lie_on_the_slot(device):
    bundles = slot_volumes(1.0, np.eye(3), device)
    for bundle in bundles:
        points, segments = bundle.cut_points()
        on_floor = np.abs(points[:, 2] - 4.0) < 1e-9
        on_wall = (np.abs(np.abs(points[:, 1]) - 3.0) < 1e-9) & (points[:, 2] > 4.0 - 1e-9)
        assert np.all(on_floor | on_wall)
        assert np.all(segments >= 0)
    assert [len(b.cut_points()[0]) > 0 for b in bundles] == [False, True, True]  # rays along x end in no cut


def test_a_pitch_larger_than_the_box_is_refused():
    with pytest.raises(InputError, match="dexel pitch 3 mm is larger than the box"):
        DexelBox(Rigid(np.eye(3), np.zeros(3)), np.zeros(3), np.ones(3), 3.0)
