"""Against a cylinder set against points of both flanks: no formula of the limits is used."""

from math import cos, radians, sin

import numpy as np
import pytest

from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, flank_sign
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.tool_access import largest_tool_diameter, reachable_roll, tool_reach


def gear(teeth, helix_deg, **rest):
    return CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), radians(helix_deg), 10.0, **rest)


def tool(flank, roll, z, radius):
    """End centre and axis of the end mill that generates a flank at one point."""
    point = flank.jet(np.array([roll]), np.array([z]))
    return point.r[0] + radius * point.normal[0], flank.axis(np.array([roll]), np.array([z]))[0]


def clearance(flank, end, axis, radius, low, beyond=0.0):
    """Least signed distance [mm] of a flank's points to the end mill, from the roll ``low`` to ``beyond`` its end."""
    u, v = np.meshgrid(np.linspace(low, flank.limits[1] + beyond, 801), np.linspace(-10.0, 0.0, 41))
    q = flank.jet(u.ravel(), v.ravel()).r - end
    height = q @ axis
    radial = np.linalg.norm(q - height[:, None] * axis, axis=1)
    return float(np.min(np.maximum(radial - radius, -height)))


CASES = [
    (gear(15, 0.0), 1.5875), (gear(15, 10.0), 1.5875), (gear(15, -10.0), 3.3),
    (gear(80, 0.0), 1.9), (gear(80, 20.0), 1.9),
    (gear(-30, 0.0), 1.5875), (gear(-30, 10.0), 1.5875), (gear(-30, -10.0), 1.0), (gear(-60, 20.0, addendum=0.6), 1.2),
]  # fmt: skip


@pytest.mark.parametrize(("wheel", "radius"), CASES)
@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("z", [-9.0, -3.0])
def test_the_range_is_cut_without_touching_either_flank_and_ends_where_it_must(wheel, radius, side, z):
    flank, other = (InvoluteFlank(wheel, s) for s in (side, "left" if side == "right" else "right"))
    low, high = reachable_roll(wheel, side, radius, z)
    assert low < high
    least = radius * cos(wheel.base_helix_angle) / wheel.base_radius if wheel.is_internal else 0.0
    for roll in np.linspace(low, high, 3):
        end, axis = tool(flank, roll, z, radius)
        assert clearance(other, end, axis, radius, least) > -1e-9
        assert clearance(flank, end, axis, radius, least) > -1e-9
    root_end = high if wheel.is_internal else low
    narrow = radius / cos(wheel.base_helix_angle) > wheel.base_radius * wheel.space_half_angle
    if root_end != wheel.root_roll and (narrow or wheel.is_internal):
        slack = abs(wheel.twist * radius * sin(wheel.base_helix_angle))
        end, axis = tool(flank, root_end - wheel.sign * (slack + 2e-3), z, radius)
        assert clearance(other, end, axis, radius, least, beyond=0.05) < 0.0


def test_concave_flanks_are_gouged_from_the_base_circle_on():
    """At xi = 0 the tool takes about 2 r³ / (3 R_b²) of the flank, 0.54 um for Groover's internal gears."""
    wheel, radius = gear(-30, 0.0), 1.5875
    flank = InvoluteFlank(wheel, "right")
    gouge = clearance(flank, *tool(flank, 0.0, -10.0, radius), radius, 0.0)
    assert gouge == pytest.approx(-2.0 * radius**3 / (3.0 * wheel.base_radius**2), rel=0.02)


@pytest.mark.parametrize("wheel", [gear(15, 0.0), gear(80, 0.0), gear(-30, 0.0), gear(-60, 0.0)])
def test_the_largest_tool_touches_both_flanks_at_the_root(wheel):
    radius = 0.5 * largest_tool_diameter(wheel)
    end, axis = tool(InvoluteFlank(wheel, "right"), wheel.root_roll, -9.0, radius)
    assert np.arctan2(end[1], end[0]) == pytest.approx(0.0, abs=1e-12)
    assert clearance(InvoluteFlank(wheel, "left"), end, axis, radius, 0.0) == pytest.approx(0.0, abs=2e-5)
    low, high = reachable_roll(wheel, "left", radius * (1.0 - 1e-9))
    assert (high if wheel.is_internal else low) == pytest.approx(wheel.root_roll, abs=1e-6)


def test_the_thesis_tool_cannot_reach_the_root_of_its_internal_gears():
    for helix_deg in (0.0, 10.0):
        assert largest_tool_diameter(gear(-30, helix_deg)) < 3.175 < largest_tool_diameter(gear(15, helix_deg))


@pytest.mark.parametrize("wheel", [gear(15, 10.0), gear(-30, 10.0)])
def test_the_tool_reaches_the_radius_of_its_deepest_point(wheel):
    """The end's centre, less or more the radius: where the tool's own points lie nearest the root."""
    end, axis = tool(InvoluteFlank(wheel, "right"), 0.4, -5.0, 1.5)
    x = np.cross(axis, [0.0, 0.0, 1.0])
    x /= np.linalg.norm(x)
    angle = np.linspace(0.0, 2.0 * np.pi, 20001)[:, None]
    rim = end + 1.5 * (np.cos(angle) * x + np.sin(angle) * np.cross(axis, x))
    radii = np.hypot(rim[:, 0], rim[:, 1])
    found = radii.max() if wheel.is_internal else radii.min()
    assert float(tool_reach(wheel, 0.4, 1.5)) == pytest.approx(found, abs=0.02)


def test_an_empty_range_where_the_tool_does_not_fit():
    low, high = reachable_roll(gear(-30, 0.0), "right", 5.0)
    assert low > high


def test_hands_mirror_sides():
    for side in SIDES:
        f = flank_sign(side)
        left_hand, right_hand = gear(-30, -10.0), gear(-30, 10.0)
        mirrored = "left" if f > 0 else "right"
        assert reachable_roll(left_hand, side, 1.5, -9.0) == reachable_roll(right_hand, mirrored, 1.5, -9.0)
