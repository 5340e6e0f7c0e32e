"""Contacts of cutters against their own signed distance: place, normal, curvature; limits at the ends."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gearsim.cutters.catalogue import apt, ball, barrel, bull, flat, lollipop, oval, tapered, tapered_ball
from gearsim.cutters.contact import approach, contact_at, end_mill_contact, locate
from gearsim.errors import InputError

ROUND = [bull(20.0, 2.0, 50.0), ball(12.0, 40.0), tapered_ball(6.0, 0.2, 40.0), barrel(10.0, 60.0, 15.0, 30.0, 2.0),
         oval(12.0, 80.0, 3.0, 40.0)]  # fmt: skip
SHARP = [flat(20.0, 50.0), tapered(6.0, 0.2, 40.0), apt(20.0, 0.0, 0.0, 0.0, 0.3, 0.0, 40.0)]


def random_directions(count, seed):
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def gradient(cutter, tip, axis, point):
    """Signed distance and its gradient in space, by the profile."""
    d = point - tip
    z = np.sum(d * axis, axis=-1)
    across = d - z[..., None] * axis
    r = np.linalg.norm(across, axis=-1)
    distance, nr, nz = cutter.distance_gradient(r, z)
    return distance, nr[..., None] * across / np.where(r > 0.0, r, 1.0)[..., None] + nz[..., None] * axis


@pytest.mark.parametrize("cutter", ROUND + SHARP, ids=lambda c: c.name)
@pytest.mark.parametrize("tilted", [False, True])
def test_a_located_cutter_touches_the_contact_with_its_normal(cutter, tilted):
    normals, points = random_directions(400, 1), 30.0 * random_directions(400, 2)
    axes = random_directions(400, 3) if tilted else np.array([0.0, 0.0, 1.0])
    tip = locate(cutter, points, normals, axes).tip
    assert np.max(np.abs(gradient(cutter, tip, axes, points)[0])) < 1e-12
    distance, outward = gradient(cutter, tip, axes, points - 1e-3 * normals)  # a sharp edge has no normal of its own
    assert np.max(np.abs(distance - 1e-3)) < 1e-12
    assert np.max(np.abs(outward + normals)) < 1e-10


def test_where_normal_and_axis_agree_the_caller_chooses_the_side():
    cutter, up = bull(20.0, 2.0, 50.0), np.array([[0.0, 0.0, 1.0]])
    tip = locate(cutter, np.zeros((1, 3)), up, toward=(0.0, 3.0, 7.0)).tip
    assert np.allclose(tip, [[0.0, -8.0, 0.0]])
    assert np.allclose(locate(ball(10.0, 30.0), np.zeros((1, 3)), up).tip, 0.0)


@pytest.mark.parametrize("cutter", ROUND, ids=lambda c: c.name)
def test_curvatures_are_the_changes_of_the_distances_gradient(cutter):
    normals = random_directions(300, 4)
    normals = normals[(normals[:, 2] > 0.05) & (normals[:, 2] < 0.99)]
    axis, points = np.array([0.0, 0.0, 1.0]), np.zeros_like(normals)
    place = locate(cutter, points, normals)
    e1, h = place.approach.uphill, 1e-6
    e2 = np.cross(normals, e1)
    smooth = (place.contact.uphill == place.contact.downhill) & np.isfinite(place.contact.uphill)
    smooth &= np.isfinite(contact_at(cutter, place.approach.theta + 1e-5).uphill)
    for direction, k in ((e1, place.contact.uphill), (e2, place.contact.around)):
        ahead, back = (gradient(cutter, place.tip, axis, s * h * direction)[1] for s in (1.0, -1.0))
        measured = np.sum((ahead - back) * direction, axis=1) / (2.0 * h)
        assert np.max(np.abs(measured - k)[smooth]) < 1e-6
    assert smooth.sum() > 100


@pytest.mark.parametrize(("cutter", "sizes"), [(bull(20.0, 2.0, 50.0), (10.0, 2.0)), (ball(20.0, 50.0), (10.0, 10.0)),
                                               (flat(20.0, 50.0), (10.0, 0.0))])  # fmt: skip
def test_the_closed_form_of_end_mills_is_their_profiles(cutter, sizes):
    theta = np.radians([0.0, 1e-9, 0.01, 10.0, 45.0, 89.99, 90.0])
    for general, closed in zip(contact_at(cutter, theta), end_mill_contact(*sizes, theta), strict=True):
        assert np.allclose(general, closed, rtol=1e-12, atol=1e-9)


def test_limits_at_the_bottom_and_on_the_shank():
    bottom, shank = 0.0, 0.5 * np.pi
    corner = end_mill_contact(10.0, 2.0, bottom)
    assert (corner.r, corner.uphill, corner.downhill, corner.around) == (8.0, 0.5, 0.0, 0.0)
    centre = end_mill_contact(10.0, 10.0, bottom)
    assert (centre.r, centre.uphill, centre.downhill, centre.around) == (0.0, 0.1, 0.1, 0.1)
    wall = end_mill_contact(10.0, 2.0, shank)
    assert (wall.uphill, wall.downhill, float(wall.around)) == (0.0, 0.5, pytest.approx(0.1))
    disc = end_mill_contact(10.0, 0.0, bottom)
    assert (disc.uphill, disc.downhill, disc.around, disc.weaker) == (np.inf, 0.0, 0.0, 0.0)


def test_a_pointed_tip_and_a_ball_that_meets_a_cone():
    cone = SHARP[2]
    assert contact_at(cone, 0.1).r == 0.0
    assert np.isinf(contact_at(cone, 0.1).around)
    joint = contact_at(tapered_ball(6.0, 0.2, 40.0), 0.5 * np.pi - 0.2)
    assert (float(joint.uphill), float(joint.downhill)) == (0.0, pytest.approx(1.0 / 3.0))


def test_what_has_no_contact():
    assert np.isnan(end_mill_contact(10.0, 2.0, 1.6).around)
    assert np.isnan(end_mill_contact(1.0, 2.0, 0.5).around)
    with pytest.raises(InputError, match="not convex"):
        contact_at(lollipop(10.0, 4.0, 40.0), 0.3)


@given(st.floats(0.0, np.pi), st.floats(0.0, 2.0 * np.pi))
def test_uphill_is_a_unit_tangent_that_climbs(theta, turn):
    normal = np.array([-np.sin(theta) * np.cos(turn), -np.sin(theta) * np.sin(turn), np.cos(theta)])
    seen = approach(normal)
    assert abs(seen.theta - theta) < 1e-8
    assert abs(np.dot(seen.uphill, normal)) < 1e-8
    assert abs(np.linalg.norm(seen.uphill) - 1.0) < 1e-12
    assert seen.uphill[2] >= 0.0
