"""Borders and corners of compound surfaces, and one-sided tools: tensors that hold in sectors of directions only.

On a smooth border of two patches each sector is pi wide, the period of f: both patches must then be free in the
full circle and the sectors of Khan (8.1), (8.2) only sort the directions. At corners, and where a tool is another
on its two sides (a bottom disc beside its corner, a corner beside the shank), the sectors decide.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.contact import Contact
from gearsim.gouging.compare import Comparison, Decision, compare, decide
from gearsim.gouging.tensors import Tensor

_TURN = 2.0 * np.pi
_SLIVER = 1e-7


@dataclass(frozen=True)
class Sector:
    """A tensor that holds from ``start`` counter-clockwise to ``end`` [rad], start <= end <= start + 2 pi."""

    start: float
    end: float
    tensor: Tensor
    name: str = ""


@dataclass(frozen=True)
class SectorResult:
    """One sector of tool and part: the least f in it [1/mm], its decision, the gouging directions [rad]."""

    tool: str
    part: str
    start: float
    end: float
    least: float
    decision: Decision
    gouging: tuple[tuple[float, float], ...]


def border_sectors(patches: Sequence[Tensor], tangents: Sequence[float], names: Sequence[str] = ()) -> list[Sector]:
    """Patches about a point in counter-clockwise order; patch i lies between tangents[i] and the next one [rad]."""
    count = len(patches)
    labels = names or [f"patch {i + 1}" for i in range(count)]
    ends = [*tangents[1:], tangents[0]]
    widths = [(b - a) % _TURN or _TURN for a, b in zip(tangents, ends, strict=True)]
    return [Sector(a, a + w, t, n) for a, w, t, n in zip(tangents, widths, patches, labels, strict=True)]


def tool_sectors(contact: Contact) -> list[Sector]:
    """A tool's two sides at one contact: the whole circle where they agree, else uphill and downhill halves."""
    around, zero = np.asarray(contact.around, dtype=float), np.zeros(())
    up, down = (Tensor(np.asarray(k, dtype=float), zero, around) for k in (contact.uphill, contact.downhill))
    if float(contact.uphill) == float(contact.downhill):
        return [Sector(0.0, _TURN, up, "tool")]
    quarter = 0.5 * np.pi
    return [Sector(-quarter, quarter, up, "uphill"), Sector(quarter, 3.0 * quarter, down, "downhill")]


def compare_sectors(tools: Iterable[Sector], parts: Iterable[Sector]) -> list[SectorResult]:
    """Compare every tool sector with every part sector where they overlap."""
    parts = list(parts)
    return [
        _result(t, p, start, end, compare(t.tensor, p.tensor))
        for t in tools
        for p in parts
        for start, end in _overlaps((t.start, t.end), (p.start, p.end))
    ]


def least_between(f: Comparison, start: float, end: float) -> float:
    """The least value of f [1/mm] from start to end [rad], both included; f of one contact."""
    if (float(f.worst) - start) % np.pi <= end - start:
        return float(f.least)
    return float(min(f.at(start), f.at(end)))


def gouging_between(f: Comparison, start: float, end: float) -> tuple[tuple[float, float], ...]:
    """The gouging directions [rad] from start to end, as intervals; f of one contact."""
    low, high = (float(x) for x in f.interval)
    if np.isnan(low):
        return ()
    if high - low >= np.pi:
        return ((start, end),)
    first = low + np.pi * np.ceil((start - high) / np.pi)
    found = [(max(start, a), min(end, a + high - low)) for a in first + np.pi * np.arange(4)]
    return tuple((float(a), float(b)) for a, b in found if b > a or (high == low and start <= a <= end))


def _result(tool: Sector, part: Sector, start: float, end: float, f: Comparison) -> SectorResult:
    least = least_between(f, start, end)
    decision = Decision(int(decide(np.asarray(least))))
    gouging = gouging_between(f, start, end) if decision is Decision.GOUGES else ()
    return SectorResult(tool.name, part.name, start, end, least, decision, gouging)


def _overlaps(one: tuple[float, float], other: tuple[float, float]) -> list[tuple[float, float]]:
    """Where two arcs overlap, counted from the second one's start."""
    turns = np.floor((other[0] - one[0]) / _TURN) * _TURN
    shifted = [(one[0] + turns + k * _TURN, one[1] + turns + k * _TURN) for k in range(3)]
    common = [(max(a, other[0]), min(b, other[1])) for a, b in shifted]
    return [(float(a), float(b)) for a, b in common if b - a > 1e-12]


def least_in_sectors(contact: Contact, part: Tensor, start: NDArray, width: NDArray) -> NDArray:
    """The least f [1/mm] of contacts (n,) whose parts are known from ``start`` over ``width`` [rad] only.

    As `compare_sectors` with both sides of the tool, for many contacts at once; nan where there is no contact.
    """
    found = np.full(np.shape(start), np.inf)
    around, zero = np.asarray(contact.around, dtype=float), np.zeros(np.shape(start))
    for middle, meridian in ((0.0, contact.uphill), (np.pi, contact.downhill)):
        f = compare(Tensor(np.asarray(meridian, dtype=float), zero, around), part)
        rim = np.isinf(meridian)
        for turn in (-_TURN, 0.0, _TURN):
            low = np.maximum(start, middle + turn - 0.5 * np.pi)
            high = np.minimum(start + width, middle + turn + 0.5 * np.pi)
            found = np.where(high - low > _SLIVER, np.fmin(found, _least_between(f, rim, low, high)), found)
    return np.where(np.isfinite(around + part.a + part.b + part.c) | np.isinf(around), found, np.nan)


def _least_between(f: Comparison, rim: NDArray, low: NDArray, high: NDArray) -> NDArray:
    """The least of f from low to high [rad], arrays (n,); along a rim (90 deg) only where the tool is sharp."""
    with np.errstate(invalid="ignore"):
        inside = np.mod(f.worst - low + _SLIVER, np.pi) <= high - low + 2.0 * _SLIVER
        smooth = np.where(inside, f.least, np.minimum(f.at(low), f.at(high)))
    along = np.mod(0.5 * np.pi - low + _SLIVER, np.pi) <= high - low + 2.0 * _SLIVER
    return np.where(rim, np.where(along, f.least, np.inf), smooth)
