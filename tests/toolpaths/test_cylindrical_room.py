"""Room between the walls of a space where the tool really is: closed forms against points of the flanks."""

from math import atan, cos, radians, sqrt, tan

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.programs.operation import Tool
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.toolpaths.cylindrical.limits import check_tool, stock_layers
from gearsim.toolpaths.cylindrical.settings import Cutting, Finishing, Slotting
from gearsim.toolpaths.cylindrical.slots import slot_spaces
from gearsim.toolpaths.cylindrical.teeth import finish_teeth
from tests.toolpaths.cylindrical_gears import MACHINE, distances, first_space, poses

STOCK = 0.1


def gear_of(teeth, helix_deg=0.0, shift=0.0, module=4.0, **rest):
    return CylindricalGear(teeth, module, radians(20.0), radians(helix_deg), 6.0, shift, **rest)


def slot(gear, diameter, radial_step=1.0):
    tool = Tool(1, "long", diameter, 60.0, 3)
    settings = Slotting(cutting=Cutting(tool), radial_step=radial_step, radial_immersion=0.5, stock=STOCK)
    operation = slot_spaces(gear, MACHINE, settings)
    return poses(operation.blocks, first_space(operation, gear), np.linspace(0.0, 1.0, 13))


def clear_of_flanks(gear, tip, axis, radius):
    """Least distance [mm] between the tools and points of both flanks, densest just above the tools' deepest end."""
    bottom = max(float(np.hypot(tip[:, 0], tip[:, 1]).min()), gear.base_radius)
    rolls = gear.roll(bottom + np.geomspace(1e-4, gear.tip_radius - bottom, 60))
    gaps = []
    for side in SIDES:
        u, v = np.meshgrid(rolls, [-0.1, -5.9])
        gap, along = distances(InvoluteFlank(gear, side).jet(u.ravel(), v.ravel()).r, tip, axis)
        gaps.append(np.where(along >= 0.0, gap, np.inf).min())
    return min(gaps) - radius


@pytest.mark.parametrize("helix_deg", [0.0, 18.0])
@pytest.mark.parametrize(
    ("teeth", "shift"),
    [(5, 0.0), (9, 0.3), (30, -0.3), (41, 0.0), (42, 0.0), (80, 0.0), (106, 0.3), (150, -0.4), (300, 0.0)],
)
def test_slots_keep_their_stock_from_both_flanks_whatever_the_number_of_teeth(teeth, shift, helix_deg):
    """With the base circle inside the root, from 42 teeth on, the space is wider at the root than eta_b says.

    Where the foot of the normal lies inside the tool's end, the nearest point lies across the pressure angle.
    """
    gear, radius = gear_of(teeth, helix_deg, shift), 1.0
    tip, axis = (a.reshape(-1, 3) for a in slot(gear, 2.0 * radius))
    near = clear_of_flanks(gear, tip, axis, radius)
    bite = radius * (1.0 - cos(radians(0.5 * helix_deg)))  # of flutes farther out, where the helix is steeper
    assert STOCK - 1e-6 - bite <= near <= 1.12 * STOCK
    assert np.hypot(tip[:, 0], tip[:, 1]).min() == pytest.approx(gear.root_radius)


@pytest.mark.parametrize("teeth", [60, 80, 120, 300])
def test_a_tool_too_wide_for_the_root_cuts_as_deep_as_it_fits(teeth):
    """The deepest of the radii, 0.1 mm apart, at which the flanks leave room for tool and stock, seen from points."""
    gear, radius = gear_of(teeth, module=2.0), 0.9
    tip, axis = (a.reshape(-1, 3) for a in slot(gear, 2.0 * radius, radial_step=0.1))
    deepest = float(np.hypot(tip[:, 0], tip[:, 1]).min())
    count = round((gear.tip_radius - gear.root_radius) / 0.1)
    step = (gear.tip_radius - gear.root_radius) / count

    def half_width(at):
        """The tool that fits between walls that stand radially, the stock off the flanks at their bottom."""
        roll = sqrt((at / gear.base_radius) ** 2 - 1.0)
        x, y, _ = InvoluteFlank(gear, "right").jet(np.array([roll]), np.array([0.0])).r[0]
        return at * tan(abs(np.arctan2(y, x)) - STOCK / gear.base_radius)

    bottom = round((gear.tip_radius - deepest) / step)
    assert 0 < bottom < count
    assert half_width(deepest) >= radius
    assert half_width(deepest - step) < radius
    assert STOCK - 1e-6 <= clear_of_flanks(gear, tip, axis, radius) <= 1.12 * STOCK


def base_is_root(teeth):
    """A gear whose root circle is its base circle, but for rounding."""
    plain = gear_of(teeth)
    return gear_of(teeth, dedendum=(plain.reference_radius - plain.base_radius) / plain.module)


