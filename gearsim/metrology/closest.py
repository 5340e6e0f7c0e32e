"""Closest points on a patch of the intended surface: signed distance of any point, without rays."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from gearsim.metrology.samples import SampleGrid
from gearsim.surfaces.patch import Jet

_STEPS = 20
_SETTLED = 1e-12


def signed_distance(grid: SampleGrid, points: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Signed distance [mm] of points, shape (n, 3), to the grid's patch along its outward normal.

    Positive outside the intended material. Returns (distance, phi, v); nan where the foot point leaves
    the grid's range. Newton's method on the squared distance, started from the nearest grid point.
    """
    patch = grid.patch
    flat = grid.point.reshape(-1, 3)
    nearest = cKDTree(flat).query(points)[1]
    phi, v = grid.phi.ravel()[nearest], grid.v.ravel()[nearest]
    step, live = np.full(len(points), np.inf), np.arange(len(points))
    for _ in range(_STEPS):
        jet = patch.jet(phi[live], v[live])
        miss = jet.r - points[live]
        g1, g2 = _dot(miss, jet.ru), _dot(miss, jet.rv)
        height = _dot(miss, jet.normal)
        second = jet.second_form()
        a, b, c = (_dot(p, q) + height * s for (p, q), s in zip(_pairs(jet), second, strict=True))
        det = a * c - b * b
        dphi, dv = (b * g2 - c * g1) / det, (b * g1 - a * g2) / det
        phi[live] += dphi
        v[live] += dv
        step[live] = np.abs(dphi) * np.sqrt(_dot(jet.ru, jet.ru)) + np.abs(dv) * np.sqrt(_dot(jet.rv, jet.rv))
        live = live[step[live] >= _SETTLED]
        if not len(live):
            break
    jet = patch.jet(phi, v)
    distance = _dot(points - jet.r, jet.normal)
    inside = (step < 1e-9) & _between(phi, grid.phi) & _between(v, grid.v)
    return np.where(inside, distance, np.nan), phi, v


def _pairs(jet: Jet) -> list[tuple[NDArray, NDArray]]:
    return [(jet.ru, jet.ru), (jet.ru, jet.rv), (jet.rv, jet.rv)]


def _between(values: NDArray, limits: NDArray) -> NDArray:
    return (values >= limits.min()) & (values <= limits.max())


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
