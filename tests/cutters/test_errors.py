"""Meridians of tools with errors against what a drawing says of them."""

from math import cos, radians, sin, tan

import numpy as np
import pytest

from gearsim.cutters.catalogue import ball, barrel, bull, conical, face_mill_head, flat, lollipop, tapered_ball
from gearsim.cutters.head_errors import HeadErrors, HeadSizes
from gearsim.cutters.mill_errors import MillErrors
from gearsim.errors import InputError

TAPER = radians(15.0)
CONE = conical(1.04, 0.8, TAPER, 25.0)
HEIGHTS = np.linspace(1.0, 24.0, 24)
CORNER = 1.04 + 0.8 * (1.0 - sin(TAPER)) / cos(TAPER)  # where its side line meets the plane of its tip
SIZES = HeadSizes(63.5, 2.54, radians(22.0), radians(20.0), 1.5, 12.0)
HEAD = face_mill_head(*SIZES)


def radii(mill, heights=HEIGHTS):
    return np.array([mill.radius_at(z) for z in heights])


def test_a_tool_without_errors_is_the_tool_itself():
    for mill in (CONE, ball(8.0, 20.0), lollipop(10.0, 5.0, 30.0)):
        assert MillErrors().cutter(mill) is mill
    assert HeadErrors().head(HEAD, SIZES) is HEAD


@pytest.mark.parametrize("mill", [CONE, flat(10.0, 25.0), bull(10.0, 2.0, 25.0)])
def test_radius_and_runout_add_to_every_radius(mill):
    for errors in (MillErrors(radius=0.003, runout=0.002), MillErrors(radius=0.003, runout=-0.002)):
        np.testing.assert_allclose(radii(errors.cutter(mill)) - radii(mill), 0.005, rtol=0.0, atol=1e-12)
    smaller = MillErrors(radius=-0.004).cutter(mill)
    np.testing.assert_allclose(radii(smaller) - radii(mill), -0.004, rtol=0.0, atol=1e-12)
    assert smaller.height == mill.height


