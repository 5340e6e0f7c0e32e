"""Points of a NURBS surface nearest to given points."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.nurbs import surface_derivatives
from gearsim.surfaces.nurbs import NurbsSurface

_STEPS = 25


def foot(surface: NurbsSurface, point: NDArray, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Parameters (n,) of the points nearest to ``point`` (n, 3) [mm], by Gauss and Newton from guesses; the gap [mm].

    For points on the surface or close to it, to which it converges quadratically; steps end at the domain's border.
    At a pole the parameter without effect stays.
    """
    (u0, u1), (v0, v1) = surface.domain
    u, v = np.clip(u, u0, u1), np.clip(v, v0, v1)
    span = np.array([u1 - u0, v1 - v0])
    for _ in range(_STEPS):
        d = surface_derivatives(*surface.along, surface.net, u, v)
        a, b = d.ru * span[0], d.rv * span[1]
        miss = point - d.r
        e, f, g = _dot(a, a), _dot(a, b), _dot(b, b)
        p, q = _dot(a, miss), _dot(b, miss)
        small = 1e-14 * (e + g) + 1e-300
        e, g = e + small, g + small
        det = e * g - f * f
        step = np.stack([(g * p - f * q) / det, (e * q - f * p) / det]) * span[:, None]
        new = np.clip(u + step[0], u0, u1), np.clip(v + step[1], v0, v1)
        moved = np.max(np.abs(new[0] - u) / span[0] + np.abs(new[1] - v) / span[1], initial=0.0)
        u, v = new
        if moved <= 1e-15:
            break
    at = surface_derivatives(*surface.along, surface.net, u, v).r
    return u, v, np.linalg.norm(point - at, axis=1)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ni,ni->n", a, b)
