"""Root land and fillets milled along their outline: where the tool touches, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.surfaces.gear_outline import FILLET, LAND, WALL, GearOutline
from gearsim.toolpaths.cylindrical.root import mill_root
from gearsim.toolpaths.cylindrical.settings import Cutting, RootMilling, Slotting
from gearsim.toolpaths.cylindrical.slots import slot_spaces
from tests.toolpaths.cylindrical_gears import MACHINE, RADIUS, first_space, poses, thesis

SETTINGS = RootMilling(axial_step=5.0, fillet=1.9)


@pytest.mark.parametrize(("teeth", "fillet"), [(15, 1.9), (15, RADIUS), (45, 1.7)])
def test_the_tool_runs_a_radius_off_the_root_and_nowhere_nearer(teeth, fillet):
    """With the tool's own radius in the fillets it stands still there; with 45 teeth they end on the involutes."""
    gear = thesis(teeth)
    outline = GearOutline(gear, fillet)
    operation = mill_root(gear, MACHINE, replace(SETTINGS, fillet=fillet))
    rows = first_space(operation, gear)
    tip, axis = poses(operation.blocks, rows, np.linspace(0.0, 1.0, 9))
    assert np.abs(axis - [0.0, 0.0, 1.0]).max() < 1e-12
    fed = tip[~operation.blocks.rapid[rows]].reshape(-1, 3)
    foot = outline.foot(np.hypot(fed[:, 0], fed[:, 1]), np.abs(np.arctan2(fed[:, 1], fed[:, 0])))
    assert foot.distance.min() == pytest.approx(RADIUS, abs=1e-9)
    low = fed[:, 2] == -10.0
    near = foot.distance < RADIUS + 1.1e-4
    assert {LAND} | ({FILLET} if fillet > RADIUS else set()) <= set(foot.piece[near & low].tolist())
    assert (WALL in foot.piece[near & low]) == (teeth == 15)
    rapid = tip[operation.blocks.rapid[rows]]
    assert (np.hypot(rapid[..., 0], rapid[..., 1]).min() > gear.tip_radius + RADIUS) or rapid[..., 2].min() > 0.0


def test_slots_may_leave_the_root_to_a_tool_of_its_own():
    gear = thesis(15)
    operation = slot_spaces(gear, MACHINE, Slotting(root_stock=1.9))
    tip, _ = poses(operation.blocks, first_space(operation, gear), np.linspace(0.0, 1.0, 3))
    assert np.hypot(tip[..., 0], tip[..., 1]).min() == pytest.approx(gear.root_radius + 1.9)
    with pytest.raises(InputError, match=r"root_stock_mm = 11\.25 leaves nothing"):
        slot_spaces(gear, MACHINE, Slotting(root_stock=11.25))


@pytest.mark.parametrize(
    ("gear", "change", "words"),
    [
        (thesis(15, 10.0), {}, "mills external spur gears"),
        (thesis(-30), {}, "mills external spur gears"),
        (thesis(15), {"fillet": 1.5}, "does not fit fillets of 1.5 mm"),
        (thesis(15), {"fillet": None}, "does not fit fillets of 0 mm"),
        (thesis(15), {"fillet": 4.0}, "it must be below"),
        (thesis(15, facewidth=14.0), {}, "the depth of 14 mm exceeds the flute length"),
    ],
)
def test_a_root_that_cannot_be_milled_is_refused(gear, change, words):
    with pytest.raises(InputError, match=words):
        mill_root(gear, MACHINE, replace(SETTINGS, **change))


def test_settings_of_the_root_are_positive():
    with pytest.raises(InputError, match="axial_step must be positive"):
        RootMilling(axial_step=0.0, cutting=Cutting())
