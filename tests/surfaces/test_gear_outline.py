"""The finished gear's section and solid: closed forms against quadrature, brute force and the flanks' own normals."""

from dataclasses import replace
from math import cos, pi, radians

import numpy as np
import pytest
from scipy.spatial import cKDTree

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear
from gearsim.surfaces.finished_gear import FinishedGear
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.gear_outline import FILLET, FLANK, LAND, TIP, WALL, GearOutline
from gearsim.surfaces.gear_stock import back_radius, gear_stock
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.part import Tolerance

# teeth, helix, fillet: the root inside and outside the base circle, sharp corners, internal gears
TOLERANCES = [Tolerance.both(1.0)] * 3
CASES = [(15, 0.0, 1.9), (15, 0.2, 0.0), (50, 0.0, 1.0), (50, 0.3, 0.0), (-30, 0.0, 1.5), (-30, 0.17, 0.0)]


def outline(teeth, helix, fillet):
    return GearOutline(CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), helix, 10.0), fillet)


def solid(section, **options):
    gear = section.gear
    return FinishedGear(section, gear.root_radius - gear.sign * 15.0, *TOLERANCES, **options)


@pytest.mark.parametrize("case", CASES)
def test_the_area_is_what_quadrature_finds(case):
    section = outline(*case)
    gear, back = section.gear, solid(section).back
    radius = np.linspace(*sorted((gear.root_radius, gear.tip_radius)), 20001)
    spaces = 2.0 * gear.count * np.trapezoid(radius * section.half_angle(radius), radius)
    expected = abs(pi * gear.tip_radius**2 - pi * back**2) - spaces
    assert section.area(back) == pytest.approx(expected, rel=1e-7)
    assert solid(section).volume == pytest.approx(10.0 * expected, rel=1e-7)


@pytest.mark.parametrize("case", CASES)
def test_distances_are_those_from_a_dense_outline(case):
    section, random = outline(*case), np.random.default_rng(3)
    gear, count = section.gear, 20001
    low, high = sorted((gear.root_radius, gear.tip_radius))
    radius = np.linspace(low, high, count)
    angle = section.half_angle(radius)
    lands = [(gear.root_radius, np.linspace(0.0, section.centre[1], 2001)),
             (gear.tip_radius, np.linspace(section.tip_angle, pi / gear.count, 2001))]  # fmt: skip
    points = [_plane(radius, angle), *(_plane(r, a) for r, a in lands)]
    at, turn = random.uniform(low - 3.0, high + 3.0, 500), random.uniform(0.0, pi / gear.count, 500)
    expected, _ = cKDTree(np.concatenate(points)).query(_plane(at, turn))
    foot = section.foot(at, turn)
    assert np.abs(foot.distance) == pytest.approx(expected, abs=3e-3)
    assert (np.abs(foot.distance) <= expected + 1e-12).all()
    assert ((foot.distance < 0.0) == section.holds(at, turn)).all()
    assert {LAND, FLANK, TIP} <= set(foot.piece.tolist())


def _plane(radius, angle):
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)


def test_pieces_meet_tangentially_and_are_found_where_they_stand():
    """By hand: 31.25 + 1.9 = 33.15 mm; sqrt(33.15² - 1.9²) = 33.0955 mm; asin(1.9 / 33.15) off the wall."""
    section = outline(15, 0.0, 1.9)
    assert section.centre[0] == pytest.approx(33.15)
    assert section.form_radius == pytest.approx(33.0955, abs=1e-4)
    assert section.form_roll == 0.0
    assert section.gear.space_half_angle - section.centre[1] == pytest.approx(np.arcsin(1.9 / 33.15))
    for edge in (section.form_radius, section.gear.base_radius):
        before, after = section.half_angle(edge + np.array([-1e-6, 1e-6]))
        assert before == pytest.approx(after, abs=1e-8)
    radius = np.array([31.25, 31.25, 31.8, 34.0, 38.0, 42.5])
    angle = np.array([0.0, 0.01, *section.half_angle(radius[2:5]), pi / 15])
    foot = section.foot(radius, angle)
    assert foot.distance == pytest.approx(np.zeros(6), abs=1e-12)
    assert foot.piece.tolist() == [LAND, LAND, FILLET, WALL, FLANK, TIP]


