"""End mills: flat, ball, bull-nosed, tapered, and barrels. Lengths in mm, angles in rad."""

from __future__ import annotations

from math import degrees, pi, sqrt, tan

from gearsim.cutters.apt import conical
from gearsim.cutters.outline import Corner, not_negative, outline, require, sizes, slanted
from gearsim.cutters.profile import Element, Profile

_SMALL = 1e-9


def flat(diameter: float, height: float) -> Profile:
    """Flat end mill: a cylinder with a sharp edge.

    | parameter | meaning |
    | --- | --- |
    | diameter | diameter [mm] |
    | height | height of the tool [mm] |

    Raises InputError for impossible sizes.
    """
    require("flat end mill", sizes(diameter=diameter, height=height))
    r = 0.5 * diameter
    return outline("flat end mill", [Corner(0.0, 0.0), Corner(r, 0.0), Corner(r, height), Corner(0.0, height)])


def drill(diameter: float, point_angle: float, height: float) -> Profile:
    """Twist drill: a cylinder on a pointed cone.

    | parameter | meaning |
    | --- | --- |
    | diameter | diameter [mm] |
    | point_angle | angle of the point, from side to side [rad]; below a half turn |
    | height | height of the tool [mm], more than the point's |

    Raises InputError for impossible sizes.
    """
    r, half = 0.5 * diameter, 0.5 * point_angle
    rules = [
        *sizes(diameter=diameter, height=height),
        (0.0 < half < 0.5 * pi, f"point_angle = {degrees(point_angle):g} deg must lie between 0 and 180 deg"),
    ]
    require("drill", rules)
    point = r / tan(half)
    require("drill", [(height > point, f"height = {height:g} mm must be more than the point's, {point:g} mm")])
    return outline("drill", [Corner(0.0, 0.0), Corner(r, point), Corner(r, height), Corner(0.0, height)])


def ball(diameter: float, height: float) -> Profile:
    """Ball end mill: a cylinder with a hemispherical end.

    | parameter | meaning |
    | --- | --- |
    | diameter | diameter of ball and shank [mm] |
    | height | height of the tool [mm], more than the ball's radius |

    Raises InputError for impossible sizes.
    """
    return _rounded_cylinder("ball end mill", diameter, 0.5 * diameter, height)


def bull(diameter: float, corner_radius: float, height: float) -> Profile:
    """Bull-nose end mill: a cylinder whose corner is rounded.

    | parameter | meaning |
    | --- | --- |
    | diameter | diameter of the shank [mm] |
    | corner_radius | corner radius [mm], up to half the diameter |
    | height | height of the tool [mm], more than the corner radius |

    Raises InputError for impossible sizes.
    """
    return _rounded_cylinder("bull-nose end mill", diameter, corner_radius, height)


def tapered(tip_diameter: float, taper: float, height: float) -> Profile:
    """Tapered end mill with a flat end and a sharp edge.

    | parameter | meaning |
    | --- | --- |
    | tip_diameter | diameter at the tip [mm] |
    | taper | angle between flank and axis [rad]; positive widens upward |
    | height | height of the tool [mm] |

    Raises InputError for impossible sizes.
    """
    name, r = "tapered end mill", 0.5 * tip_diameter
    require(name, [*sizes(tip_diameter=tip_diameter, height=height), slanted("taper", taper)])
    top = r + height * tan(taper)
    require(name, [(top > 0.0, f"the flank meets the axis below the top: taper = {degrees(taper):g} deg is too steep")])
    return outline(name, [Corner(0.0, 0.0), Corner(r, 0.0), Corner(top, height), Corner(0.0, height)])


def tapered_ball(ball_diameter: float, taper: float, height: float) -> Profile:
    """Tapered ball end mill: a ball tangent to a cone.

    | parameter | meaning |
    | --- | --- |
    | ball_diameter | diameter of the ball at the tip [mm] |
    | taper | angle between flank and axis [rad]; positive widens upward |
    | height | height of the tool [mm], more than the ball's height up to the cone |

    Raises InputError for impossible sizes.
    """
    name = "tapered ball end mill"
    require(name, [*sizes(ball_diameter=ball_diameter, height=height), slanted("taper", taper)])
    return Profile(name, conical(0.0, 0.5 * ball_diameter, taper, height).elements)


