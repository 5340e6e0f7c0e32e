"""Shank, holder and spindle nose above a cutter: a profile that must cut nothing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from gearsim.cutters.element import Element
from gearsim.cutters.flutes import above_flutes
from gearsim.cutters.profile import Profile

Section = tuple[float, float, float]
UPPER = "upper part"
_SAME = 1e-9


@dataclass(frozen=True)
class Holder(Profile):
    """Bodies on one another above a cutter's flutes; ``bodies`` are their names with the heights [mm] they begin at."""

    bodies: tuple[tuple[str, float], ...] = ()

    def called(self, height: float) -> str:
        """The body at a height [mm]; the one above where two meet."""
        return [self.bodies[0][0], *(name for name, bottom in self.bodies if bottom <= height + _SAME)][-1]


def holder(bottom: float, sections: Sequence[Section]) -> Holder:
    """Cones on one another: lower diameter, upper diameter and length [mm] of each, from the height ``bottom`` [mm] up.

    Its frame is the cutter's. Raises InputError for what no body can be.
    """
    return _stacked([Element((0.0, bottom), (0.5 * sections[0][0], bottom))], [("holder", sections)])


def standing_on(
    cutter: Profile, flute_length: float | None, bodies: Sequence[tuple[str, Sequence[Section]]]
) -> Holder | None:
    """What stands above a cutter's flutes: its own upper part where they end below its top, then named bodies.

    None where there is nothing. Raises InputError for what no body can be, and flutes longer than the cutter.
    """
    if flute_length is not None and abs(flute_length - cutter.height) > _SAME:
        return _stacked(above_flutes(cutter, flute_length), bodies, upper=((UPPER, flute_length),))
    if not bodies:
        return None
    return _stacked([Element((0.0, cutter.height), (0.5 * bodies[0][1][0][0], cutter.height))], bodies)


def _stacked(
    start: Sequence[Element], bodies: Sequence[tuple[str, Sequence[Section]]], upper: tuple[tuple[str, float], ...] = ()
) -> Holder:
    """Bodies on a wall that begins on the axis."""
    elements, named, (radius, z) = list(start), list(upper), start[-1].end
    for name, sections in bodies:
        named.append((name, z))
        for lower, above, length in sections:
            elements += [Element((radius, z), (0.5 * lower, z)), Element((0.5 * lower, z), (0.5 * above, z + length))]
            radius, z = 0.5 * above, z + length
    elements.append(Element((radius, z), (0.0, z)))
    there = [e for e in elements if abs(e.start[0] - e.end[0]) + abs(e.start[1] - e.end[1]) > _SAME]
    return Holder("holder", tuple(there), tuple(named))
