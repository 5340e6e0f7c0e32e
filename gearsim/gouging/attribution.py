"""Overcut laid at the door of the contact that made it, and set against what the curvatures predicted there.

On the straight way (in u, v) from the contact to the sample the tool either becomes clear of the surface first: then it
hits with another part of itself, elsewhere (global gouging, counted apart). Or it does not: then somewhere on the way
the part must curve more than the tool, f < 0, for the clearance is the double integral of f. Tracing the deepest
cut leads to the border of the region predicted to gouge, where f(contact) = 0: all contacts inside cut less deep there.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.gouging.compare import Decision
from gearsim.gouging.prediction import predict
from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.motion.segments import SegmentTable
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.toolpaths.sculptured import SculpturedPath

_STEPS = 48
_PLANES = 13  # about a tool
_SURE = 1e-6  # mm, more than rounding


class Cause(IntEnum):
    """Why a sample is overcut. UNPREDICTED: straight on from its contact, though nothing on the way is to gouge."""

    NONE = 0
    LOCAL = 1
    TIE = 2
    GLOBAL = 3
    UNPREDICTED = 4
    UNKNOWN = 5


@dataclass(frozen=True)
class Attribution:
    """Of every sample, shape (n,): its ``cause``, the ``contact`` of the path (-1), the way to it ``apart`` [mm]."""

    cause: NDArray[np.integer]
    contact: NDArray[np.integer]
    apart: NDArray

    def count(self, cause: Cause) -> int:
        return int(np.count_nonzero(self.cause == cause))


def attribute(
    surface: NurbsSurface, cutter: Profile, path: SculpturedPath, table: SegmentTable,
    deviation: Deviation, at: tuple[NDArray, NDArray], tolerance: float,
) -> Attribution:  # fmt: skip
    """Causes of overcut deeper than ``tolerance`` [mm] at samples, their parameters ``at`` and deviations (n,)."""
    n = len(deviation.value)
    cause, contact, apart = np.zeros(n, dtype=int), np.full(n, -1), np.full(n, np.nan)
    cause[deviation.crossing == Crossing.THROUGH] = Cause.UNKNOWN
    with np.errstate(invalid="ignore"):
        over = np.flatnonzero(deviation.value < -tolerance)
    if not len(over):
        return Attribution(cause, contact, apart)
    ends = segment_ends(path, table)[deviation.segment[over]]
    point = surface.jet(at[0][over], at[1][over]).r
    clear = np.stack([tool_distance(cutter, path.touches.tip[e], point) for e in ends.T], axis=1)
    contact[over] = ends[np.arange(len(over)), np.argmin(clear, axis=1)]
    u, v = _ways(path, contact[over], (at[0][over], at[1][over]))
    on_way = surface.jet(u.ravel(), v.ravel()).r.reshape(*u.shape, 3)
    parted = np.any(tool_distance(cutter, path.touches.tip[contact[over], None], on_way) > tolerance, axis=1)
    decision = predict(surface, cutter, u.ravel(), v.ravel()).decision.reshape(u.shape).max(axis=1)
    apart[over] = np.linalg.norm(point - path.touches.point[contact[over]], axis=1)
    cause[over] = np.select(
        [parted, decision == Decision.GOUGES, decision == Decision.TIE], [Cause.GLOBAL, Cause.LOCAL, Cause.TIE],
        default=Cause.UNPREDICTED,
    )  # fmt: skip
    return Attribution(cause, contact, apart)


def segment_ends(path: SculpturedPath, table: SegmentTable) -> NDArray:
    """The contacts, indices into the path, between which each segment of its table moves, shape (m, 2)."""
    runs = path.runs
    first = np.cumsum([0, *(len(r) for r in runs)])
    start = np.concatenate(runs)[first[table.path] + table.piece]
    return np.stack([start, start + 1], axis=1)


def tool_distance(cutter: Profile, tip: NDArray, point: NDArray) -> NDArray:
    """Signed distance [mm] of points to the tool with its tip at ``tip`` and its axis +z, by broadcasting."""
    away = point - tip
    return cutter.signed_distance(np.hypot(away[..., 0], away[..., 1]), away[..., 2])


def nearest_moves(cutter: Profile, start: NDArray, end: NDArray, point: NDArray) -> tuple[NDArray, NDArray]:
    """Pairs of points (n, 3) and straight moves (m, 3) that may come nearest to them: no other pair can be nearer."""
    length = np.linalg.norm(end - start, axis=1)
    bound = _bound(cutter, start, point[:, None])
    closest = tool_distance(cutter, start[np.argmin(bound, axis=1)], point)
    at, move = np.nonzero(bound - length <= closest[:, None] + _SURE)
    distance, least = tool_distance(cutter, start[move], point[at]), np.full(len(point), np.inf)
    np.minimum.at(least, at, distance)
    may = distance - length[move] <= least[at] + 1e-9
    return at[may], move[may]


def _bound(cutter: Profile, tip: NDArray, point: NDArray) -> NDArray:
    """What the tool's signed distance [mm] is not below, as `tool_distance`: that of planes which it does not cross."""
    away = point - tip
    r, z = np.hypot(away[..., 0], away[..., 1]), away[..., 2]
    least = np.full(r.shape, -np.inf)
    for angle in np.linspace(-0.5 * np.pi, 0.5 * np.pi, _PLANES):
        nr, nz = np.cos(angle), np.sin(angle)
        ends = [nr * e.centre[0] + nz * e.centre[1] + e.radius if e.is_arc else
                max(nr * p[0] + nz * p[1] for p in (e.start, e.end)) for e in cutter.elements]  # fmt: skip
        np.maximum(least, nr * r + nz * z - max(ends), out=least)
    return least


def straight_distance(cutter: Profile, start: NDArray, end: NDArray, point: NDArray) -> NDArray:
    """Least signed distance [mm] of points to a convex tool that moves straight, axis +z: convex in time, so halved."""
    low, high = np.zeros(len(point)), np.ones(len(point))
    for _ in range(70):
        third = (high - low) / 3.0
        a, b = low + third, high - third
        falls = tool_distance(cutter, start + a[:, None] * (end - start), point) > tool_distance(
            cutter, start + b[:, None] * (end - start), point
        )
        low, high = np.where(falls, a, low), np.where(falls, high, b)
    return tool_distance(cutter, start + (0.5 * (low + high))[:, None] * (end - start), point)


def _ways(path: SculpturedPath, contact: NDArray, at: tuple[NDArray, NDArray]) -> tuple[NDArray, NDArray]:
    """Parameters (n, k) straight from contacts to samples, closer near the contacts."""
    share = np.linspace(0.0, 1.0, _STEPS + 1) ** 2
    starts = path.touches.u[contact][:, None], path.touches.v[contact][:, None]
    u, v = (start + share * (end[:, None] - start) for start, end in zip(starts, at, strict=True))
    return u, v