def barrel(diameter: float, barrel_radius: float, middle: float, height: float, corner_radius: float = 0.0) -> Profile:
    """Barrel (arc) cutter: its flank is an arc whose centre may lie beyond the axis.

    | parameter | meaning |
    | --- | --- |
    | diameter | greatest diameter of the arc [mm] |
    | barrel_radius | radius of the flank's arc [mm] |
    | middle | height of the greatest diameter over the tip [mm]; beyond 0 to height the barrel is tapered |
    | height | height of the tool [mm] |
    | corner_radius | radius of the corner between bottom and flank [mm]; 0: a sharp edge |

    Raises InputError for impossible sizes.
    """
    return _barrel("barrel cutter", diameter, barrel_radius, middle, height, corner_radius)


def oval(diameter: float, barrel_radius: float, ball_radius: float, height: float) -> Profile:
    """Oval-form cutter: a barrel's arc tangent to a ball at the tip.

    | parameter | meaning |
    | --- | --- |
    | diameter | greatest diameter of the arc [mm], more than the ball's |
    | barrel_radius | radius of the flank's arc [mm], more than half the diameter |
    | ball_radius | radius of the ball at the tip [mm] |
    | height | height of the tool [mm] |

    The height of the greatest diameter follows from the tangency. Raises InputError for impossible sizes.
    """
    name, r = "oval-form cutter", 0.5 * diameter
    lengths = sizes(diameter=diameter, barrel_radius=barrel_radius, ball_radius=ball_radius, height=height)
    slender = f"barrel_radius = {barrel_radius:g} mm must exceed half the diameter, {r:g} mm"
    small = f"ball_radius = {ball_radius:g} mm must be below half the diameter, {r:g} mm"
    require(name, [*lengths, (barrel_radius > r, slender), (ball_radius < r, small)])
    middle = ball_radius + sqrt((barrel_radius - ball_radius) ** 2 - (barrel_radius - r) ** 2)
    return _barrel(name, diameter, barrel_radius, middle, height, ball_radius)


def _barrel(name: str, diameter: float, radius: float, middle: float, height: float, corner: float) -> Profile:
    lengths = sizes(diameter=diameter, barrel_radius=radius, height=height)
    require(name, [*lengths, not_negative("corner_radius", corner)])
    inner, rise = radius - corner, middle - corner
    tall = f"height = {height:g} mm must be below middle + barrel_radius = {middle + radius:g} mm"
    deep = f"the corner lies below the arc: |middle - corner_radius| = {abs(rise):g} mm must be below barrel_radius "
    deep += f"- corner_radius = {inner:g} mm"
    require(name, [(height < middle + radius, tall), (abs(rise) < inner, deep)])
    axis = 0.5 * diameter - radius
    foot = axis + sqrt(inner**2 - rise**2)
    top = axis + sqrt(max(radius**2 - (height - middle) ** 2, 0.0))
    start = (axis + (foot - axis) * radius / inner, middle - rise * radius / inner)
    narrow = "the {} is too narrow: {} = {:.6g} mm must {}; a larger diameter or barrel_radius would do"
    bottom = narrow.format("bottom", "corner centre's radius", foot, "not be negative")
    short = f"height = {height:g} mm must exceed the corner's end at {start[1]:.6g} mm"
    above = narrow.format("top", "its radius", top, "be positive")
    enough = foot >= -_SMALL and start[0] > _SMALL
    require(name, [(enough, bottom), (top > 0.0, above), (height > start[1], short)])
    foot = foot if foot > _SMALL else 0.0
    chain = [Element((0.0, 0.0), (foot, 0.0))] if foot > 0.0 else []
    if corner > 0.0:
        chain.append(Element((foot, 0.0), start, (foot, corner), corner))
    arc = Element(start, (top, height), (axis, middle), radius)
    return Profile(name, (*chain, arc, Element((top, height), (0.0, height))))


def _rounded_cylinder(name: str, diameter: float, corner_radius: float, height: float) -> Profile:
    r = 0.5 * diameter
    wide = f"corner_radius = {corner_radius:g} mm must not exceed half the diameter, {r:g} mm"
    low = f"height = {height:g} mm must exceed the corner radius, {corner_radius:g} mm"
    lengths = [*sizes(diameter=diameter, height=height), not_negative("corner_radius", corner_radius)]
    require(name, [*lengths, (not corner_radius > r, wide), (not height <= corner_radius, low)])
    corners = [Corner(0.0, 0.0), Corner(r, 0.0, corner_radius), Corner(r, height), Corner(0.0, height)]
    return outline(name, corners)
