"""Closest points on a patch of the intended surface: signed distance of any point, without rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.samples import SampleGrid
from gearsim.surfaces.patch import Jet

_STEPS = 20
_SETTLED = 1e-12


def signed_distance(
    grid: SampleGrid, points: NDArray, within: float = np.inf
) -> tuple[NDArray, NDArray, NDArray]:  # fmt: skip
    """Signed distance [mm] of points, shape (n, 3), to the grid's patch along its outward normal.

    Positive outside the intended material. Returns (distance, u, v); nan where the foot point leaves
    the grid's range, and where the point is farther from the patch than ``within`` [mm] for certain. Newton's method
    on the squared distance, started from the nearest grid point.
    """
    from gearsim.envelope.nearby import PointCloud

    patch = grid.patch
    nearest = PointCloud(grid.point.reshape(-1, 3)).nearest(points, np.full(len(points), within + _cell(grid)))
    u, v = (np.append(c.ravel(), np.nan)[nearest] for c in (grid.u, grid.v))
    step, live = np.full(len(points), np.inf), np.flatnonzero(nearest >= 0)
    for _ in range(_STEPS):
        jet = patch.jet(u[live], v[live])
        miss = jet.r - points[live]
        g1, g2 = _dot(miss, jet.ru), _dot(miss, jet.rv)
        height = _dot(miss, jet.normal)
        second = jet.second_form()
        a, b, c = (_dot(p, q) + height * s for (p, q), s in zip(_pairs(jet), second, strict=True))
        det = a * c - b * b
        du, dv = (b * g2 - c * g1) / det, (b * g1 - a * g2) / det
        u[live] += du
        v[live] += dv
        step[live] = np.abs(du) * np.sqrt(_dot(jet.ru, jet.ru)) + np.abs(dv) * np.sqrt(_dot(jet.rv, jet.rv))
        live = live[step[live] >= _SETTLED]
        if not len(live):
            break
    done = np.flatnonzero((step < 1e-9) & _between(u, grid.u) & _between(v, grid.v))
    distance = np.full(len(points), np.nan)
    jet = patch.jet(u[done], v[done])
    distance[done] = _dot(points[done] - jet.r, jet.normal)
    return distance, u, v


def _cell(grid: SampleGrid) -> float:
    """More than how far [mm] a point of the patch inside the grid can be from the nearest grid point."""
    steps = [np.linalg.norm(np.diff(grid.point, axis=axis), axis=-1) for axis in (0, 1)]
    return sum(float(np.nanmax(s, initial=0.0)) for s in steps)


def _pairs(jet: Jet) -> list[tuple[NDArray, NDArray]]:
    return [(jet.ru, jet.ru), (jet.ru, jet.rv), (jet.rv, jet.rv)]


def _between(values: NDArray, limits: NDArray) -> NDArray:
    return (values >= limits.min()) & (values <= limits.max())


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
