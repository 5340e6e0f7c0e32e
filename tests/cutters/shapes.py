"""Tools of every kind the simulation must cope with, built from points alone."""

from __future__ import annotations

from itertools import pairwise
from math import asin, cos, pi, radians, sin, sqrt, tan

from gearsim.cutters.profile import Element, Profile


def polygon(name, *points):
    """A cutter of straight lines through (r, z) points."""
    return Profile(name, tuple(Element(a, b) for a, b in pairwise(points)))


def barrel(radius=50.0, centre=-45.0, half_height=10.0):
    """A barrel whose arc is centred beyond the axis."""
    end = centre + radius * cos(asin(half_height / radius))
    arc = Element((end, 0.0), (end, 2 * half_height), (centre, half_height), radius)
    bottom, top = Element((0.0, 0.0), (end, 0.0)), Element((end, 2 * half_height), (0.0, 2 * half_height))
    return Profile("barrel", (bottom, arc, top))


def spindle(radius=5.0, centre=-3.0):
    """A body pointed at both ends: one arc from pole to pole, centred beyond the axis."""
    half = sqrt(radius**2 - centre**2)
    return Profile("spindle", (Element((0.0, 0.0), (0.0, 2 * half), (centre, half), radius),))


def lollipop(ball=4.0, neck=2.0, height=20.0):
    """A ball on a thinner neck."""
    joint = ball + sqrt(ball**2 - neck**2)
    arc = Element((0.0, 0.0), (neck, joint), (0.0, ball), ball)
    return Profile("lollipop", (arc, Element((neck, joint), (neck, height)), Element((neck, height), (0.0, height))))


def t_slot(radius=8.0, neck=3.0, thickness=4.0, height=20.0):
    """A disc on a thinner neck, sharp-edged."""
    return polygon("T-slot", (0.0, 0.0), (radius, 0.0), (radius, thickness), (neck, thickness), (neck, height),
                   (0.0, height))  # fmt: skip


def dovetail(radius=8.0, neck=3.0, thickness=5.0, height=20.0):
    """A cone that narrows upward, on a neck."""
    return polygon("dovetail", (0.0, 0.0), (radius, 0.0), (neck + 0.5, thickness), (neck, thickness), (neck, height),
                   (0.0, height))  # fmt: skip


def double():
    """A dovetail below a neck below a wider shank: two reentrant corners."""
    return polygon("double", (0.0, 0.0), (6.0, 0.0), (3.0, 4.0), (3.0, 9.0), (7.0, 9.0), (7.0, 15.0), (0.0, 15.0))


def ring(radius=63.5, point_width=2.0, edge=0.8, height=12.0, inner_deg=19.0, outer_deg=23.0):
    """A face-mill head: blades between two cones that widen away from the tip, edges rounded if ``edge`` > 0.

    ``radius`` and ``point_width`` belong to the points where the cones meet the tip plane.
    """
    inner, outer = radians(inner_deg), radians(outer_deg)
    inside, outside = radius - 0.5 * point_width, radius + 0.5 * point_width
    top_in, top_out = (inside - height * tan(inner), height), (outside + height * tan(outer), height)
    if edge == 0.0:
        corners = [(inside, 0.0), (outside, 0.0), top_out, top_in]
        return Profile(
            "sharp ring", tuple(Element(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True))
        )
    out_c = outside - edge * tan(0.25 * pi - 0.5 * outer)
    in_c = inside + edge * tan(0.25 * pi - 0.5 * inner)
    out_end = (out_c + edge * cos(outer), edge - edge * sin(outer))
    in_end = (in_c - edge * cos(inner), edge - edge * sin(inner))
    return Profile("ring", (
        Element((in_c, 0.0), (out_c, 0.0)),
        Element((out_c, 0.0), out_end, (out_c, edge), edge),
        Element(out_end, top_out),
        Element(top_out, top_in),
        Element(top_in, in_end),
        Element(in_end, (in_c, 0.0), (in_c, edge), edge),
    ))  # fmt: skip


def every_shape():
    """One tool of each kind, by name."""
    return {
        "barrel": barrel(),
        "spindle": spindle(),
        "lollipop": lollipop(),
        "T-slot": t_slot(),
        "dovetail": dovetail(),
        "double": double(),
        "ring": ring(6.0, 1.0, 0.3, 6.0),
        "sharp ring": ring(6.0, 1.0, 0.0, 6.0),
    }
