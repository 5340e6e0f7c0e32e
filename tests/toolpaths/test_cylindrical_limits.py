from dataclasses import replace
from math import cos, radians, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.programs.operation import Tool
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.toolpaths.cylindrical.limits import check_tool, pass_range, reached_range, stock_layers
from gearsim.toolpaths.cylindrical.settings import Cutting, Finishing, Roughing
from gearsim.toolpaths.cylindrical.steps import descent, roll_points
from gearsim.toolpaths.cylindrical.teeth import finish_teeth, rough_teeth
from tests.toolpaths.cylindrical_gears import MACHINE, RADIUS, distances, first_space, poses, thesis

UNUSUAL = [(60, 0.0), (60, 20.0), (60, -30.0), (-60, 25.0), (-40, -35.0), (9, 15.0)]


def test_external_roughing_stops_at_the_middle_of_the_space():
    """Groover 3.26 for spur gears: tan(xi + eta_b) = xi + N / R_b at the inner limit."""
    gear, stock = thesis(15), 2.0
    low, _ = pass_range(gear, "right", -5.0, RADIUS, stock)
    assert low > 0.1
    assert tan(low + gear.space_half_angle) == pytest.approx(low + (RADIUS + stock) / gear.base_radius, abs=1e-12)


def test_an_internal_gear_is_reached_up_to_the_middle_and_down_to_the_tool_radius():
    gear = replace(thesis(-30), dedendum=1.35)
    low, high = reached_range(gear, "left", np.array([-5.0]), RADIUS, 0.5)
    assert tan(high[0] - gear.space_half_angle) == pytest.approx(high[0] - RADIUS / gear.base_radius, abs=1e-12)
    assert high[0] < gear.root_roll - 0.02  # the tool is too thick for the root
    assert low[0] == pytest.approx(RADIUS / gear.base_radius)  # rho = R_b xi >= r


def test_in_the_thesis_internal_gear_the_tool_stops_at_the_root_circle():
    gear = thesis(-30)
    _, high = reached_range(gear, "left", np.array([-5.0]), RADIUS, 0.5)
    centre = gear.base_radius * np.hypot(1.0, high[0] - RADIUS / gear.base_radius)
    assert centre + RADIUS == pytest.approx(gear.root_radius)
    assert high[0] < gear.root_roll


@pytest.mark.parametrize(("teeth", "side"), [(15, "right"), (-30, "left")])
def test_a_flank_that_faces_up_loses_kappa_a_mm_of_depth_at_its_root(teeth, side):
    gear = thesis(teeth, 10.0)
    z = -np.arange(0.5, 10.1, 0.5)
    low, high = reached_range(gear, side, z, RADIUS, 0.5)
    root = low if teeth > 0 else high
    assert np.allclose(np.diff(root) / np.diff(z), -gear.twist * np.sign(teeth), atol=1e-9)


def test_the_hand_of_the_helix_swaps_the_flanks():
    z = np.linspace(-10.0, 0.0, 23)
    for teeth in (15, -30):
        a = reached_range(thesis(teeth, 10.0), "left", z, RADIUS, 0.5)
        b = reached_range(thesis(teeth, -10.0), "right", z, RADIUS, 0.5)
        assert np.allclose(a, b, rtol=0, atol=1e-12)


@pytest.mark.parametrize(("teeth", "helix_deg"), UNUSUAL)
def test_no_tool_cuts_a_flank_or_the_root_of_unusual_gears(teeth, helix_deg):
    gear, cutting = thesis(teeth, helix_deg, facewidth=12.0), Cutting(Tool(1, "long", 2.0 * RADIUS, 20.0, 3))
    for operation, stock in (
        (finish_teeth(gear, MACHINE, Finishing(cutting=cutting, axial_step=2.0)), 0.0),
        (rough_teeth(gear, MACHINE, Roughing(cutting=cutting, axial_step=3.0, involute_step=2.0)), 0.1),
    ):
        tip, axis = (a.reshape(-1, 3) for a in poses(operation.blocks, first_space(operation, gear), [0.3, 0.6, 1.0]))
        for side in SIDES:
            flank = InvoluteFlank(gear, side)
            low, high = flank.limits
            u, v = np.meshgrid(np.linspace(max(low, 0.03), high, 7), [-0.2, -6.1, -11.9])
            gap, along = distances(flank.jet(u.ravel(), v.ravel()).r, tip, axis)
            assert gap[along >= 0.0].min() > RADIUS + stock - 2e-6
        for part in (0.0, 0.5, 1.0):  # of what is engaged
            up = np.maximum(-tip[:, 2], 0.0) * part / axis[:, 2]
            radius = np.hypot(*(tip + up[:, None] * axis)[tip[:, 2] < 0.0, :2].T)
            deepest = (gear.sign * (radius - gear.root_radius)).min() - RADIUS
            assert deepest > -0.005 or gear.root_radius < gear.base_radius


