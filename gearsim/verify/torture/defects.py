"""What the oracle found wrong, ray by ray: lost hits, spanned gaps, ends that are off."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.intervals import IntervalSet
from gearsim.verify.torture import exact
from gearsim.verify.torture.campaign import Tried
from gearsim.verify.torture.judge import CLEAR, HIT, Claim, judge

LOST, SPANNED, END = "lost hit", "spanned gap", "wrong end"
# What lies no deeper than this many times the noise is looked at in 40 digits before it counts.
_NEAR = 8.0
_DEEP = 1e-10
_SEEN, _HALVINGS = 4.0, 12  # tolerances that a gap is followed either way, and to which part of them


@dataclass(frozen=True)
class Defect:
    """One ray: ``kind``, the length [mm] along the ray that is wrong, and whether the tool is off there by more than
    1e-10 mm and 8 times the noise (``deep``); seed, case and ray say which it is."""

    kind: str
    length: float
    deep: bool
    seed: tuple[int, ...]
    ray: int
    names: tuple[str, str, str]


def defects(tried: Tried, tolerance: float) -> list[Defect]:
    """The defects of a case that hold in 40 digits."""
    wrong = np.flatnonzero(tried.lost | tried.spanned)
    if not len(wrong):
        return []
    case = tried.case
    part = Claim(case.rays.part(wrong), case.table, case.cutter, chosen(tried.removal.removed, wrong))
    near = judge([part], tolerance, noise_factor=_NEAR)[0]
    deep = judge([part], tolerance, depth=_DEEP, noise_factor=_NEAR)[0]
    found = []
    for k, ray in enumerate(wrong):
        sure = HIT in (near.lost[k], near.spanned[k])
        if sure or _confirmed(tried, int(ray)):
            kind, length = _kind(tried, int(ray), tolerance)
            names = case.tool, case.motion, str(case.ray_kind[ray])
            is_deep = HIT in (deep.lost[k], deep.spanned[k])
            if kind == SPANNED and not is_deep:
                length = min(length, _gap(tried, int(ray), tolerance))
                if length <= tolerance:  # where all but touching, noise made it look longer
                    continue
            found.append(Defect(kind, length, is_deep, case.seed, int(ray), names))
    return found


def unsettled(tried: Tried, tolerance: float) -> NDArray[np.integer]:
    """Rays that the oracle cannot decide even where the tool may be off by 8 times the noise or 1e-10 mm."""
    open_rays = np.flatnonzero(tried.undecided)
    if not len(open_rays):
        return open_rays
    case = tried.case
    part = Claim(case.rays.part(open_rays), case.table, case.cutter, chosen(tried.removal.removed, open_rays))
    again = judge([part], tolerance, depth=_DEEP, noise_factor=_NEAR)[0]
    return open_rays[(again.lost != CLEAR) | (again.spanned != CLEAR)]


def chosen(removed: IntervalSet, rays: NDArray) -> IntervalSet:
    """The intervals of some rays."""
    count = np.diff(removed.first)[rays]
    rows = np.concatenate([np.arange(removed.first[r], removed.first[r + 1]) for r in rays]).astype(int)
    columns = (getattr(removed, k)[rows] for k in ("lo", "hi", "lo_segment", "hi_segment"))
    return IntervalSet(np.concatenate([[0], np.cumsum(count)]), *columns)


def _kind(tried: Tried, ray: int, tolerance: float) -> tuple[str, float]:
    """An end is wrong where the piece begins at it; what stands alone is lost, or spanned."""
    j, removed = tried.judgement, tried.removal.removed
    own = slice(removed.first[ray], removed.first[ray + 1])
    lo, hi = removed.lo[own], removed.hi[own]
    touch = 1e-3 * tolerance
    if tried.lost[ray]:
        start, end = j.lost_from[ray], j.lost_to[ray]
        joins = np.any(np.abs(hi + tolerance - start) <= touch) or np.any(np.abs(lo - tolerance - end) <= touch)
        return (END if joins else LOST), float(end - start + tolerance * joins)
    start, end = j.spanned_from[ray], j.spanned_to[ray]
    at_start, at_end = np.abs(lo + tolerance - start) <= touch, np.abs(hi - tolerance - end) <= touch
    joins = (at_start | at_end) & ~(at_start & at_end)
    return (END if joins.any() else SPANNED), float(end - start + tolerance)


def _gap(tried: Tried, ray: int, tolerance: float) -> float:
    """Length [mm] of the gap that holds the spanned piece, by 40 digits; no more than a few tolerances are seen."""
    case, start = tried.case, float(tried.judgement.spanned_from[ray])
    line = case.rays.origin[ray], case.rays.direction[ray]
    length = 0.0
    for way in (-1.0, 1.0):
        free, held = 0.0, _SEEN * tolerance
        for _ in range(_HALVINGS):
            middle = 0.5 * (free + held)
            if exact.least_distance(case.cutter, case.table, *line, start + way * middle) > 0:
                free = middle
            else:
                held = middle
        length += free
    return length


def _confirmed(tried: Tried, ray: int) -> bool:
    """Whether 40 digits say the same: the witness pose cuts the lost piece; none comes to the spanned one."""
    case, j = tried.case, tried.judgement
    line = case.rays.origin[ray], case.rays.direction[ray]
    if tried.lost[ray]:
        middle = 0.5 * (j.lost_from[ray] + j.lost_to[ray])
        return bool(exact.distance(case.cutter, case.table, int(j.row[ray]), *line, j.x[ray], middle) < 0)
    return bool(exact.least_distance(case.cutter, case.table, *line, float(j.spanned_from[ray])) > 0)
