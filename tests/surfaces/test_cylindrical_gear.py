from math import atan, cos, degrees, inf, nan, pi, radians, sin, sqrt, tan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, flank_sign
from gearsim.surfaces.involute import InvoluteFlank

ALPHA = radians(20.0)


def thesis(teeth, helix_deg=0.0):
    """Groover's test gears, tables 5.3 to 5.6."""
    return CylindricalGear.from_transverse(teeth, 5.0, ALPHA, radians(helix_deg), 10.0)


def spur(teeth, **rest):
    return CylindricalGear(teeth, 2.0, ALPHA, facewidth=20.0, **rest)


def test_the_thesis_spur_gears_in_plain_numbers():
    outer, inner = thesis(15), thesis(-30)
    assert (outer.reference_radius, outer.tip_radius, outer.root_radius) == pytest.approx((37.5, 42.5, 31.25))
    assert (inner.reference_radius, inner.tip_radius, inner.root_radius) == pytest.approx((75.0, 70.0, 81.25))
    assert outer.base_radius == pytest.approx(37.5 * cos(ALPHA))
    assert outer.root_roll == 0.0
    assert inner.tip_roll == 0.0
    assert outer.tip_roll == pytest.approx(sqrt(42.5**2 - outer.base_radius**2) / outer.base_radius)
    assert inner.root_form_radius == 81.25
    assert inner.tip_form_radius == pytest.approx(75.0 * cos(ALPHA))


@pytest.mark.parametrize("teeth", [15, -30])
@pytest.mark.parametrize("helix_deg", [10.0, -10.0])
def test_tooth_heights_are_normal_modules_and_the_transverse_data_come_back(teeth, helix_deg):
    gear = thesis(teeth, helix_deg)
    module = 5.0 * cos(radians(10.0))
    assert gear.transverse_module == pytest.approx(5.0)
    assert gear.transverse_pressure_angle == pytest.approx(ALPHA)
    assert abs(gear.tip_radius - gear.root_radius) == pytest.approx(2.25 * module)
    assert gear.lead == pytest.approx(2.0 * pi * gear.reference_radius / tan(radians(helix_deg)))
    assert sin(gear.base_helix_angle) == pytest.approx(sin(radians(helix_deg)) * cos(gear.pressure_angle))


def test_a_spur_gear_is_the_limit_of_helical_ones():
    nearly, spur_gear = thesis(15, 1e-6), thesis(15)
    for name in ("tip_radius", "root_radius", "base_radius", "tooth_half_angle", "pressure_angle"):
        assert getattr(nearly, name) == pytest.approx(getattr(spur_gear, name), rel=1e-12)
    assert spur_gear.twist == 0.0
    assert spur_gear.lead == inf


@given(
    st.integers(12, 120), st.booleans(), st.floats(-0.5, 0.5), st.floats(0.0, 0.7), st.floats(radians(14), radians(25))
)
def test_teeth_and_spaces_at_the_reference_circle(teeth, internal, shift, helix, alpha):
    """There a basic rack is half tooth, half space, moved by the shift: (pi/2 +- 2 x tan alpha_n) m_n wide."""
    sign = -1 if internal else 1
    gear = CylindricalGear(sign * teeth, 3.0, alpha, helix, 20.0, shift, 0.5, 0.5)
    around = 2.0 * gear.reference_radius * cos(helix)
    tooth = around * gear.half_tooth(gear.reference_radius)
    space = around * gear.half_space(gear.reference_radius)
    assert float(tooth) == pytest.approx((0.5 * pi + 2.0 * shift * tan(alpha)) * 3.0)
    assert float(tooth + space) == pytest.approx(pi * 3.0)
    assert gear.tip_radius == pytest.approx(gear.reference_radius + sign * (0.5 + shift) * 3.0)
    assert sign * (gear.tip_radius - gear.root_radius) == pytest.approx(3.0)


