"""How the mill that cuts differs from the one that its path was planned for: the same meridian, its sides moved.

A spinning tool's flutes sweep a body of revolution about the spindle's axis. Of a tool whose axis lies off it, and
parallel to it, every circle of radius r sweeps one of r plus that offset.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import cos, hypot, sin, sqrt

from gearsim.cutters.checks import turn
from gearsim.cutters.element import Element
from gearsim.cutters.outline import Corner, outline
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError

_TANGENT = 1e-6
_ON_AXIS = 1e-9
_FLATTEST = 1e6  # mm: the radius of an arc whose points are known to a nanometre
_Point = tuple[float, float]


@dataclass(frozen=True)
class MillErrors:
    """Errors of a mill; lengths in mm, angles in rad; all zero: the mill as it was planned for.

    | error | meaning |
    | --- | --- |
    | radius | every radius of the tool is larger by this much |
    | taper | its side line leans this much more, about the corner where it meets the bottom, both prolonged |
    | runout | its axis lies this far off the spindle's, parallel to it |
    | form | the side line is a convex arc that touches the straight line in its middle and ends this much short of it |
    | length | the tool stands this much farther out of its holder than the program says |
    | corner | the radius of the corner between bottom and side is larger by this much |
    """

    radius: float = 0.0
    taper: float = 0.0
    runout: float = 0.0
    form: float = 0.0
    length: float = 0.0
    corner: float = 0.0

    def cutter(self, nominal: Profile) -> Profile:
        """What sweeps in the place of a nominal mill.

        Raises InputError where it can be none: a mill that is not made of straight sides with rounded corners, or whose
        side line does not end in its top.
        """
        if self == MillErrors():
            return nominal
        real = nominal
        if self != MillErrors(length=self.length):
            corners = self._moved(_corners(nominal))
            real = outline(nominal.name, corners)
            if self.form:
                real = _crowned(real, corners, self.form)
        return Profile(nominal.name, tuple(lifted(e, -self.length) for e in real.elements))

    def _moved(self, corners: list[Corner]) -> list[Corner]:
        """The corners with sides shifted outward, the last one leaning more, its lower corner rounder."""
        *bottom, lower, top, axis = corners
        out = self.radius + abs(self.runout)
        height = top.z - lower.z
        lean = (top.r - lower.r) / height
        more = sin(self.taper) * (1.0 + lean * lean) / (cos(self.taper) - lean * sin(self.taper))  # of two tangents
        wide = [c if c.r <= _ON_AXIS else c._replace(r=c.r + out) for c in bottom]
        side = lower._replace(r=lower.r + out, radius=lower.radius + self.corner)
        problems = [f"{name} = {value:g} mm" for name, value in (("the bottom's radius", side.r),
                    ("the top's radius", top.r + out + more * height)) if value <= _ON_AXIS]  # fmt: skip
        problems += [f"the corner's radius = {side.radius:g} mm"] * (side.radius < 0.0)
        if problems:
            raise InputError(f"errors of the tool leave none: {', '.join(problems)}")
        return [*wide, side, top._replace(r=top.r + out + more * height), axis]


def lifted(e: Element, height: float) -> Element:
    """An element that much higher over the tip [mm]."""
    (r0, z0), (r1, z1), (rc, zc) = e.start, e.end, e.centre
    return replace(e, start=(r0, z0 + height), end=(r1, z1 + height), centre=(rc, zc + height))


def _corners(mill: Profile) -> list[Corner]:
    """The corners of a mill of straight sides, from the axis at the tip to the axis at the top; the last but one is its
    rim, the one before that where its side line begins.

    Raises InputError for another mill.
    """
    wrong = _no_straight_sides(mill)
    if wrong:
        raise InputError(f"errors of the tool: {wrong}; only errors.tool_length_um can be given for it")
    first, corners = mill.elements[0], list[Corner]()
    if first.is_arc or first.start[0] <= _ON_AXIS:
        corners.append(Corner(0.0, first.start[1]))
    for a, b in zip((None, *mill.elements), mill.elements, strict=False):
        if b.is_arc:
            half, middle = 0.5 * (b.angles[1] - b.angles[0]), 0.5 * sum(b.angles)
            far = b.radius / cos(half)
            corners.append(Corner(b.centre[0] + far * cos(middle), b.centre[1] + far * sin(middle), b.radius))
        elif a is not None and not a.is_arc:
            corners.append(Corner(*b.start))
    return [*corners, Corner(*mill.elements[-1].end)]


def _no_straight_sides(mill: Profile) -> str:
    """Why a mill is not one of straight sides, rounded corners between them, and a side line up to its top; or none."""
    if len(mill.elements) < 2 or mill.elements[-2].kind != "line" or not mill.elements[-1].is_flat:
        return f"the side line of {mill.name!r} does not end in a flat top"
    for a, b in pairwise(mill.elements):
        turned, arcs = turn(a, b), a.is_arc + b.is_arc
        if arcs == 2 or turned < -_TANGENT or (arcs == 1 and turned > _TANGENT):
            return f"{mill.name!r} is not made of straight sides with rounded corners"
    return ""


def _crowned(mill: Profile, corners: list[Corner], amplitude: float) -> Profile:
    """The mill with an arc for its side line, ``amplitude`` [mm] short of it at the rim and at the lower corner."""
    before, lower, rim = corners[-4:-1]
    length = hypot(rim.r - lower.r, rim.z - lower.z)
    radius = length * length / (8.0 * amplitude) + 0.5 * amplitude
    if radius > _FLATTEST:
        raise InputError(
            f"errors of the tool: a form error of {1e3 * amplitude:g} um on a side line of {length:.4g} mm is flatter "
            f"than can be computed; expected 0, or {1e3 * length * length / (8.0 * _FLATTEST):.2g} um and more"
        )
    out = (rim.z - lower.z) / length, (lower.r - rim.r) / length
    centre = 0.5 * (lower.r + rim.r) - radius * out[0], 0.5 * (lower.z + rim.z) - radius * out[1]
    top = centre[0] + sqrt(radius * radius - (rim.z - centre[1]) ** 2), rim.z
    foot, middle, start = _lower_end(before, lower, centre, radius)
    if foot[0] <= _ON_AXIS:
        raise InputError(
            "errors of the tool: under a crowned side line the corner leaves no bottom; a smaller one would"
        )
    bottom = mill.elements[: -3 if lower.radius else -2]
    chain = [*bottom[:-1], Element((before.r, before.z), foot)]
    chain += [Element(foot, start, middle, lower.radius)] if lower.radius else []
    return Profile(mill.name, (*chain, Element(start, top, centre, radius), Element(top, (0.0, rim.z))))


def _lower_end(before: Corner, lower: Corner, centre: _Point, radius: float) -> tuple[_Point, _Point, _Point]:
    """Where the bottom ends, the middle of the corner's arc, and where an arc of a great radius begins behind it.

    The corner's arc touches the bottom, and the great one from within.
    """
    length = hypot(lower.r - before.r, lower.z - before.z)
    t = (lower.r - before.r) / length, (lower.z - before.z) / length
    inward = -lower.radius * t[1], lower.radius * t[0]
    d = lower.r + inward[0] - centre[0], lower.z + inward[1] - centre[1]
    along, across = d[0] * t[0] + d[1] * t[1], d[0] * t[1] - d[1] * t[0]
    s = sqrt((radius - lower.radius - across) * (radius - lower.radius + across)) - along
    middle = lower.r + inward[0] + s * t[0], lower.z + inward[1] + s * t[1]
    way = hypot(middle[0] - centre[0], middle[1] - centre[1])
    start = tuple(c + radius * (m - c) / way for c, m in zip(centre, middle, strict=True))
    return (middle[0] - inward[0], middle[1] - inward[1]), middle, (start[0], start[1])
