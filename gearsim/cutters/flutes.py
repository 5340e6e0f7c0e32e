"""A cutter parted where its flutes end: what cuts below, what only follows above."""

from __future__ import annotations

import numpy as np

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError

_SAME = 1e-9


def fluted(cutter: Profile, length: float) -> Profile:
    """A cutter up to ``length`` [mm] over its tip, where its flutes end.

    Raises InputError where there is no such height within it, and for a ring, which has no flutes of a length.
    """
    radius = _radius(cutter, length)
    below = [e for e in (_clipped(e, length, above=False) for e in cutter.elements) if e is not None]
    return Profile(f"{cutter.name}, its flutes", (*below, Element((radius, length), (0.0, length))))


def above_flutes(cutter: Profile, length: float) -> tuple[Element, ...]:
    """The wall of a cutter above its flutes of ``length`` [mm], from the axis there to the rim of its top.

    Raises InputError as ``fluted`` does.
    """
    radius = _radius(cutter, length)
    above = [e for e in (_clipped(e, length, above=True) for e in cutter.elements) if e is not None]
    return (Element((0.0, length), (radius, length)), *above)


def _radius(cutter: Profile, length: float) -> float:
    if cutter.is_ring:
        raise InputError(f"flute_length_mm: a {cutter.name} has no flutes of one length; remove the key")
    if not cutter.box[2] + _SAME < length < cutter.height - _SAME:
        raise InputError(
            f"flute_length_mm = {length:g}: expected less than the cutter's height of {cutter.height:g} mm"
        )
    return cutter.radius_at(length)


def _clipped(e: Element, height: float, above: bool) -> Element | None:
    """What of an element lies on one side of a height; None: nothing of it, or it is a disc there or on the top."""
    low, high = e.box[2], e.box[3]
    if (high <= height + _SAME) if above else (low >= height - _SAME):
        return None
    if above and e.is_flat and e.end[0] <= _SAME:
        return None
    if (low >= height - _SAME) if above else (high <= height + _SAME):
        return e
    at = (float(e.widest_at(np.array(height))), height)
    return Element(at, e.end, e.centre, e.radius) if above else Element(e.start, at, e.centre, e.radius)