@pytest.mark.parametrize("teeth", [17, 60])
@pytest.mark.parametrize("off", [-1e-12, 0.0, 1e-12])
def test_base_circle_and_root_circle_in_one(teeth, off):
    """There the slot takes 2 R_b tan(eta_b - stock / R_b): a tool of that size just fits, a larger one does not."""
    gear = gear_of(teeth, dedendum=base_is_root(teeth).dedendum + off)
    assert gear.root_radius == pytest.approx(gear.base_radius, abs=1e-10)
    width = 2.0 * gear.base_radius * tan(gear.space_half_angle - STOCK / gear.base_radius)
    for diameter, fits in ((width, True), (width - 1e-7, True), (width + 1e-7, False)):
        tip, axis = (a.reshape(-1, 3) for a in slot(gear, diameter))
        reached = np.hypot(tip[:, 0], tip[:, 1]).min() == pytest.approx(gear.root_radius)
        assert reached == fits
        assert clear_of_flanks(gear, tip, axis, 0.5 * diameter) >= STOCK - 1e-6


def test_a_tool_exactly_as_wide_as_the_slot_goes_through_once():
    """Both walls of its only pass stand at one angle: it goes down and up in the middle."""
    gear = gear_of(80)
    roll = sqrt((gear.root_radius / gear.base_radius) ** 2 - 1.0)
    half = gear.space_half_angle + roll - atan(roll) - STOCK / gear.base_radius
    tip, _ = slot(gear, 2.0 * gear.root_radius * tan(half), radial_step=100.0)
    assert len(tip) == 5  # in, down, over to the other wall, up, out
    assert np.allclose(tip[:, [0, -1], 1], 0.0, atol=1e-9)


def test_a_tool_wider_than_the_slot_at_the_tip_is_refused_with_a_width_that_is_none_below_zero():
    for gear, width in ((gear_of(80, module=2.0), None), (gear_of(300, module=0.05), 0.0)):
        with pytest.raises(InputError, match="wider than the slot") as error:
            slot(gear, 6.0)
        told = float(str(error.value).split(", ")[1].split(" mm")[0])
        roll = sqrt((gear.tip_radius / gear.base_radius) ** 2 - 1.0)
        half = gear.space_half_angle + roll - atan(roll) - STOCK / gear.base_radius
        assert told == pytest.approx(2.0 * gear.tip_radius * tan(half) if width is None else width, rel=1e-3)


@pytest.mark.parametrize("teeth", [-35, -60, -120, -250])
@pytest.mark.parametrize("helix_deg", [0.0, 12.0, -12.0])
def test_leaving_an_internal_flank_keeps_off_the_other_one(teeth, helix_deg):
    """With a tool that fills the space at its mouth there is less room there than at the base circle."""
    gear = gear_of(teeth, helix_deg)
    radius = 0.49 * width_at_tip(gear) - 6.0 * abs(tan(gear.base_helix_angle)) * 0.35
    settings = Finishing(cutting=Cutting(Tool(1, "long", 2.0 * radius, 60.0, 3)), axial_step=3.0)
    operation = finish_teeth(gear, MACHINE, settings)
    found = poses(operation.blocks, first_space(operation, gear), np.linspace(0.0, 1.0, 9))
    tip, axis = (a.reshape(-1, 3) for a in found)
    for side in SIDES:
        flank = InvoluteFlank(gear, side)
        low, high = flank.limits
        u, v = np.meshgrid(np.linspace(max(low, 0.03), high, 9), [-0.1, -3.0, -5.9])
        gap, along = distances(flank.jet(u.ravel(), v.ravel()).r, tip, axis)
        assert gap[along >= 0.0].min() > radius - 2e-6


def width_at_tip(gear):
    """The thickest tool that touches both flanks as it generates the tip, or the base circle that lies outside it."""
    xi, s = gear.tip_roll, gear.sign
    return 2.0 * s * gear.base_radius * cos(gear.base_helix_angle) * (tan(xi + s * gear.space_half_angle) - xi)


@pytest.mark.parametrize("teeth", [20, 60, 120, 300, -40, -120, -300])
def test_a_tool_that_just_reaches_the_tip_is_the_thickest(teeth):
    gear = gear_of(teeth)
    width = width_at_tip(gear)
    assert width > 0.0
    check_tool(gear, 0.499 * width)
    with pytest.raises(InputError, match=f"{width:.4g} mm wide".replace(".", r"\.")):
        check_tool(gear, 0.501 * width)


@pytest.mark.parametrize("teeth", [60, 106, 150, 300])
def test_roughing_begins_no_farther_out_than_the_space_widens(teeth):
    """The first layer's stock is the space's widening from root to tip, not from a base circle far inside the root."""
    gear = gear_of(teeth)
    rolls = [sqrt((r / gear.base_radius) ** 2 - 1.0) for r in (gear.tip_radius, gear.root_radius)]
    widening = gear.base_radius * ((rolls[0] - atan(rolls[0])) - (rolls[1] - atan(rolls[1])))
    layers = stock_layers(gear, 1.0, STOCK, 0.5)
    half_mouth = gear.base_radius * (gear.space_half_angle + rolls[0] - atan(rolls[0]))
    assert layers[0] == pytest.approx(max(widening, half_mouth - 2.0))
    assert layers[0] < half_mouth
