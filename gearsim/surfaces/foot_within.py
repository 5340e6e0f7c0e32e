"""Points of a NURBS surface, its border and corners among them, nearest to points that may lie off it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.nurbs import SurfaceDerivatives, surface_derivatives
from gearsim.surfaces.nurbs import NurbsSurface

_STEPS = 12
_STILL_MM = 1e-11
_FULL = 1.0 - 1e-9


def foot_within(
    surface: NurbsSurface, points: NDArray, u: NDArray, v: NDArray
) -> tuple[NDArray, NDArray, NDArray, NDArray]:
    """Parameters (n,) from guesses u, v, distances [mm] of ``points`` (n, 3), and heights [mm] along the normals there.

    By Newton's method, along the border where the nearest point lies on it: exact for points near the surface. Inside
    the material and farther off than its radius of curvature it may be the guess itself.
    """
    (low_u, high_u), (low_v, high_v) = surface.domain
    first, live = (u, v), np.arange(len(points))
    u, v = u.copy(), v.copy()
    for _ in range(_STEPS):
        if not len(live):
            break
        d = surface_derivatives(*surface.along, surface.net, u[live], v[live])
        miss = points[live] - d.r
        p, q = _dot(d.ru, miss), _dot(d.rv, miss)
        e, f, g = _bending(d, miss)
        stop_u = ((u[live] <= low_u) & (p < 0.0)) | ((u[live] >= high_u) & (p > 0.0))
        stop_v = ((v[live] <= low_v) & (q < 0.0)) | ((v[live] >= high_v) & (q > 0.0))
        det = e * g - f * f
        step_u = np.where(stop_u, 0.0, np.where(stop_v, p / e, (g * p - f * q) / det))
        step_v = np.where(stop_v, 0.0, np.where(stop_u, q / g, (e * q - f * p) / det))
        new_u, new_v = np.clip(u[live] + step_u, low_u, high_u), np.clip(v[live] + step_v, low_v, high_v)
        moved = np.abs(new_u - u[live]) * np.sqrt(e) + np.abs(new_v - v[live]) * np.sqrt(g)
        u[live], v[live] = new_u, new_v
        live = live[moved > _STILL_MM]
    off = points - surface.at(u, v)
    astray = _dot(off, off) > _dot(points - surface.at(*first), points - surface.at(*first))
    u, v = np.where(astray, first[0], u), np.where(astray, first[1], v)
    jet = surface.jet(u, v)
    off = points - jet.r
    return u, v, np.linalg.norm(off, axis=1), _dot(off, jet.normal)


def _bending(d: SurfaceDerivatives, miss: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Second derivatives of half the squared distance, or what of them is positive for certain."""
    e, f, g = _dot(d.ru, d.ru), _dot(d.ru, d.rv), _dot(d.rv, d.rv)
    a, b, c = e - _dot(d.ruu, miss), f - _dot(d.ruv, miss), g - _dot(d.rvv, miss)
    good = (a > 0.1 * e) & (a * c - b * b > 0.1 * (e * g - f * f))
    e, f, g = np.where(good, a, e), np.where(good, b, f), np.where(good, c, g)
    e, g = np.maximum(e, 1e-300), np.maximum(g, 1e-300)
    return e, np.clip(f, -_FULL * np.sqrt(e * g), _FULL * np.sqrt(e * g)), g


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