def test_a_taper_error_grows_from_the_corner_in_the_tip_plane():
    real = MillErrors(taper=radians(0.1)).cutter(CONE)
    np.testing.assert_allclose(radii(real), CORNER + HEIGHTS * tan(radians(15.1)), rtol=0.0, atol=1e-12)
    assert real.is_convex
    assert [e.radius for e in real.elements] == [0.0, 0.8, 0.0, 0.0]
    end_mill = MillErrors(taper=radians(-0.05)).cutter(flat(10.0, 25.0))
    np.testing.assert_allclose(radii(end_mill), 5.0 - HEIGHTS * tan(radians(0.05)), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("amplitude", [0.0002, 0.005, 0.1])
def test_a_form_error_is_a_convex_arc_that_touches_the_side_line_in_its_middle(amplitude):
    real = MillErrors(form=amplitude).cutter(CONE)
    assert real.is_convex
    rim = CORNER + 25.0 * tan(TAPER)
    length, way = np.hypot(rim - CORNER, 25.0), HEIGHTS / cos(TAPER)
    off = (radii(CONE) - radii(real)) * cos(TAPER)
    lean = 8.0 * amplitude / length**2 * (way - 0.5 * length)  # of the arc against the line: off is measured along r
    parabola = amplitude * (2.0 * way / length - 1.0) ** 2
    np.testing.assert_allclose(off, parabola, rtol=0.0, atol=1.1 * tan(TAPER) * np.abs(lean * parabola).max() + 1e-9)
    assert real.radius_at(12.5) == pytest.approx(CONE.radius_at(12.5), abs=1e-9)


def test_a_corner_error_leaves_bottom_and_side_line():
    real = MillErrors(corner=0.05).cutter(CONE)
    np.testing.assert_allclose(radii(real), radii(CONE), rtol=0.0, atol=1e-12)
    assert [e.radius for e in real.elements] == pytest.approx([0.0, 0.85, 0.0, 0.0])
    near = MillErrors(corner=-0.05).cutter(CONE).signed_distance(np.array([CORNER]), np.zeros(1))[0]
    far = CONE.signed_distance(np.array([CORNER]), np.zeros(1))[0]
    stands_off = (
        1.0 / cos(0.5 * (radians(90.0) - TAPER)) - 1.0
    )  # of a rounding of radius 1 off its corner, turned by 75 deg
    assert far - near == pytest.approx(0.05 * stands_off, abs=1e-12)


def test_a_longer_tool_reaches_lower():
    for mill in (CONE, ball(8.0, 30.0)):
        real = MillErrors(length=0.02).cutter(mill)
        assert real.box[2:] == pytest.approx((-0.02, mill.height - 0.02))
        np.testing.assert_allclose(radii(real), radii(mill, HEIGHTS + 0.02), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(("mill", "errors", "message"), [
    (CONE, MillErrors(radius=-2.0), "leave none: the bottom's radius = "),
    (CONE, MillErrors(corner=-0.9), "the corner's radius = -0.1 mm"),
    (CONE, MillErrors(taper=radians(-20.0)), "the top's radius"),
    (CONE, MillErrors(form=1e-5), "expected 0, or 0.084 um and more"),
    (ball(8.0, 20.0), MillErrors(form=1e-3), "under a crowned side line the corner leaves no bottom"),
    (tapered_ball(8.0, TAPER, 20.0), MillErrors(radius=-1e-3), "smaller radii would fit"),
    (lollipop(10.0, 5.0, 30.0), MillErrors(radius=1e-3), "not made of straight sides with rounded corners"),
    (barrel(10.0, 50.0, 10.0, 20.0), MillErrors(taper=1e-3), "does not end in a flat top; only errors.tool_length_um"),
])  # fmt: skip
def test_what_can_be_no_tool_is_refused(mill, errors, message):
    with pytest.raises(InputError, match=message.replace(".", r"\.")):
        errors.cutter(mill)


def flanks(head):
    """Of outside and inside flank: a point, and the unit normal, of the line."""
    found = [e.at(np.array(0.5 * e.length)) for e in (head.elements[2], head.elements[4])]
    return [(np.array([p.r, p.z]), np.array([p.nr, p.nz])) for p in found]


def receded(errors):
    """How far both flanks lie behind the nominal ones, along their normals, at the height of the nominal's middle."""
    real, nominal = flanks(errors.head(HEAD, SIZES)), flanks(HEAD)
    return [float((p - q) @ n / (m @ n)) for (p, n), (q, m) in zip(nominal, real, strict=True)]


@pytest.mark.parametrize(("errors", "outside", "inside"), [
    (HeadErrors(outer_wear=0.01, inner_wear=0.02), 0.01, 0.02),
    (HeadErrors(point_width=0.02), -0.01 * cos(SIZES.outer_angle), -0.01 * cos(SIZES.inner_angle)),
    (HeadErrors(runout=0.01), -0.01 * cos(SIZES.outer_angle), -0.01 * cos(SIZES.inner_angle)),
    (HeadErrors(radius=0.01), -0.01 * cos(SIZES.outer_angle), 0.01 * cos(SIZES.inner_angle)),
    (HeadErrors(length=0.01), -0.01 * sin(SIZES.outer_angle), -0.01 * sin(SIZES.inner_angle)),
    (HeadErrors(tip_wear=0.05, edge_radius=0.1), 0.0, 0.0),
])  # fmt: skip
def test_flanks_of_a_head_recede_as_drawn(errors, outside, inside):
    assert receded(errors) == pytest.approx([outside, inside], abs=1e-12)


def test_tip_and_edges_of_a_worn_head():
    real = HeadErrors(tip_wear=0.05, edge_radius=0.1).head(HEAD, SIZES)
    assert real.box[2:] == pytest.approx((0.05, 12.0))
    assert [e.radius for e in real.elements] == pytest.approx([0.0, 1.6, 0.0, 0.0, 0.0, 1.6])
    blades = HeadErrors(inner_angle=radians(0.1)).head(HEAD, SIZES)
    (_, outer), (_, inner) = flanks(blades)
    assert np.degrees(np.arcsin(-outer[1])) == pytest.approx(20.0)
    assert np.degrees(np.arcsin(-inner[1])) == pytest.approx(22.1)
    with pytest.raises(InputError, match="point_width"):
        HeadErrors(edge_radius=2.0).head(HEAD, SIZES)
