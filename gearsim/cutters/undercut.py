"""Undercut tools: wider below than at the neck. Lengths in mm, angles in rad."""

from __future__ import annotations

from math import degrees, sqrt, tan

from gearsim.cutters.outline import Corner, not_negative, outline, require, sizes, slanted
from gearsim.cutters.profile import Element, Profile

_SMALL = 1e-9


def lollipop(ball_diameter: float, neck_diameter: float, height: float) -> Profile:
    """Lollipop cutter: a ball on a thinner neck.

    | parameter | meaning |
    | --- | --- |
    | ball_diameter | diameter of the ball [mm] |
    | neck_diameter | diameter of the neck [mm], less than the ball's |
    | height | height of the tool [mm], beyond where the neck enters the ball |

    Raises InputError for impossible sizes.
    """
    name, ball, neck = "lollipop cutter", 0.5 * ball_diameter, 0.5 * neck_diameter
    require(name, sizes(ball_diameter=ball_diameter, neck_diameter=neck_diameter, height=height))
    require(name, [_thinner(neck_diameter, ball_diameter, "ball_diameter")])
    joint = ball + sqrt(ball**2 - neck**2)
    require(
        name, [(height > joint, f"height = {height:g} mm must exceed {joint:.6g} mm, where the neck leaves the ball")]
    )
    arc = Element((0.0, 0.0), (neck, joint), (0.0, ball), ball)
    return Profile(name, (arc, Element((neck, joint), (neck, height)), Element((neck, height), (0.0, height))))


def t_slot(diameter: float, thickness: float, neck_diameter: float, height: float, edge_radius: float = 0.0) -> Profile:
    """T-slot cutter: a disc on a thinner neck.

    | parameter | meaning |
    | --- | --- |
    | diameter | diameter of the disc [mm] |
    | thickness | thickness of the disc [mm] |
    | neck_diameter | diameter of the neck [mm], less than the disc's |
    | height | height of the tool [mm], more than the thickness |
    | edge_radius | radius of the disc's two edges [mm]; 0: sharp |

    Raises InputError for impossible sizes.
    """
    name, r, neck, e = "T-slot cutter", 0.5 * diameter, 0.5 * neck_diameter, edge_radius
    require(name, sizes(diameter=diameter, thickness=thickness, neck_diameter=neck_diameter, height=height))
    require(name, [not_negative("edge_radius", e), _thinner(neck_diameter, diameter, "diameter")])
    thick = f"2 edge_radius = {2.0 * e:g} mm must not exceed thickness = {thickness:g} mm"
    wide = f"edge_radius = {e:g} mm must not exceed the shoulder's width, {r - neck:g} mm"
    require(name, [(2.0 * e <= thickness, thick), (e <= r - neck, wide), _taller(height, thickness)])
    head = [Corner(0.0, 0.0), Corner(r, 0.0, e), Corner(r, thickness, e), Corner(neck, thickness)]
    return outline(name, [*head, Corner(neck, height), Corner(0.0, height)])


def dovetail(
    diameter: float, flank_angle: float, thickness: float, neck_diameter: float, height: float, edge_radius: float = 0.0
) -> Profile:
    """Dovetail cutter: a cone that narrows upward, on a neck.

    | parameter | meaning |
    | --- | --- |
    | diameter | diameter at the bottom, where flank and bottom meet [mm] |
    | flank_angle | angle between flank and axis [rad]; a 60 deg dovetail has 30 deg |
    | thickness | height of the cone [mm] |
    | neck_diameter | diameter of the neck [mm], at most the cone's at its top |
    | height | height of the tool [mm], more than the thickness |
    | edge_radius | radius of the bottom edge [mm]; 0: sharp |

    Raises InputError for impossible sizes.
    """
    name, r, neck = "dovetail cutter", 0.5 * diameter, 0.5 * neck_diameter
    require(name, sizes(diameter=diameter, thickness=thickness, neck_diameter=neck_diameter, height=height))
    require(name, [not_negative("edge_radius", edge_radius), slanted("flank_angle", flank_angle, 0.0)])
    shoulder = r - thickness * tan(flank_angle)
    steep = f"neck_diameter = {neck_diameter:g} mm must not exceed diameter - 2 thickness tan(flank_angle) = "
    steep += f"{2.0 * shoulder:.6g} mm, the cone's at its top; flank_angle is {degrees(flank_angle):g} deg"
    require(name, [(shoulder >= neck - _SMALL, steep), _taller(height, thickness)])
    head = [Corner(0.0, 0.0), Corner(r, 0.0, edge_radius), Corner(max(shoulder, neck), thickness)]
    if shoulder > neck + _SMALL:
        head.append(Corner(neck, thickness))
    return outline(name, [*head, Corner(head[-1].r, height), Corner(0.0, height)])


def _thinner(neck: float, diameter: float, name: str) -> tuple[bool, str]:
    return neck < diameter, f"neck_diameter = {neck:g} mm must be below {name} = {diameter:g} mm"


def _taller(height: float, thickness: float) -> tuple[bool, str]:
    return height > thickness, f"height = {height:g} mm must exceed thickness = {thickness:g} mm"
