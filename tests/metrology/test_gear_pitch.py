"""Pitch and runout of gears displaced as a whole, flank by flank, or by known angles."""

from math import cos, pi, radians, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.metrology.gear_pitch import pitch_deviations, runout
from gearsim.surfaces.cylindrical_gear import CylindricalGear

GEARS = [(15, 0.0), (15, 10.0), (15, -10.0), (-30, 0.0), (-30, 10.0)]


@pytest.fixture(params=GEARS, ids=[f"z={z}, beta={beta:g}" for z, beta in GEARS])
def gear(request):
    teeth, helix_deg = request.param
    return CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), radians(helix_deg), 10.0)


def normals(gear, side, radius, z=-5.0):
    """Points and normals out of the material of every flank at a circle, shape (|z|, 3)."""
    f, s, beta_b = (1 if side == "right" else -1), gear.sign, gear.base_helix_angle
    xi = np.sqrt((radius / gear.base_radius) ** 2 - 1.0)
    theta = f * xi + 2.0 * pi * np.arange(gear.count) / gear.count + gear.twist * z + s * f * gear.space_half_angle
    point = gear.base_radius * np.array(
        [np.cos(theta) + f * xi * np.sin(theta), np.sin(theta) - f * xi * np.cos(theta), 0.0 * theta]
    )
    across = np.array([np.sin(theta) * cos(beta_b), -np.cos(theta) * cos(beta_b), 0.0 * theta + sin(beta_b)])
    return point.T, f * s * across.T


def turned(gear, side, radius, angles):
    """Normal deviations [mm] of flanks turned counter-clockwise by small angles."""
    point, normal = normals(gear, side, radius)
    c, s = np.cos(angles), np.sin(angles)
    x, y = c * point[:, 0] - s * point[:, 1], s * point[:, 0] + c * point[:, 1]
    return (x - point[:, 0]) * normal[:, 0] + (y - point[:, 1]) * normal[:, 1]


@pytest.mark.parametrize("side", ["left", "right"])
@pytest.mark.parametrize("radius", [None, 39.0, 73.0])
def test_turned_flanks_come_back_as_arcs(gear, side, radius):
    if radius is not None and not gear.base_radius < radius < gear.base_radius + 8.0:
        pytest.skip("no involute at this circle")
    arcs_um = np.random.default_rng(3).normal(scale=5.0, size=gear.count)
    r = radius or gear.reference_radius
    found = pitch_deviations(gear, side, turned(gear, side, r, 1e-3 * arcs_um / r), radius)
    assert found.cumulative_um == pytest.approx(arcs_um - arcs_um[0], abs=5e-3)
    assert found.single_um == pytest.approx(arcs_um - np.roll(arcs_um, 1), abs=5e-3)
    assert found.single_um.sum() == pytest.approx(0.0, abs=1e-9)
    assert found.single == pytest.approx(np.abs(arcs_um - np.roll(arcs_um, 1)).max(), abs=5e-3)
    assert found.total == pytest.approx(np.ptp(arcs_um), abs=5e-3)
    assert found.complete


def test_one_flank_out_of_place_makes_two_pitch_errors(gear):
    angles = np.zeros(gear.count)
    angles[4] = 8e-3 / gear.reference_radius
    found = pitch_deviations(gear, "right", turned(gear, "right", gear.reference_radius, angles))
    expected = np.zeros(gear.count)
    expected[4], expected[5] = 8.0, -8.0
    assert found.single_um == pytest.approx(expected, abs=2e-3)
    assert (found.single, found.total) == pytest.approx((8.0, 8.0), abs=2e-3)


@pytest.mark.parametrize("side", ["left", "right"])
def test_eccentricity_makes_a_sine_of_the_pitch(gear, side):
    """Flanks shifted by e: F_pi is a sine of amplitude e / cos alpha_t, single pitches one of 2 sin(pi/|z|) times it.

    With |z| flanks the largest and smallest lie within half a pitch of the sine's crests.
    """
    e = np.array([0.006, 0.008, 0.0])
    found = pitch_deviations(gear, side, normals(gear, side, gear.reference_radius)[1] @ e)
    amplitude = 10.0 / cos(radians(20.0))
    shift = found.cumulative_um - found.cumulative_um.mean()
    assert np.sqrt(2.0 * np.mean(shift**2)) == pytest.approx(amplitude)
    assert np.sqrt(2.0 * np.mean(found.single_um**2)) == pytest.approx(2.0 * amplitude * sin(pi / gear.count))
    assert 2.0 * amplitude * cos(pi / gear.count) <= found.total <= 2.0 * amplitude


def test_eccentricity_makes_a_runout_of_twice_its_size(gear):
    e = np.array([0.006, 0.008, 0.0])
    left, right = (normals(gear, side, gear.reference_radius)[1] @ e for side in ("left", "right"))
    found = runout(gear, left, right)
    middle = gear.space_centre(np.arange(gear.count), -5.0)
    assert found.radial_um == pytest.approx(1e3 * (e[0] * np.cos(middle) + e[1] * np.sin(middle)), abs=1e-9)
    assert 20.0 * cos(pi / gear.count) <= found.total <= 20.0


def test_a_ball_is_pushed_out_of_a_narrow_space():
    """Brute force: a ball between two flanks that stand 10 um proud along their normals (spur, transverse)."""
    gear = CylindricalGear(teeth=15, module=5.0, pressure_angle=radians(20.0))
    point, normal = (a[0] for a in normals(gear, "right", gear.reference_radius, 0.0))
    ball = point[1] / -normal[1]  # from the flank along its normal to the middle of the space, y = 0
    centre = point[0] + ball * normal[0]
    # the flank's tangent line moved by 10 um: the ball touches it where (c, 0) - point = (ball + 0.010) along n
    moved = (ball + 0.010 + normal[0] * point[0] + normal[1] * point[1]) / normal[0]
    narrow = np.full(15, 0.010)
    assert runout(gear, narrow, narrow).radial_um == pytest.approx(1e3 * (moved - centre))
    assert runout(gear, narrow, narrow).total == pytest.approx(0.0, abs=1e-9)
    assert runout(gear, narrow, -narrow).radial_um == pytest.approx(0.0)


def test_an_unmeasured_flank_leaves_the_pitch_unknown(gear):
    deviation = np.zeros(gear.count)
    deviation[3] = np.nan
    found = pitch_deviations(gear, "left", deviation)
    assert not found.complete
    assert np.isnan([found.single, found.total]).all()
    with pytest.raises(InputError, match=rf"left flanks: deviations have shape \(3,\), expected \({gear.count},\)"):
        pitch_deviations(gear, "left", np.zeros(3))
