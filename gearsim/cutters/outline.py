"""Profiles from a polygon with rounded corners, and how impossible parameters are refused."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import pairwise
from math import atan2, degrees, hypot, pi, tan
from typing import NamedTuple

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError

_VANISHES = 1e-9


class Corner(NamedTuple):
    """A corner (r, z) of a meridian, rounded by an arc tangent to both its sides; all in mm."""

    r: float
    z: float
    radius: float = 0.0


class _Rounding(NamedTuple):
    """What an arc takes of the two sides that meet in a corner [mm], and its centre."""

    trim: float
    centre: tuple[float, float]


def require(name: str, rules: Iterable[tuple[bool, str]]) -> None:
    """Raise InputError with the texts of all rules that fail; each is (holds, what fails and what would be right)."""
    failing = [text for holds, text in rules if not holds]
    if failing:
        raise InputError(f"impossible {name}: " + "; ".join(failing))


def sizes(**lengths: float) -> list[tuple[bool, str]]:
    """Rules that lengths [mm] are positive, named as the parameters they are."""
    return [(value > 0.0, f"{name} = {value:g} mm must be positive") for name, value in lengths.items()]


def not_negative(name: str, value: float) -> tuple[bool, str]:
    """The rule that a length [mm] is not negative."""
    return value >= 0.0, f"{name} = {value:g} mm must not be negative"


def slanted(name: str, angle: float, least: float = -0.5 * pi) -> tuple[bool, str]:
    """The rule that an angle [rad] lies between ``least`` and 90 deg, both excluded."""
    return least < angle < 0.5 * pi, f"{name} = {degrees(angle):g} deg must lie in {degrees(least):g} to 90 deg"


def outline(name: str, corners: Sequence[Corner], closed: bool = False) -> Profile:
    """The profile through the corners, in order, with the material on its left.

    From axis to axis, or ``closed``: a ring, which begins with the side from the first corner to the
    second. Sides that the roundings use up vanish. Raises InputError where they need more than a side has.
    """
    sides = list(pairwise([*corners, corners[0]] if closed else corners))
    before = [sides[-1] if closed else None, *sides[: len(corners) - 1]]
    after = [*sides, None][: len(corners)]
    roundings = [_rounding(c, a, b) for c, a, b in zip(corners, before, after, strict=True)]
    if closed:
        roundings.append(roundings[0])
    chain: list[Element] = []
    for k, (a, b) in enumerate(sides):
        length, first, last = hypot(b.r - a.r, b.z - a.z), roundings[k], roundings[k + 1]
        if first.trim + last.trim > length + _VANISHES:
            raise InputError(
                f"impossible {name}: the roundings at the ends of the side from ({a.r:g}, {a.z:g}) to ({b.r:g}, "
                f"{b.z:g}) need {first.trim + last.trim:.6g} mm of it, it has {length:.6g} mm; smaller radii would fit"
            )
        end = _along(b, a, last.trim)
        if length - first.trim - last.trim > _VANISHES:
            chain.append(Element(_along(a, b, first.trim), end))
        elif chain:
            end = chain[-1].end
        if b.radius > 0.0:
            after_b = sides[(k + 1) % len(sides)][1]
            start = end if chain else (a.r, a.z)
            chain.append(Element(start, _along(b, after_b, last.trim), last.centre, b.radius))
    return Profile(name, tuple(chain))


def _rounding(corner: Corner, before: tuple[Corner, Corner] | None, after: tuple[Corner, Corner] | None) -> _Rounding:
    if corner.radius == 0.0 or before is None or after is None:
        return _Rounding(0.0, (corner.r, corner.z))
    (ar, az), (br, bz) = _direction(*before), _direction(*after)
    trim = corner.radius * tan(0.5 * atan2(ar * bz - az * br, ar * br + az * bz))
    start = corner.r - trim * ar, corner.z - trim * az
    return _Rounding(trim, (start[0] - corner.radius * az, start[1] + corner.radius * ar))


def _direction(a: Corner, b: Corner) -> tuple[float, float]:
    length = hypot(b.r - a.r, b.z - a.z)
    return (b.r - a.r) / length, (b.z - a.z) / length


def _along(a: Corner, b: Corner, distance: float) -> tuple[float, float]:
    """The point at a distance from a on the way to b."""
    if distance == 0.0:
        return a.r, a.z
    dr, dz = _direction(a, b)
    return a.r + distance * dr, a.z + distance * dz