@pytest.mark.parametrize("teeth", [60, -60])
def test_rapids_of_a_wide_helical_gear_allow_for_the_tool_leaning_over(teeth):
    gear = CylindricalGear(teeth, 5.0, radians(20.0), radians(30.0), facewidth=40.0)
    settings = Finishing(cutting=Cutting(Tool(1, "long", 2.0 * RADIUS, 50.0, 3)), axial_step=10.0)
    blocks = finish_teeth(gear, MACHINE, settings).blocks
    tip, axis = poses(blocks, np.flatnonzero(blocks.rapid)[:40], np.linspace(0.0, 1.0, 21))
    for part in np.linspace(0.0, 1.0, 5):
        up = np.maximum(-tip[..., 2], 0.0) * part / axis[..., 2]
        radius = np.hypot(*np.moveaxis(tip + up[..., None] * axis, -1, 0)[:2])
        away = gear.sign * (radius - gear.tip_radius) - RADIUS / cos(gear.base_helix_angle)
        assert (away[tip[..., 2] < 2.0 * RADIUS] > 0.49).all()


def test_wide_internal_helical_gears_lose_a_flank_and_keep_the_other():
    gear = CylindricalGear(-40, 3.0, radians(20.0), radians(30.0), facewidth=60.0)
    tool = 1.0
    for side, lost in (("left", True), ("right", False)):
        low, _ = reached_range(gear, side, np.array([-1.0, -59.0]), tool, 0.5)
        assert np.isnan(low[1]) == lost
        assert not np.isnan(low[0])


def test_stock_layers_count_up_from_the_last_and_begin_at_the_thesis_maximum():
    gear = thesis(15)
    layers = stock_layers(gear, RADIUS, 0.1, 0.25 * 2.0 * RADIUS)
    alpha = np.arccos(gear.base_radius / gear.tip_radius)
    assert layers[0] == pytest.approx(gear.base_radius * (tan(alpha) - alpha))  # 3.16 with gamma = 0
    assert np.allclose(layers[1:], 0.1 + 0.25 * 2.0 * RADIUS * np.array([3, 2, 1, 0]))
    assert stock_layers(thesis(-30), RADIUS, 0.1, 0.8)[0] == pytest.approx(
        thesis(-30).base_radius * thesis(-30).space_half_angle - 2.0 * RADIUS
    )


def test_a_helical_gear_is_offset_along_its_true_normal():
    """N = d / cos(beta_b): the inner limit of a thick layer lies where the transverse offset puts it."""
    gear, stock = thesis(15, 10.0), 2.0
    low, _ = pass_range(gear, "left", -5.0, RADIUS, stock)
    offset = (RADIUS + stock) / cos(gear.base_helix_angle) / gear.base_radius
    middle = tan(low + gear.space_half_angle) - low - offset
    assert abs(middle) < 2e-3  # up to the allowance for the tool's lean
    assert low > 0.1


def test_a_thick_tool_is_refused_with_the_width_of_the_space():
    check_tool(thesis(-30), 4.7)
    with pytest.raises(InputError, match=r"9\.495 mm wide"):
        check_tool(thesis(-30), 4.8)


@given(
    st.floats(0.0, 2.0),
    st.floats(0.0, 2.0),
    st.floats(0.05, 5.0),
    st.sampled_from(["arc", "roll"]),
    st.floats(5.0, 200.0),
)
def test_roll_points_part_the_pass_equally(start, end, step, spacing, radius):
    rolls = roll_points(radius, start, end, step, spacing)
    lengths = np.diff(rolls if spacing == "roll" else 0.5 * radius * rolls**2)
    assert (rolls[0], rolls[-1]) == (start, end)
    assert np.allclose(lengths, lengths[0], atol=1e-9)
    assert np.abs(lengths).max() <= step * (1.0 + 1e-6)


def test_descent_ends_at_the_bottom_and_leaves_out_the_top():
    assert descent(0.0, -10.0, 4.0) == pytest.approx([-10.0 / 3.0, -20.0 / 3.0, -10.0])
