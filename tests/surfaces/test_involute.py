from math import cos, pi, radians, sin, tan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, flank_sign
from gearsim.surfaces.involute import InvoluteFlank

ALPHA = radians(20.0)
WEIGHTS = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])


def thesis(teeth, helix_deg=0.0, **rest):
    """Groover's test gears, tables 5.3 to 5.6."""
    return CylindricalGear.from_transverse(teeth, 5.0, ALPHA, radians(helix_deg), 10.0, **rest)


GEARS = [thesis(z, beta) for z in (15, -30) for beta in (0.0, 10.0, -10.0)]
FLANKS = [InvoluteFlank(gear, side, 3) for gear in GEARS for side in SIDES]


def ident(flank):
    return f"{flank.side} z={flank.gear.teeth} {np.degrees(flank.gear.helix_angle):g} deg"


def along(function, u, v, du, dv, h=0.02):
    """Eighth-order central difference of a function of (u, v)."""
    steps = h * np.arange(-4, 5)
    return sum(w * function(u + s * du, v + s * dv) for w, s in zip(WEIGHTS, steps, strict=True)) / h


@pytest.mark.parametrize("flank", FLANKS, ids=ident)
def test_jets_are_the_derivatives_of_the_points(flank, rng):
    u, v = rng.uniform(0.1, 0.6, 40), rng.uniform(-10.0, 0.0, 40)
    jet = flank.jet(u, v)
    for name, of, du, dv in (
        ("ru", "r", 1, 0), ("rv", "r", 0, 1), ("ruu", "ru", 1, 0), ("ruv", "ru", 0, 1), ("rvv", "rv", 0, 1),
    ):  # fmt: skip
        found = along(lambda a, b, of=of: getattr(flank.jet(a, b), of), u, v, du, dv)
        assert np.allclose(found, getattr(jet, name), rtol=0.0, atol=2e-11), name


@pytest.mark.parametrize("flank", FLANKS, ids=ident)
def test_normals_leave_the_tooth_and_hold_at_the_base_circle(flank):
    """A small step along n enters the space: its angle from the space's middle shrinks against the half space."""
    gear = flank.gear
    u, v = np.array([0.0, 0.1, 0.3, 0.55]), np.array([-1.0, -4.0, -7.0, -10.0])
    jet = flank.jet(u, v)
    assert np.allclose(np.linalg.norm(jet.normal, axis=1), 1.0)
    assert np.allclose([np.sum(jet.normal * t, axis=1) for t in (jet.ru, jet.rv)], 0.0, atol=1e-13)
    moved = jet.r[1:] + 1e-4 * jet.normal[1:]
    radius = np.hypot(moved[:, 0], moved[:, 1])
    turn = np.angle(np.exp(1j * (np.arctan2(moved[:, 1], moved[:, 0]) - gear.space_centre(3, moved[:, 2]))))
    gap = (gear.half_space(radius) - np.abs(turn)) * gear.base_radius * cos(gear.base_helix_angle)
    assert np.allclose(gap, 1e-4, rtol=1e-3)


@pytest.mark.parametrize("flank", FLANKS, ids=ident)
def test_flanks_are_developable_bent_as_the_tangent_to_the_base_circle(flank, rng):
    u, v = rng.uniform(0.05, 0.6, 50), rng.uniform(-10.0, 0.0, 50)
    jet, gear = flank.jet(u, v), flank.gear
    bent = -gear.sign * cos(gear.base_helix_angle) / (gear.base_radius * u)
    found = jet.curvature()
    other = found.k2 if gear.is_internal else found.k1
    assert np.allclose(other, 0.0, atol=1e-14)
    assert np.allclose(found.k1 + found.k2, bent, rtol=1e-12)
    straight = found.direction2 if gear.is_internal else found.direction1
    assert np.allclose(np.abs(np.sum(straight * flank.axis(u, v), axis=1)), 1.0)


def rack_distance(gear, points, turn):
    """Distance of points, (n, 3), to the right flank of a rack tooth that fills space 0, the gear turned by ``turn``.

    The plane y = R eta + (x - R) tan(alpha_t) + z tan(beta) + R turn; positive on the side of the gear's material.
    """
    R, alpha, beta = gear.reference_radius, gear.transverse_pressure_angle, gear.helix_angle
    eta = (pi - 4.0 * gear.profile_shift * tan(gear.pressure_angle)) / (2.0 * gear.count)
    c, s = np.cos(turn), np.sin(turn)
    x, y = c * points[:, 0] - s * points[:, 1], s * points[:, 0] + c * points[:, 1]
    plane = R * (eta + turn) + (x - R) * tan(alpha) + points[:, 2] * tan(beta)
    return (y - plane) / np.sqrt(1.0 + tan(alpha) ** 2 + tan(beta) ** 2)


@pytest.mark.parametrize("helix_deg", [0.0, 25.0, -25.0])
def test_an_external_flank_is_the_envelope_of_the_basic_rack(helix_deg, rng):
    gear = CylindricalGear(30, 3.0, ALPHA, radians(helix_deg), 20.0, 0.25)
    points = InvoluteFlank(gear, "right").jet(rng.uniform(0.15, 0.55, 25), rng.uniform(-20.0, 0.0, 25)).r
    turns = np.linspace(-0.4, 0.4, 1601)  # of each point's own section; the plane meets far points again
    distances = np.stack([rack_distance(gear, points, t - points[:, 2] * 2.0 * pi / gear.lead) for t in turns])
    least = np.argmin(distances, axis=0)
    assert np.all((least > 0) & (least < len(turns) - 1))
    below, here, above = (distances[least + k, np.arange(25)] for k in (-1, 0, 1))
    touching = here - (above - below) ** 2 / (8.0 * (above - 2.0 * here + below))
    assert np.allclose(touching, 0.0, atol=1e-8)