@pytest.mark.parametrize("teeth", [15, 50, -30])
@pytest.mark.parametrize("helix", [0.0, 0.3])
def test_off_a_flank_along_its_normal_the_distance_is_exact(teeth, helix):
    gear = CylindricalGear.from_transverse(teeth, 5.0, radians(20.0), helix, 10.0)
    section = GearOutline(gear)
    for number, side in enumerate(SIDES):
        flank = InvoluteFlank(gear, side, space=3)
        roll = np.linspace(*sorted((max(section.form_roll, 0.1), gear.tip_roll)), 7)[1:-1]
        jet = flank.jet(roll, np.linspace(-8.0, -2.0, 5))
        for off in (-0.2, 0.0, 0.1):
            distance, face = solid(section).by_face(jet.r + off * jet.normal)
            assert distance == pytest.approx(np.full(5, off), abs=1e-12)
            assert (face == number).all()


def test_a_design_is_part_of_the_flank():
    gear = CylindricalGear.from_transverse(15, 5.0, radians(20.0), 0.1, 10.0)
    design = FlankModification(profile_slope=0.02, helix_crowning=0.01)
    flank = InvoluteFlank(gear, "left", modification=design)
    jet = flank.jet(np.array([0.2, 0.5]), np.array([-2.0, -7.0]))
    distance, _ = solid(GearOutline(gear), design=design).by_face(jet.r)
    assert distance == pytest.approx(np.zeros(2), abs=2e-7)  # the slope's square: 20 um * 0.0025²


def test_every_face_has_its_name_and_its_place():
    gear = outline(15, 0.0, 1.9)
    whole = solid(gear)
    tooth, wall = pi / 15, float(gear.half_angle(np.array(38.0)))
    flank = [[38.0 * cos(a), 38.0 * np.sin(a), -5.0] for a in (-wall, wall)]
    tip, top = [42.5 * cos(tooth), 42.5 * np.sin(tooth), -5.0], [20.0, 0.0, 0.0]
    points = np.array([*flank, [31.25, 0.0, -5.0], tip, top, [0.0, 20.0, -10.0], [0.0, -16.25, -5.0]])
    distance, face = whole.by_face(points)
    assert [list(whole.tolerances)[k] for k in face] == list(whole.tolerances)
    assert distance == pytest.approx(np.zeros(7), abs=1e-12)
    out = np.array([[31.25 + 0.01, 0.0, -5.0], [31.25 - 0.01, 0.0, -5.0], [20.0, 0.0, 0.02], [20.0, 0.0, -0.02]])
    assert whole.signed_distance(out) == pytest.approx([0.01, -0.01, 0.02, -0.02])


@pytest.mark.parametrize("rim", [31.25, 40.0])
def test_a_rim_that_reaches_to_the_axis_leaves_no_bore(rim):
    section = outline(15, 0.0, 1.9)
    assert back_radius(section.gear, rim) == 0.0
    whole, disc = FinishedGear(section, 0.0, *TOLERANCES), gear_stock(section.gear, rim)
    assert list(whole.tolerances)[-1] == "bottom face"
    assert whole.volume == pytest.approx(FinishedGear(section, 10.0, *TOLERANCES).volume + pi * 10.0**3)
    assert disc.volume == pytest.approx(pi * 42.5**2 * 10.0)
    distance, face = whole.by_face(np.array([[0.0, 0.0, -4.0]]))
    assert (distance[0], list(whole.tolerances)[face[0]]) == (-4.0, "top face")


@pytest.mark.parametrize("teeth", [15, 50, -30])
def test_a_fillet_that_does_not_fit_is_told_with_the_largest_that_does(teeth):
    section = outline(teeth, 0.0, 0.0)
    with pytest.raises(InputError, match="it must be below") as told:
        replace(section, fillet=4.9)
    largest = float(str(told.value).rsplit(" ", 1)[1])
    assert GearOutline(section.gear, largest - 1e-3).centre[1] < 1e-3
    with pytest.raises(InputError, match="must be below"):
        GearOutline(section.gear, largest + 1e-3)
    with pytest.raises(InputError, match="0 or more, got -1"):
        GearOutline(section.gear, -1.0)