@given(st.floats(0.0, 3.0))
def test_roll_and_radius_are_inverse(xi):
    gear = thesis(15)
    assert float(gear.roll(gear.radius(xi))) == pytest.approx(xi, abs=1e-7)
    assert float(gear.radius(xi)) * cos(atan(xi)) == pytest.approx(gear.base_radius)


def test_base_tangent_length_over_four_teeth():
    """W_k by the standard's formula and as the width of the teeth along the normal of the contact lines."""
    gear = CylindricalGear(30, 3.0, ALPHA, radians(15.0), 40.0, 0.3)
    angle = gear.transverse_pressure_angle
    inv = tan(angle) - angle
    expected = 3.0 * cos(ALPHA) * ((4 - 0.5) * pi + 30 * inv) + 2.0 * 0.3 * 3.0 * sin(ALPHA)
    # teeth 1 to 4 lie between spaces 0 and 4: their outer flanks are the right one of space 0, the left one of 4
    first, last = InvoluteFlank(gear, "right", 0), InvoluteFlank(gear, "left", 4)
    xi = np.linspace(0.05, 1.2, 20001)
    middle = 2.0 * gear.pitch_angle
    normal = np.array([sin(middle), -cos(middle), 0.0]) * cos(gear.base_helix_angle)
    normal[2] = sin(gear.base_helix_angle)
    width = np.max(first.jet(xi, 0.0).r @ normal) + np.max(last.jet(xi, 0.0).r @ -normal)
    assert width == pytest.approx(expected, abs=1e-6)


def test_measurement_over_balls():
    """A ball touches both flanks of a space where inv(a) = r / (R_b cos beta_b) - eta_b; brute force agrees."""
    gear, r = CylindricalGear(24, 2.0, ALPHA, radians(-20.0), 30.0, 0.2), 1.8
    wanted = r / (gear.base_radius * cos(gear.base_helix_angle)) - gear.space_half_angle
    low, high = 0.01, 1.2
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if tan(middle) - middle < wanted else (low, middle)
    centre = np.array([gear.base_radius / cos(low), 0.0, -15.0])
    phi = float(gear.space_centre(0, -15.0))
    centre[:2] = centre[0] * cos(phi), centre[0] * sin(phi)
    for side in SIDES:
        u, v = np.meshgrid(np.linspace(0.3, 0.7, 401), np.linspace(-16.5, -13.5, 401))
        points = InvoluteFlank(gear, side).jet(u, v).r
        assert np.min(np.linalg.norm(points - centre, axis=-1)) == pytest.approx(r, abs=1e-5)


@pytest.mark.parametrize("teeth", [20, -40])
def test_teeth_come_to_a_point_at_the_limit(teeth):
    gear = spur(teeth, profile_shift=0.3 if teeth > 0 else -1.4, addendum=0.1, dedendum=0.5)
    limit = gear.pointed_limit()
    assert float(gear.half_tooth(limit)) == pytest.approx(0.0, abs=1e-12)
    reach = gear.sign * (limit - gear.reference_radius) / 2.0 - gear.profile_shift - 0.1
    data = {"profile_shift": gear.profile_shift, "addendum": 0.1, "dedendum": 0.5}
    assert spur(teeth, **data, tip_alteration=reach - 1e-9).pointed_limit() == pytest.approx(limit)
    with pytest.raises(InputError, match=rf"come to a point.*{limit:.6g} mm.*tip_alteration must be below {reach:.6g}"):
        spur(teeth, **data, tip_alteration=reach + 1e-9)


def test_ordinary_internal_teeth_never_come_to_a_point():
    assert thesis(-30).pointed_limit() == 0.0


