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
        """Unit normals out of the material, shape (..., 3); nan where the surface degenerates and has none."""
        n = np.cross(self.ru, self.rv)
        with np.errstate(invalid="ignore"):
            return self.orientation * n / np.linalg.norm(n, axis=-1, keepdims=True)

    def first_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """First fundamental form E = r_u.r_u, F = r_u.r_v, G = r_v.r_v, each of shape (...)."""
        return _dot(self.ru, self.ru), _dot(self.ru, self.rv), _dot(self.rv, self.rv)

    def second_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """Second fundamental form L = n.r_uu, M = n.r_uv, N = n.r_vv, each of shape (...)."""
        n = self.normal
        return _dot(n, self.ruu), _dot(n, self.ruv), _dot(n, self.rvv)

    def normal_rates(self) -> tuple[NDArray, NDArray]:
        """Derivatives n_u and n_v of the unit normal, shape (..., 3): the normal of r_u x r_v's derivative."""
        size = np.linalg.norm(np.cross(self.ru, self.rv), axis=-1, keepdims=True)
        n = self.normal
        by_u = np.cross(self.ruu, self.rv) + np.cross(self.ru, self.ruv)
        by_v = np.cross(self.ruv, self.rv) + np.cross(self.ru, self.rvv)
        nu, nv = (self.orientation * d / size for d in (by_u, by_v))
        return nu - _dot(nu, n)[..., None] * n, nv - _dot(nv, n)[..., None] * n

    def curvature(self) -> Curvature:
        """Curvatures from the second fundamental form."""
        return fundamental_curvature(self.ru, self.rv, *self.second_form())


@dataclass(frozen=True)
class Curvature:
    """Gaussian [1/mm²] and mean [1/mm] curvature, principal ones (k1 >= k2) and their unit directions.

    Sign: kappa = -(dr . dn)/(dr . dr), so a ball with its normal outward has -1/R. Directions are unit
    tangents of no particular sense. Mohr's circle: over all directions the pair (normal curvature, geodesic
    torsion) runs round a circle about (``mean``, 0) with the radius ``spread``.
    """

    gaussian: NDArray
    mean: NDArray
    k1: NDArray
    k2: NDArray
    direction1: NDArray
    direction2: NDArray

    @property
    def spread(self) -> NDArray:
        """Half the difference of the principal curvatures [1/mm]: the radius of Mohr's circle."""
        return 0.5 * (self.k1 - self.k2)

    def normal_curvature(self, direction: NDArray) -> NDArray:
        """Normal curvature [1/mm] along tangent vectors of any length, shape (..., 3) (Euler; Litvin 67)."""
        a, b = _dot(direction, self.direction1), _dot(direction, self.direction2)
        return (self.k1 * a * a + self.k2 * b * b) / (a * a + b * b)

    def geodesic_torsion(self, direction: NDArray, normal: NDArray) -> NDArray:
        """Geodesic torsion [1/mm] along tangent vectors, seen from the unit normal, both shape (..., 3).

        Litvin's surface torsion (68), (103), (121): t = (k2 - k1) sin q cos q with q from direction1 to the
        tangent, positive about the normal ("Bonnet-Germain"; 68 is printed "Bonnet-German" and leaves the
        sense of q open). It does not change with the sign of the normal: q and the curvatures both do.
        """
        a, b = _dot(direction, self.direction1), _dot(normal, np.cross(self.direction1, direction))
        return (self.k2 - self.k1) * a * b / (a * a + b * b)


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


def rodrigues_curvature(ru: NDArray, rv: NDArray, nu: NDArray, nv: NDArray, normal: NDArray) -> Curvature:
    """Curvatures from Rodrigues' formula, dn = -k dr along principal directions; all shape (..., 3).

    n_u + k r_u and n_v + k r_v are then parallel; along the unit normal n their cross product reads
        k² n.(r_u x r_v) + k n.(r_u x n_v + n_u x r_v) + n.(n_u x n_v) = 0,
    which is Zhou 2.62 freed from his choice of the z axis (singular where n_z = 0). Both vectors lie along
    the *other* principal direction. As roots of a quadratic, k1 and k2 keep half the digits near umbilics;
    `weingarten_curvature` keeps all.
    """
    size = _dot(normal, np.cross(ru, rv))
    mean = -0.5 * _dot(normal, np.cross(ru, nv) + np.cross(nu, rv)) / size
    gaussian = _dot(normal, np.cross(nu, nv)) / size
    spread = np.sqrt(np.maximum(mean * mean - gaussian, 0.0))
    k1, k2 = mean + spread, mean - spread
    by_u, by_v = nu + k1[..., None] * ru, nv + k1[..., None] * rv
    size_u, size_v = _dot(by_u, by_u), _dot(by_v, by_v)
    other = np.where((size_u >= size_v)[..., None], by_u, by_v)
    umbilic = np.maximum(size_u, size_v) <= 1e-24 * (_dot(nu, nu) + _dot(nv, nv))
    other = np.where(umbilic[..., None], ru, other)
    d2 = other / np.linalg.norm(other, axis=-1, keepdims=True)
    return Curvature(gaussian, mean, k1, k2, np.cross(d2, normal), d2)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
