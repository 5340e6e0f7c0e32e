"""Shank and holder above a cutter: a profile that must cut nothing."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile

_SAME = 1e-9


def holder(bottom: float, sections: Sequence[tuple[float, float, float]]) -> Profile:
    """Cones on one another: lower diameter, upper diameter and length [mm] of each, from the height ``bottom`` [mm] up.

    Its frame is the cutter's. Raises InputError for what no body can be.
    """
    points, z = [(0.0, bottom)], bottom
    for lower, upper, length in sections:
        points += [(0.5 * lower, z), (0.5 * upper, z + length)]
        z += length
    points.append((0.0, z))
    apart = [a for a, b in pairwise(points) if abs(a[0] - b[0]) + abs(a[1] - b[1]) > _SAME] + points[-1:]
    return Profile("holder", tuple(Element(a, b) for a, b in pairwise(apart)))