@pytest.mark.parametrize("helix_deg", [0.0, 10.0, -10.0])
def test_an_internal_space_is_the_tooth_of_an_external_gear(helix_deg, rng):
    """Shift reversed, turned by half a pitch; the material is on the other side."""
    inner, outer = thesis(-30, helix_deg, profile_shift=0.2), thesis(30, helix_deg, profile_shift=-0.2)
    u, v = rng.uniform(0.0, 0.5, 20), rng.uniform(-10.0, 0.0, 20)
    c, s = cos(pi / 30.0), sin(pi / 30.0)
    turn = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    for side, space in (("right", 0), ("left", 1)):  # the tooth between the outer gear's spaces 0 and 1
        ours, theirs = InvoluteFlank(inner, side).jet(u, v), InvoluteFlank(outer, side, space).jet(u, v)
        assert np.allclose(ours.r, theirs.r @ turn.T, atol=1e-12)
        assert np.allclose(ours.normal, -theirs.normal @ turn.T, atol=1e-13)


@given(
    st.sampled_from([18, 60, -30, -75]), st.floats(-0.6, 0.6), st.floats(-0.2, 0.2),
    st.floats(0.05, 0.5), st.floats(-10.0, 0.0),
)  # fmt: skip
@settings(max_examples=40)
def test_symmetries(teeth, helix, shift, xi, z):
    gear = CylindricalGear(teeth, 2.0, ALPHA, helix, 10.0, shift, 0.8, 0.9)
    right = InvoluteFlank(gear, "right").jet(xi, z)
    mirror = np.array([1.0, -1.0, 1.0])
    other_hand = CylindricalGear(teeth, 2.0, ALPHA, -helix, 10.0, shift, 0.8, 0.9)
    left = InvoluteFlank(other_hand, "left").jet(xi, z)
    assert np.allclose(left.r, mirror * right.r)
    assert np.allclose(left.normal, mirror * right.normal)
    screwed = InvoluteFlank(gear, "right").jet(xi, z - 3.0).r
    turn = np.exp(-3j * gear.twist) * complex(right.r[0], right.r[1])
    assert np.allclose(screwed, [turn.real, turn.imag, z - 3.0])
    pitch = np.exp(1j * gear.pitch_angle) * complex(right.r[0], right.r[1])
    assert np.allclose(InvoluteFlank(gear, "right", 1).jet(xi, z).r[:2], [pitch.real, pitch.imag])


@pytest.mark.parametrize("flank", FLANKS, ids=ident)
def test_points_lie_half_a_space_from_its_middle(flank):
    gear = flank.gear
    r = flank.jet(np.array([0.2, 0.5]), np.array([-2.0, -9.0])).r
    turn = np.arctan2(r[:, 1], r[:, 0]) - gear.space_centre(3, r[:, 2])
    half = gear.half_space(np.hypot(r[:, 0], r[:, 1]))
    assert np.allclose(np.angle(np.exp(1j * turn)), gear.sign * flank_sign(flank.side) * half)


def test_helical_flanks_go_over_into_spur_ones():
    u, v = np.array([0.1, 0.5]), np.array([-1.0, -9.0])
    flat, bent = (InvoluteFlank(thesis(-30, beta), "left").jet(u, v) for beta in (0.0, 1e-5))
    assert np.allclose(flat.r, bent.r, atol=1e-5)
    assert np.allclose(flat.normal, bent.normal, atol=1e-6)


@pytest.mark.parametrize("flank", FLANKS, ids=ident)
def test_locate_runs_from_the_top_face_down_and_from_the_root_to_the_tip(flank):
    gear = flank.gear
    u, v = flank.locate(np.array([0.0, 1.0]), np.array([0.0, 1.0]))
    assert v.tolist() == [0.0, -10.0]
    assert u.tolist() == pytest.approx([gear.root_roll, gear.tip_roll])
    assert flank.limits == (min(u), max(u))
    assert gear.sign * (u[1] - u[0]) > 0.0


@pytest.mark.parametrize("flank", FLANKS, ids=ident)
def test_windows_end_in_the_middle_of_tooth_and_space(flank):
    gear = flank.gear
    u, v = np.array([0.15, 0.3, 0.5]), np.array([-2.0, -5.0, -8.0])
    inward, outward = flank.windows(u, v)
    jet = flank.jet(u, v)
    tooth = gear.sign * flank_sign(flank.side) * pi / gear.count
    for reach, middle in ((outward, 0.0), (-inward, tooth)):
        end = jet.r + reach[:, None] * jet.normal
        turn = np.arctan2(end[:, 1], end[:, 0]) - gear.space_centre(3, end[:, 2]) - middle
        assert np.allclose(np.angle(np.exp(1j * turn)), 0.0, atol=2e-5)


def test_spaces_and_sides_that_are_not_there_are_refused():
    with pytest.raises(InputError, match="space must be one of 0 to 14, got 15"):
        InvoluteFlank(thesis(15), "left", 15)
    with pytest.raises(InputError, match="'left' or 'right'"):
        InvoluteFlank(thesis(15), "top")


def test_windows_stay_positive_where_the_normal_never_meets_the_middle_of_the_space():
    """Three teeth: at the tip the normal runs beside the space's middle."""
    gear = CylindricalGear(3, 5.0, radians(20.0))
    flank = InvoluteFlank(gear, "right")
    u = np.linspace(0.05, gear.tip_roll, 50)
    inward, outward = flank.windows(u, np.zeros(50))
    assert np.all(inward > 0.0)
    assert np.all(outward > 0.0)
