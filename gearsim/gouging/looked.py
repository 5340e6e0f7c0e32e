"""A face looked at for gouging: a grid of lines, and its tightest points searched for between them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.profile import Profile
from gearsim.gouging.lines import Lines
from gearsim.gouging.prediction import Prediction, predict_at
from gearsim.metrology.samples import SampleGrid, grid_on_lines
from gearsim.surfaces.face import Face

_CANDIDATES = 24
_STENCIL = 5
_ROUNDS = 24
_INSIDE = 1e-6
_ALIKE = 1e-12  # 1/mm: on planes and cylinders no point is tighter than another


@dataclass(frozen=True)
class FaceLook:
    """One face: its grid with what is predicted there (row-major), and the tightest points between its lines.

    ``held``: whether a grid point lies on the face, (rows, columns); where not, nothing is predicted.
    ``u``, ``v``, ``point`` [mm] and ``tight``: points found by search, (k,), and what is predicted at them.
    """

    face: Face
    lines: Lines
    grid: SampleGrid
    held: NDArray[np.bool_]
    samples: Prediction
    u: NDArray
    v: NDArray
    point: NDArray
    tight: Prediction

    @property
    def decision(self) -> NDArray:
        """`Decision` of every point looked at, on the grid and between its lines, (n,); below zero: out of reach."""
        return np.concatenate([self.samples.decision[self.held.ravel()], self.tight.decision])

    @property
    def reached(self) -> bool:
        return bool(self.samples.touches.any() or self.tight.touches.any())


def look(face: Face, lines: Lines, cutter: Profile, axis: NDArray, device: str = "cpu") -> FaceLook:
    """Predict at the crossings of the lines that lie on the face, then search for less between them."""
    from gearsim.gouging.evaluate import evaluate  # Warp loads with these: who only draws results can do without
    from gearsim.kernels.nurbs import MAX_DEGREE

    u, v = lines.at
    held = face.holds(u, v) if face.loops else np.ones((len(v), len(u)), dtype=bool)
    uu, vv = (x.ravel() for x in np.meshgrid(u, v))
    kernel = max(face.surface.degree_u, face.surface.degree_v) <= MAX_DEGREE
    jet = evaluate(face.surface, uu, vv, device) if kernel else face.surface.jet(uu, vv)
    found = predict_at(jet, cutter, axis)
    samples = Prediction(found.contacts, found.comparison, found.touches & held.ravel())
    least = np.where(samples.touches, found.comparison.least, np.inf).reshape(held.shape)
    tu, tv = _tightest(face, lines, least, lambda a, b: _least_at(face, cutter, axis, a, b))
    at = face.surface.jet(tu, tv)
    return FaceLook(face, lines, grid_on_lines(face.surface, u, v, jet), held, samples, tu, tv, at.r,
                    predict_at(at, cutter, axis))  # fmt: skip


def _least_at(face: Face, cutter: Profile, axis: ArrayLike, u: NDArray, v: NDArray) -> NDArray:
    """The least difference of curvatures [1/mm] at points on the face where the tool touches, else inf."""
    found = predict_at(face.surface.jet(u, v), cutter, axis)
    held = face.holds_points(u, v) if face.loops else np.True_
    return np.where(found.touches & held, found.comparison.least, np.inf)


def _tightest(
    face: Face, lines: Lines, least: NDArray, at: Callable[[NDArray, NDArray], NDArray]
) -> tuple[NDArray, NDArray]:
    """Parameters of the least values about the lowest local minima of a grid: by ever smaller stencils, (k,) each.

    No stencil reaches a break: there the surface is known in a sector only, and judged there.
    """
    rows, columns = _minima(least)
    known = least[np.isfinite(least)]
    if not len(rows) or np.ptp(known) <= _ALIKE:
        return np.empty(0), np.empty(0)
    place, reach, ends = [], [], []
    for k, index in ((0, columns), (1, rows)):
        x, breaks = lines.at[k], lines.breaks[k]
        gap = np.diff(np.concatenate([breaks[:1, 1], x, breaks[-1:, 0]]))
        place.append(x[index])
        reach.append(np.maximum(gap[index], gap[index + 1]))
        after = np.searchsorted(breaks[:, 1], x[index], side="right")
        low, high = breaks[after - 1, 1], breaks[np.minimum(after, len(breaks) - 1), 0]
        low, high = np.maximum(low, lines.ranges[k][0]), np.minimum(high, lines.ranges[k][1])
        ends.append((low + _INSIDE * (high - low), high - _INSIDE * (high - low)))
    value = least[rows, columns]
    steps = np.linspace(-1.0, 1.0, _STENCIL)
    du, dv = (s.ravel() for s in np.meshgrid(steps, steps))
    for _ in range(_ROUNDS):
        tried = [
            np.clip(p[:, None] + r[:, None] * d, low[:, None], high[:, None])
            for p, r, d, (low, high) in zip(place, reach, (du, dv), ends, strict=True)
        ]
        found = at(tried[0].ravel(), tried[1].ravel()).reshape(tried[0].shape)
        best = np.argmin(found, axis=1)
        mine = np.arange(len(best))
        better = found[mine, best] < value
        place = [np.where(better, t[mine, best], p) for t, p in zip(tried, place, strict=True)]
        value = np.where(better, found[mine, best], value)
        reach = [0.5 * r for r in reach]
    return place[0], place[1]


def _minima(least: NDArray) -> tuple[NDArray, NDArray]:
    """Rows and columns of the lowest points that are not above any neighbour."""
    padded = np.pad(least, 1, constant_values=np.inf)
    rows, columns = least.shape
    around = [padded[1 + i : 1 + i + rows, 1 + j : 1 + j + columns] for i in (-1, 0, 1) for j in (-1, 0, 1)]
    low = np.isfinite(least) & (least <= np.min(around, axis=0))
    at = np.flatnonzero(low)
    at = at[np.argsort(least.ravel()[at], kind="stable")[:_CANDIDATES]]
    return np.unravel_index(at, least.shape)  # type: ignore[return-value]
