from math import cos, inf, radians

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.flank_modification import FlankModification, Relief
from gearsim.surfaces.involute import InvoluteFlank

GEARS = [
    CylindricalGear.from_transverse(z, 5.0, radians(20.0), radians(beta), 10.0)
    for z, beta in ((15, 0.0), (15, -10.0), (-30, 0.0), (-30, 10.0))
]
EVERYTHING = FlankModification(Relief(0.03, 0.35, 2), Relief(0.02, 0.3, 2), 0.006, 0.005, -0.004, 0.008)
EXAGGERATED = FlankModification(profile_slope=0.3, profile_crowning=0.4, helix_slope=0.5, helix_crowning=0.6)


def shift(gear, modification, u, v):
    """Distance along the pure flank's normal, from the points alone."""
    pure, ours = (InvoluteFlank(gear, "right", 0, m).jet(u, v) for m in (None, modification))
    moved = ours.r - pure.r
    along = np.sum(moved * pure.normal, axis=-1)
    assert np.allclose(moved, along[..., None] * pure.normal, atol=1e-14)
    return along


@pytest.mark.parametrize("gear", GEARS)
def test_amounts_stand_where_they_are_stated(gear):
    flank = InvoluteFlank(gear, "right")
    ends = flank.locate(np.array([0.0, 0.0, 0.5, 1.0]), np.array([0.0, 1.0, 0.5, 0.5]))
    root, tip, centre, bottom = range(4)
    start = float(0.5 * (gear.root_roll + gear.tip_roll))

    def only(**amounts):
        return shift(gear, FlankModification(**amounts), *ends) * 1e3

    assert only(profile_slope=0.01)[[root, tip, centre]] == pytest.approx([0.0, 10.0, 5.0])
    assert only(profile_crowning=0.01)[[root, tip, centre]] == pytest.approx([-10.0, -10.0, 0.0])
    assert only(helix_slope=0.01)[[root, centre, bottom]] == pytest.approx([0.0, 5.0, 10.0])
    assert only(helix_crowning=0.01)[[root, centre, bottom]] == pytest.approx([-10.0, 0.0, -10.0])
    assert only(tip_relief=Relief(0.01, start))[[root, tip, centre]] == pytest.approx([0.0, -10.0, 0.0])
    assert only(root_relief=Relief(0.01, start, 2))[[root, tip, centre]] == pytest.approx([-10.0, 0.0, 0.0])


def test_linear_and_parabolic_relief_halfway():
    gear = GEARS[0]
    half = np.array([0.5 * (0.4 + gear.tip_roll)])
    for power, part in ((1, 0.5), (2, 0.25)):
        relief = FlankModification(tip_relief=Relief(0.02, 0.4, power))
        assert shift(gear, relief, half, np.array([-5.0])) == pytest.approx([-0.02 * part])
        assert shift(gear, relief, np.array([0.39]), np.array([-5.0])) == pytest.approx([0.0])


@pytest.mark.parametrize("modification", [EVERYTHING, EXAGGERATED])
@pytest.mark.parametrize("gear", GEARS)
@pytest.mark.parametrize("side", SIDES)
def test_jets_are_the_derivatives_of_the_points(gear, side, modification, rng):
    """Sixth-order central differences; the normal is that of the modified surface, on the side of the pure one."""
    flank = InvoluteFlank(gear, side, 2, modification)
    u, v, h = rng.uniform(0.1, 0.55, 60), rng.uniform(-10.0, 0.0, 60), 5e-3
    away = (np.abs(u - 0.35) > 4.0 * h) & (np.abs(u - 0.3) > 4.0 * h)
    u, v = u[away], v[away]
    jet = flank.jet(u, v)
    weights, steps = np.array([-1, 9, -45, 0, 45, -9, 1]) / 60.0, h * np.arange(-3, 4)
    for name, of, du, dv in (
        ("ru", "r", 1, 0), ("rv", "r", 0, 1), ("ruu", "ru", 1, 0), ("ruv", "rv", 1, 0), ("rvv", "rv", 0, 1),
    ):  # fmt: skip
        found = sum(
            w * getattr(flank.jet(u + s * du, v + s * dv), of) for w, s in zip(weights, steps, strict=True)
        ) / h  # fmt: skip
        assert np.allclose(found, getattr(jet, name), rtol=0.0, atol=2e-10), name
    across = np.cross(jet.ru, jet.rv)
    across /= np.linalg.norm(across, axis=1, keepdims=True)
    pure = InvoluteFlank(gear, side, 2).jet(u, v).normal
    across *= np.sign(np.sum(across * pure, axis=1))[:, None]
    assert np.allclose(across, jet.normal, atol=1e-13)


def test_no_amounts_leave_the_pure_flank_and_its_normal_at_the_base_circle():
    gear = GEARS[1]
    u, v = np.array([0.0, 0.4]), np.array([-3.0, -3.0])
    pure, ours = (InvoluteFlank(gear, "left", 0, m).jet(u, v) for m in (None, FlankModification()))
    for name in ("r", "ru", "rv", "ruu", "ruv", "rvv", "normal"):
        assert np.allclose(getattr(pure, name), getattr(ours, name), atol=1e-15)


def test_a_transverse_deviation_is_the_normal_one_over_the_cosine():
    """The trace of a flank shifted by a constant crosses the transverse normal at delta / cos(beta_b)."""
    gear = CylindricalGear.from_transverse(15, 5.0, radians(20.0), radians(25.0), 10.0)
    delta = 0.01
    lift = FlankModification(helix_slope=delta)  # at the bottom face, and beyond it, all but constant
    flank, pure = (InvoluteFlank(gear, "right", 0, m) for m in (lift, None))
    point = pure.jet(np.array([0.4]), np.array([-10.0]))
    n = point.normal[0]
    across = np.array([n[0], n[1], 0.0]) / np.hypot(n[0], n[1])
    u, v = np.meshgrid(np.linspace(0.399, 0.401, 5), np.linspace(-10.02, -9.98, 5))
    shifted = flank.jet(u, v)
    # the tangent plane of the modified flank over the point, met by the transverse normal
    middle = shifted.r[2, 2], shifted.normal[2, 2]
    distance = np.dot(middle[0] - point.r[0], middle[1]) / np.dot(across, middle[1])
    assert distance == pytest.approx(delta / cos(gear.base_helix_angle), rel=2e-3)


@pytest.mark.parametrize(
    ("amounts", "message"),
    [
        ({"profile_slope": inf}, "profile_slope must be of finite numbers"),
        ({"tip_relief": Relief(0.01, float("nan"))}, "tip_relief must be of finite numbers"),
        ({"root_relief": Relief(0.01, 0.2, 3)}, "root_relief must be linear .* or parabolic .*, got power 3"),
        (
            {"tip_relief": Relief(0.01, 0.9)},
            "tip_relief must start within .* roll, 0 to 0.674241 rad, got 0.9",
        ),
    ],
)
def test_what_cannot_be_is_refused(amounts, message):
    with pytest.raises(InputError, match=message):
        InvoluteFlank(GEARS[0], "left", 0, FlankModification(**amounts))
