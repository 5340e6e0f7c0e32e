"""Grinding wheels, and the head of a face mill. Lengths in mm, angles in rad."""

from __future__ import annotations

from math import degrees, pi, tan

from gearsim.cutters.outline import Corner, not_negative, outline, require, sizes, slanted
from gearsim.cutters.profile import Profile

_SMALL = 1e-9


def grinding_cone(diameter: float, half_angle: float, height: float, edge_radius: float = 0.0) -> Profile:
    """Grinding cone, widening away from the tip (Litvin and Chen 1994, section 4, equations 32 and 33).

    | parameter | meaning |
    | --- | --- |
    | diameter | outside diameter, where cone and top, prolonged, meet [mm] |
    | half_angle | angle between cone and axis [rad], Litvin's gamma_t (by his 32 not the whole angle at the apex) |
    | height | height of the tool [mm], up to the whole cone's |
    | edge_radius | radius of the edge at the outside diameter [mm]; 0: sharp |

    The apex lies diameter / (2 tan(half_angle)) below the top, on the axis. Raises InputError for
    impossible sizes.
    """
    name, r = "grinding cone", 0.5 * diameter
    rules = [*sizes(diameter=diameter, height=height), not_negative("edge_radius", edge_radius)]
    require(name, [*rules, slanted("half_angle", half_angle, 0.0)])
    small, apex = r - height * tan(half_angle), r / tan(half_angle)
    require(name, [(small >= -_SMALL, f"height = {height:g} mm must not exceed the whole cone's, {apex:.6g} mm")])
    bottom = [Corner(0.0, 0.0), Corner(small, 0.0)] if small > _SMALL else [Corner(0.0, 0.0)]
    return outline(name, [*bottom, Corner(r, height, edge_radius), Corner(0.0, height)])


def grinding_wheel(
    diameter: float, rim_width: float, flank_angle: float, depth: float, edge_radius: float = 0.0
) -> Profile:
    """Peripheral grinding wheel with conical flanks and rounded edges, as for worms and gears.

    | parameter | meaning |
    | --- | --- |
    | diameter | outside diameter [mm] |
    | rim_width | width of the cylindrical rim, where rim and flanks, prolonged, meet [mm]; 0: the flanks meet |
    | flank_angle | angle between flank and the plane normal to the axis [rad]: the pressure angle; 0: straight sides |
    | depth | radial depth of the flanks [mm]; the hub below has straight sides |
    | edge_radius | radius of the rim's edges [mm]; 0: sharp |

    The tip lies in the centre of one side. Raises InputError for impossible sizes.
    """
    name, r, hub, e = "grinding wheel", 0.5 * diameter, 0.5 * diameter - depth, edge_radius
    rules = [*sizes(diameter=diameter, depth=depth), not_negative("rim_width", rim_width)]
    angle = f"flank_angle = {degrees(flank_angle):g} deg must lie in 0 to 90 deg"
    require(name, [*rules, not_negative("edge_radius", e), (0.0 <= flank_angle < 0.5 * pi, angle)])
    rise = depth * tan(flank_angle)
    used = 2.0 * e * tan(0.25 * pi - 0.5 * flank_angle)
    require(name, [
        (hub > 0.0, f"depth = {depth:g} mm must be below half the diameter, {r:g} mm"),
        (rim_width + rise > 0.0, "rim_width and flank_angle must not both be 0: the wheel would have no thickness"),
        (
            rim_width <= _SMALL or used <= rim_width + _SMALL,
            f"rim_width = {rim_width:g} mm must be at least {used:.6g} mm, 2 edge_radius tan(45 deg - flank_angle / 2)",
        ),
    ])  # fmt: skip
    rim = [Corner(r, rise, e), Corner(r, rise + rim_width, e)] if rim_width > _SMALL else [Corner(r, rise, e)]
    width = rim_width + 2.0 * rise
    sides = [Corner(hub, 0.0)], [Corner(hub, width)]
    below, above = sides if rise > 0.0 else ([], [])
    return outline(name, [Corner(0.0, 0.0), *below, *rim, *above, Corner(0.0, width)])


def face_mill_head(
    radius: float, point_width: float, inner_angle: float, outer_angle: float, edge_radius: float, height: float
) -> Profile:
    """Ring-shaped head of a face mill: the blades' cutting edges revolved (Zhou 2015, figure 3.5, table 3.4).

    | parameter | meaning |
    | --- | --- |
    | radius | mean radius of the blades' points [mm], Zhou's average radius |
    | point_width | distance between inside and outside flank, prolonged, in the tip plane [mm] |
    | inner_angle | angle between the inside flank and the axis [rad]; positive widens the blade away from the tip |
    | outer_angle | the same of the outside flank [rad] |
    | edge_radius | radius of the blades' edges [mm]; 0: sharp |
    | height | height of the blades [mm] |

    The profile is a ring: tip land from its inner end outward, outer edge, outer flank up, top inward, inner flank
    down, inner edge; sharp edges are left out. Tool frame: origin on the head's axis in the tip plane, +z from
    the gear. Raises InputError for impossible sizes.
    """
    name, inside, outside = "face-mill head", radius - 0.5 * point_width, radius + 0.5 * point_width
    rules = [*sizes(radius=radius, point_width=point_width, height=height), not_negative("edge_radius", edge_radius)]
    require(name, [*rules, slanted("inner_angle", inner_angle), slanted("outer_angle", outer_angle)])
    used = edge_radius * (tan(0.25 * pi - 0.5 * inner_angle) + tan(0.25 * pi - 0.5 * outer_angle))
    top_in, top_out = inside - height * tan(inner_angle), outside + height * tan(outer_angle)
    hole = min(inside, top_in)
    require(name, [
        (
            used < point_width,
            f"point_width = {point_width:g} mm must exceed edge_radius (tan(45 deg - inner_angle / 2) + tan(45 deg - "
            f"outer_angle / 2)) = {used:.6g} mm, what the edges use of it",
        ),
        (hole > 0.0, f"radius = {radius:g} mm must exceed {radius - hole:.6g} mm: the inside flank meets the axis"),
        (top_out > top_in, f"the flanks meet below the top: height = {height:g} mm is too much for these angles"),
    ])  # fmt: skip
    corners = [Corner(inside, 0.0, edge_radius), Corner(outside, 0.0, edge_radius)]
    return outline(name, [*corners, Corner(top_out, height), Corner(top_in, height)], closed=True)
