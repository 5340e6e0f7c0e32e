"""What a meridian must satisfy to be a cutter; the first relation that fails, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element

CORNER = 1e-9
_GAP = 1e-9
_CHORDS = 24


def turn(a: Element, b: Element) -> float:
    """Sine of the angle by which the normal turns from the end of a to the start of b; < 0 at a reentrant corner."""
    before, after = a.at(np.array(a.length)), b.at(np.array(0.0))
    return float(before.nr * after.nz - before.nz * after.nr)


def joints(elements: tuple[Element, ...], ring: bool) -> list[tuple[Element, Element]]:
    """Neighbouring elements, in order; of a ring the last and the first too."""
    following = elements[1:] + elements[:1] if ring else elements[1:]
    return list(zip(elements, following, strict=False))


def problem(elements: tuple[Element, ...], ring: bool) -> str | None:
    """The first thing wrong with a chain, or None."""
    return next(_problems(elements, ring), None)


def _problems(elements: tuple[Element, ...], ring: bool) -> Iterator[str]:
    if not elements:
        yield "the profile is empty"
        return
    for e in elements:
        yield from _element_problems(e)
    for a, b in joints(elements, ring):
        if np.hypot(a.end[0] - b.start[0], a.end[1] - b.start[1]) > _GAP:
            yield f"the profile has a gap between {a.end} and {b.start}"
    first, last = elements[0].start, elements[-1].end
    if not ring and max(abs(first[0]), abs(last[0])) > _GAP:
        yield f"the profile must close (a ring) or run from axis to axis; it starts at {first} and ends at {last}"
    outline = _outline(elements)
    if _area(outline) <= 0.0:
        yield "the profile runs the wrong way round: the material must lie on its left, from the tip outward and up"
    if _crosses_itself(outline, ring):
        yield "the profile crosses itself"
    turns = [turn(a, b) for a, b in joints(elements, ring)]
    if ring and min(turns) < -CORNER:
        yield "the meridian of a ring is not convex; only rings with a convex section are supported"
    if not ring:
        yield from (_falls(e) for e in elements if _falls(e))


def _element_problems(e: Element) -> Iterator[str]:
    where = f"profile element {e.start} to {e.end}"
    if not np.all(np.isfinite([*e.start, *e.end, *e.centre, e.radius])) or e.length <= 0.0 or e.radius < 0.0:
        yield f"{where} is empty"
        return
    if e.is_arc:
        off = max(abs(np.hypot(p[0] - e.centre[0], p[1] - e.centre[1]) - e.radius) for p in (e.start, e.end))
        if off > _GAP:
            yield f"{where}: an end lies {off:g} mm off the arc of radius {e.radius:g} mm about {e.centre}"
        if e.angles[1] - e.angles[0] > np.pi + 1e-9:
            yield (
                f"{where}: the arc turns left about {e.centre} by more than 180 deg; a concave arc is not supported, "
                "a longer convex one must be given in two"
            )
    if e.box[0] < -1e-12:
        yield f"{where} reaches r = {e.box[0]:g} mm; r < 0 lies beyond the axis"


def _falls(e: Element) -> str:
    """A chain from axis to axis is the union of convex slabs only if it rises."""
    low = min(e.at(np.array(s)).nr for s in (0.0, 0.5 * e.length, e.length))
    if low >= -1e-9:
        return ""
    return (
        f"profile element {e.start} to {e.end} falls towards the tip; only profiles that rise all along are supported"
    )


def _outline(elements: tuple[Element, ...]) -> NDArray:
    """A polygon along the chain, shape (n, 2): arcs as chords."""
    points = [np.array([elements[0].start])]
    for e in elements:
        p = e.at(np.linspace(0.0, e.length, _CHORDS + 1 if e.is_arc else 2)[1:])
        points.append(np.column_stack([p.r, p.z]))
    return np.concatenate(points)


def _area(outline: NDArray) -> float:
    (r, z), (r1, z1) = outline.T, np.roll(outline, -1, axis=0).T
    return 0.5 * float(np.sum(r * z1 - r1 * z))


def _crosses_itself(outline: NDArray, ring: bool) -> bool:
    """Whether two chords that are no neighbours cross properly."""
    a, b = outline[:-1], outline[1:]

    def side(p: NDArray, q: NDArray, x: NDArray) -> NDArray:
        return np.sign((q - p)[:, None, 0] * (x - p[:, None])[..., 1] - (q - p)[:, None, 1] * (x - p[:, None])[..., 0])

    apart = side(a, b, a[None]) * side(a, b, b[None]) < 0.0
    n = len(a)
    i, j = np.indices((n, n))
    neighbours = (np.abs(i - j) <= 1) | (ring & (np.abs(i - j) == n - 1))
    return bool(np.any(apart & apart.T & ~neighbours))
