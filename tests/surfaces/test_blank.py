from math import atan, degrees, radians, sin

import numpy as np
import pytest

from gearsim.errors import InputError
from gearsim.surfaces.blank import BevelBlank, outer_cone_distance, pitch_angle


def test_derived_dimensions_of_the_worked_example(tooth):
    """Values derived by hand from Zhou's table 3.3 (errata, "not given in the thesis")."""
    blank = tooth.blank
    assert degrees(blank.pitch) == pytest.approx(degrees(atan(33.0 / 9.0)), abs=1e-12)
    assert degrees(blank.pitch) == pytest.approx(74.7449, abs=5e-5)
    assert blank.cone_distance == pytest.approx(4.8338 * 33 / (2.0 * sin(blank.pitch)), abs=1e-12)
    assert (blank.cone_distance, blank.mean) == pytest.approx((82.6707, 68.9207), abs=5e-5)
    assert blank.clearance == pytest.approx(blank.whole_depth_at(blank.mean) / 9.0, abs=5e-5)


def test_apex_distances_agree_with_lines_through_the_blank_points(tooth):
    """Zhou 3.29 and figure 3.11, from the points of table 3.2 in the axial plane instead of the formula."""
    blank = tooth.blank
    heel, toe = blank.cone_distance, blank.toe

    def crossing(height_heel, height_toe):
        r, z = blank.axial(np.array([heel, toe]), np.array([height_heel, height_toe]))
        return z[0] - r[0] * (z[1] - z[0]) / (r[1] - r[0])

    root = crossing(-blank.dedendum, -blank.dedendum_at(toe))
    face = crossing(blank.addendum, blank.addendum_at(toe))
    assert blank.root_apex == pytest.approx(-root, abs=1e-10)
    assert blank.face_apex == pytest.approx(face, abs=1e-10)
    assert (blank.root_apex, blank.face_apex) == pytest.approx((-0.2150, 0.2262), abs=1.5e-4)


def test_root_cone_is_parallel_to_the_mates_face_cone(tooth):
    pinion = tooth.blank.mate(9)
    assert degrees(pinion.pitch) == pytest.approx(90.0 - 74.7449, abs=5e-5)
    assert pinion.face_angle - pinion.pitch == pytest.approx(tooth.blank.pitch - tooth.blank.root_angle)
    for cone in (tooth.blank.toe, tooth.blank.cone_distance):
        assert tooth.blank.dedendum_at(cone) - pinion.addendum_at(cone) == pytest.approx(tooth.blank.clearance)
        assert pinion.dedendum_at(cone) - tooth.blank.addendum_at(cone) == pytest.approx(tooth.blank.clearance)


def test_cone_and_height_are_the_axial_plane_turned_by_the_pitch_angle(tooth, rng):
    cone, height, angle = rng.uniform(40, 90, 50), rng.uniform(-9, 3, 50), rng.uniform(0, 6, 50)
    r, z = tooth.blank.axial(cone, height)
    points = np.column_stack([r * np.cos(angle), r * np.sin(angle), z])
    back = tooth.blank.cone_height(points)
    assert np.allclose(back[0], cone)
    assert np.allclose(back[1], height)


def test_stock_holds_the_tooth_and_ends_at_its_cones(tooth):
    blank = tooth.blank
    for cone, inside in ((blank.toe - 0.01, False), (blank.toe + 0.01, True), (blank.cone_distance + 0.01, False)):
        r, z = blank.axial(np.array([cone]), np.array([-1.0]))
        assert blank.stock.contains(np.column_stack([r, 0 * r, z]))[0] == inside
    for height, inside in ((blank.addendum_at(blank.mean) + 0.01, False), (0.0, True)):
        r, z = blank.axial(np.array([blank.mean]), np.array([height]))
        assert blank.stock.contains(np.column_stack([0 * r, r, z]))[0] == inside


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"face_width": 90.0}, "face width 90 mm"),
        ({"face_angle": 1.0}, "must rise in this order"),
        ({"root_angle": radians(30.0)}, "vanishes at the toe"),
        ({"clearance": 30.0}, "clearance 30 mm"),
    ],
)
def test_impossible_blanks_are_refused(changes, message):
    pitch = pitch_angle(33, 9, radians(90.0))
    values = {
        "teeth": 33, "pitch": pitch, "cone_distance": outer_cone_distance(4.8338, 33, pitch), "face_width": 27.5,
        "addendum": 1.76, "dedendum": 7.67, "face_angle": radians(76.1167), "root_angle": radians(69.5833),
        "clearance": 0.87, "rim": 8.0,
    }  # fmt: skip
    with pytest.raises(InputError, match=message):
        BevelBlank(**{**values, **changes})


def test_a_rim_through_the_axis_is_refused(tooth):
    from dataclasses import replace

    with pytest.raises(InputError, match=r"rim 400 mm .* below"):
        _ = replace(tooth.blank, rim=400.0).stock
