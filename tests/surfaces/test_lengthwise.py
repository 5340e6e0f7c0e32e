"""The lengthwise curve of a generated slot and the profiles along it, for both hands and without roll."""

from dataclasses import replace

import numpy as np
import pytest

from gearsim.geometry.series import Series
from gearsim.surfaces.lengthwise import lengthwise_curve, profile_points
from gearsim.surfaces.patch import SIDES
from tests.surfaces.test_face_milled import ROLL, SETTINGS, make_face_milled

CONE = np.linspace(54.0, 83.0, 9)


@pytest.fixture(params=["generated", "modified roll", "formate", "other hand"])
def tooth(request):
    settings = replace(SETTINGS, modified_roll=ROLL if request.param == "modified roll" else ())
    if request.param == "other hand":
        settings = replace(settings, cradle_angle=-settings.cradle_angle)
    return make_face_milled(settings, request.param != "formate")


def curve(tooth, cone, order):
    walls = tuple(tooth.flank(side) for side in SIDES)
    return lengthwise_curve(walls, tuple(w.meet(cone, np.zeros(len(cone))) for w in walls), cone, order)


def test_the_curve_lies_in_the_middle_of_the_slot_on_the_pitch_cone(tooth):
    """Both walls' points on the pitch cone stand at one turn to either side of it; frames are right-handed."""
    spine = curve(tooth, CONE, 0)
    x, y, z = spine.x.value, spine.y.value, spine.z.value
    q = spine.origin.value + np.asarray(tooth.blank.dedendum_at(CONE))[:, None] * z
    assert np.allclose(q, CONE[:, None] * x, atol=1e-10)
    assert np.allclose(np.cross(x, y), z, atol=1e-14)
    turns = []
    for side in SIDES:
        wall = tooth.flank(side)
        r = wall.jet(*wall.meet(CONE, np.zeros(len(CONE)))).r
        turns.append(np.sum(r * y, axis=1))
    assert np.allclose(turns[0], -turns[1], atol=1e-9)
    assert np.all(np.abs(turns[0]) > 0.5)


def test_all_derivatives_are_those_of_the_curve(tooth):
    here, there = curve(tooth, CONE, 7), curve(tooth, CONE + 0.2, 0)
    for a, b in zip(here[1:], there[1:], strict=True):
        assert np.allclose(np.einsum("k,kij->ij", 0.2 ** np.arange(8), a.c), b.value, atol=1e-10)


def test_profiles_lie_in_the_planes_of_the_curve_at_their_heights(tooth):
    spine, height = curve(tooth, CONE, 2), Series.variable(CONE, 2) * 0.03 + 1.0
    for side in SIDES:
        wall = tooth.flank(side)
        near = wall.meet(CONE, np.full(len(CONE), -1.0))
        found = profile_points(wall, spine, height, near)
        off = found.point - spine.origin
        for frame, wanted in ((spine.x, 0.0 * height.c), (spine.z, height.c)):
            product = sum(off.c[i] * frame.c[2 - i] for i in range(3)).sum(axis=-1)
            assert np.allclose(product, wanted[2], atol=1e-9)
            assert np.allclose((off.value * frame.value).sum(axis=1), wanted[0], atol=1e-10)


def test_the_mean_profile_starts_at_the_contact_height_and_goes_up(tooth):
    offsets = np.array([0.0, 0.5, -0.5, 3.0, -3.0])
    spine = curve(tooth, np.array([tooth.blank.mean]), 0)
    for side in SIDES:
        wall = tooth.flank(side)
        u, v, across = wall.mean_profile(4.0, offsets)
        off = wall.jet(u, v).r - spine.origin.value
        assert np.allclose(across, spine.x.value[0], atol=1e-12)
        assert np.allclose(off @ across, 0.0, atol=1e-10)
        assert np.allclose(off @ spine.z.value[0], 4.0 + offsets, atol=1e-10)
