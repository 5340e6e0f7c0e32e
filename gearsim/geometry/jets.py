"""Surface jets: a point with its derivatives, and the normals and curvatures that follow from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True)
class SurfaceJet:
    """Points r(u, v) [mm] with first and second derivatives, each of shape (..., 3), workpiece frame.

    ``orientation`` (+1 or -1) turns r_u x r_v out of the material.
    """

    r: NDArray
    ru: NDArray
    rv: NDArray
    ruu: NDArray
    ruv: NDArray
    rvv: NDArray
    orientation: float = 1.0

    @property
    def normal(self) -> NDArray:
        """Unit normals out of the material, shape (..., 3)."""
        n = np.cross(self.ru, self.rv)
        return self.orientation * n / np.linalg.norm(n, axis=-1, keepdims=True)

    def curvature(self) -> Curvature:
        """Curvatures from the second fundamental form L = n.r_uu, M = n.r_uv, N = n.r_vv."""
        n = self.normal
        second = (_dot(n, self.ruu), _dot(n, self.ruv), _dot(n, self.rvv))
        return fundamental_curvature(self.ru, self.rv, *second)


@dataclass(frozen=True)
class Curvature:
    """Gaussian [1/mm²] and mean [1/mm] curvature, principal ones (k1 >= k2) and their unit directions.

    Sign: kappa = -(dr . dn)/(dr . dr), so a ball with its normal outward has -1/R.
    """

    gaussian: NDArray
    mean: NDArray
    k1: NDArray
    k2: NDArray
    direction1: NDArray
    direction2: NDArray


def fundamental_curvature(ru: NDArray, rv: NDArray, L: NDArray, M: NDArray, N: NDArray) -> Curvature:
    """Curvatures from tangents, shape (..., 3), and the second fundamental form, shape (...).

    Works in an orthonormal tangent frame, where the shape operator is a symmetric 2 x 2 matrix: no case
    is singular but a degenerate parametrisation (r_u parallel to r_v). Zhou 2.49-2.57; K and H of his
    2.51 are exchanged in print and 2.53 holds for neither (see docs/methods.md).
    """
    lu = np.linalg.norm(ru, axis=-1)
    e1 = ru / lu[..., None]
    along = _dot(rv, e1)
    across = rv - along[..., None] * e1
    lv = np.linalg.norm(across, axis=-1)
    e2 = across / lv[..., None]
    # d/de1 = d/du / lu ; d/de2 = (d/dv - along * d/de1) / lv
    a = L / lu**2
    b = (M / lu - along * a) / lv
    c = (N - 2.0 * along * M / lu + along**2 * a) / lv**2
    mean, half = 0.5 * (a + c), 0.5 * (a - c)
    spread = np.hypot(half, b)
    angle = 0.5 * np.arctan2(b, half)
    d1 = np.cos(angle)[..., None] * e1 + np.sin(angle)[..., None] * e2
    d2 = -np.sin(angle)[..., None] * e1 + np.cos(angle)[..., None] * e2
    return Curvature(a * c - b * b, mean, mean + spread, mean - spread, d1, d2)


def weingarten_curvature(ru: NDArray, rv: NDArray, nu: NDArray, nv: NDArray) -> Curvature:
    """Curvatures of a surface known by its tangents and the derivatives of its unit normal.

    L = -r_u.n_u, M = -(r_u.n_v + r_v.n_u)/2, N = -r_v.n_v (Zhou 2.50).
    """
    return fundamental_curvature(ru, rv, -_dot(ru, nu), -0.5 * (_dot(ru, nv) + _dot(rv, nu)), -_dot(rv, nv))


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