@pytest.mark.parametrize("teeth", [120, -40])
def test_spaces_come_to_a_point_at_the_limit(teeth):
    gear = spur(teeth)
    limit = gear.space_limit()
    assert float(gear.half_space(limit)) == pytest.approx(0.0, abs=1e-12)
    depth = abs(limit - gear.reference_radius) / 2.0
    spur(teeth, dedendum=depth - 1e-9)
    with pytest.raises(InputError, match=rf"spaces come to a point.*dedendum must be below {depth:.6g}"):
        spur(teeth, dedendum=depth + 1e-9)


def test_undercut_begins_below_17_teeth_and_at_x_min():
    assert spur(17).rack_form_roll() < 0.0 < spur(18).rack_form_roll()  # 2 / sin²(20 deg) = 17.097
    limit = spur(10).undercut_limit()
    assert limit == pytest.approx(1.0 - 10.0 * sin(ALPHA) ** 2 / 2.0)
    assert spur(10, profile_shift=limit).rack_form_roll() == pytest.approx(0.0, abs=1e-12)
    assert thesis(15).undercut_limit() > 0.0  # a finding only: an end mill does not undercut it
    assert spur(-40).undercut_limit() == -inf
    with pytest.raises(InputError, match="rack cannot generate an internal gear"):
        spur(-40).rack_form_roll()


def test_the_rack_leaves_the_flank_where_its_straight_part_ends():
    """The rack's last point meets the line of action at the depth h below the pitch point."""
    gear = spur(25, profile_shift=0.1)
    contact = np.array([gear.reference_radius - 0.9 * 2.0, 0.9 * 2.0 / tan(ALPHA)])
    assert float(gear.radius(gear.rack_form_roll())) == pytest.approx(float(np.hypot(*contact)))


IMPOSSIBLE = [
    ({"teeth": 0}, "teeth must be a whole number.*not 0"),
    ({"teeth": 15.5}, "teeth must be a whole number"),
    ({"module": 0.0}, "module must be positive"),
    ({"module": nan}, "module must be a finite number"),
    ({"facewidth": -1.0}, "facewidth must be positive"),
    ({"facewidth": inf}, "facewidth must be a finite number"),
    ({"pressure_angle": 0.0}, "pressure angle must lie between 0 and 90 deg"),
    ({"pressure_angle": 20.0}, "pressure angle must lie between 0 and 90 deg, got 1145"),
    ({"helix_angle": radians(90.0)}, "helix angle must lie between -90 and 90 deg, got 90"),
    ({"helix_angle": nan}, "helix_angle must be a finite number"),
    ({"tip_alteration": -2.3}, "tip circle lies below the root circle: .* = -0.05"),
    ({"dedendum": 8.0}, r"root radius is -1 mm: dedendum - profile_shift must be below 7.5"),
    ({"teeth": -20, "addendum": 10.5}, r"tip radius is -1 mm: .* must be below 10"),
    ({"addendum": -0.5}, "no involute flank: the tip radius 14 mm must exceed the base radius 14.09"),
    ({"teeth": -30, "dedendum": -0.95}, "no involute flank: the root radius 28.1 mm"),
    ({"profile_shift": 1.5}, "teeth come to a point"),
]


@pytest.mark.parametrize(("change", "message"), IMPOSSIBLE)
def test_impossible_gears_are_refused(change, message):
    data = {"teeth": 15, "module": 2.0, "pressure_angle": ALPHA, "helix_angle": 0.0, "facewidth": 10.0}
    with pytest.raises(InputError, match=message):
        CylindricalGear(**{**data, **change})


def test_a_transverse_angle_out_of_range_is_named_before_it_is_converted():
    with pytest.raises(InputError, match=f"helix angle must lie between -90 and 90 deg, got {degrees(2.0):g}"):
        CylindricalGear.from_transverse(15, 5.0, ALPHA, 2.0, 10.0)


def test_no_roll_inside_the_base_circle_and_no_third_side():
    with pytest.raises(InputError, match="no involute inside the base circle"):
        thesis(15).roll([40.0, 35.0])
    with pytest.raises(InputError, match="'left' or 'right'"):
        flank_sign("top")
