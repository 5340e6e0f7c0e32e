"""NURBS surfaces: any degree, rational, with normals and curvatures at regular points, umbilics and poles."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry.jets import Curvature, fundamental_curvature
from gearsim.geometry.nurbs import BSplineBasis, SurfaceDerivatives, finite_numbers, surface_derivatives, surface_points
from gearsim.surfaces.nurbs_poles import COINCIDE, PoleRefiner
from gearsim.surfaces.patch import Jet, Way

_SINGULAR = 1e-12
_ROUNDING = 1e-12
_WINDOW = 0.1


@dataclass(frozen=True, eq=False)
class NurbsJet:
    """Points r(u, v) [mm] with derivatives, each of shape (n, 3); nan outside the domain.

    ``normal``: unit normals out of the material. ``limits``: indices of points where r_u x r_v vanishes, with the
    curvature to take there.
    """

    r: NDArray
    ru: NDArray
    rv: NDArray
    ruu: NDArray
    ruv: NDArray
    rvv: NDArray
    normal: NDArray
    limits: tuple[tuple[NDArray[np.intp], Curvature], ...] = ()

    def second_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """L, M, N of the second fundamental form, shape (n,): the second derivatives along the normal."""
        return _dot(self.normal, self.ruu), _dot(self.normal, self.ruv), _dot(self.normal, self.rvv)

    def curvature(self) -> Curvature:
        """Curvatures [1/mm], positive where concave as seen from the normal; nan where they have no limit.

        By the symmetric problem in an orthonormal tangent frame: Khan's (4.21), (4.22) give nan at umbilics and his
        (4.35), (4.36) lose the directions.
        """
        with np.errstate(all="ignore"):
            found = fundamental_curvature(self.ru, self.rv, *self.second_form())
        for index, limit in self.limits:
            for quantity in fields(Curvature):
                getattr(found, quantity.name)[index] = getattr(limit, quantity.name)
        return found


def shape_tensor(jet: Jet, e1: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The curvature tensor (k11, k12, k22) [1/mm], each (n,), in the tangent basis e1, e2 = n x e1.

    Positive where the surface is concave as seen from its normal n, the sign of `Curvature` (kappa = n.r'' by arc
    length), so nothing is turned round. ``e1``: tangent vectors of any length, shape (n, 3) or (3,).
    """
    curvature, e2 = jet.curvature(), np.cross(jet.normal, e1)
    a1, b1 = _unit(_dot(curvature.direction1, e1), _dot(curvature.direction2, e1))
    a2, b2 = _unit(_dot(curvature.direction1, e2), _dot(curvature.direction2, e2))
    k1, k2 = curvature.k1, curvature.k2
    return k1 * a1 * a1 + k2 * b1 * b1, k1 * a1 * a2 + k2 * b1 * b2, k1 * a2 * a2 + k2 * b2 * b2


@dataclass(frozen=True, eq=False)
class NurbsSurface:
    """A rational B-spline surface.

    | field | meaning |
    | --- | --- |
    | degree_u, degree_v | degrees (orders less one) |
    | knots_u, knots_v | full knot vectors: number of points + degree + 1 |
    | points | control points [mm], shape (m, n, 3): u runs along the first axis |
    | weights | positive, shape (m, n); 1 where not given |
    | flip | False: r_u x r_v points out of the material; True: into it |
    | window | how far [mm] to look for the machined surface; 0: a tenth of the net's size |

    Raises InputError for counts that do not fit, knots that fall, weights that are not positive, numbers that are not
    finite and nets that span no surface.
    """

    degree_u: int
    degree_v: int
    knots_u: NDArray[np.floating]
    knots_v: NDArray[np.floating]
    points: NDArray[np.floating]
    weights: NDArray[np.floating] = field(default_factory=lambda: np.ones((1, 1)))
    flip: bool = False
    name: str = "surface"
    window: float = 0.0
    blank: None = None

    def __post_init__(self) -> None:
        points = finite_numbers(self.points, "control points", 3)
        weights = finite_numbers(self.weights, "weights", 2)
        if points.shape[2] != 3 or min(points.shape) < 2:
            raise InputError(f"control points must have shape (m, n, 3), m and n at least 2; got {points.shape}")
        if weights.shape not in ((1, 1), points.shape[:2]):
            raise InputError(f"weights must be one for each control point, {points.shape[:2]}; got {weights.shape}")
        if not np.all(weights > 0.0):
            i, j = np.argwhere(weights <= 0.0)[0]
            raise InputError(f"weights must be positive, got {weights[i, j]:g} in row {i + 1}, column {j + 1}")
        for basis, count, axis in zip(self.along, points.shape[:2], ("rows", "columns"), strict=True):
            if basis.count != count:
                raise InputError(
                    f"{len(basis.knots)} knots in {basis.direction} and degree {basis.degree} make {basis.count} "
                    f"{axis} of control points, got {count}: {count + basis.degree + 1} knots would be right"
                )
            object.__setattr__(self, f"knots_{basis.direction}", basis.knots)
        sizes = np.linalg.svd(points.reshape(-1, 3) - points.mean(axis=(0, 1)), compute_uv=False)
        if sizes[1] <= COINCIDE * max(sizes[0], np.abs(points).max()):
            raise InputError("the control points span no surface: they lie on a line or in a point")
        object.__setattr__(self, "points", points)
        object.__setattr__(self, "weights", np.broadcast_to(weights, points.shape[:2]).copy())

    @cached_property
    def along(self) -> tuple[BSplineBasis, BSplineBasis]:
        """The bases in u and v."""
        return BSplineBasis(self.degree_u, self.knots_u, "u"), BSplineBasis(self.degree_v, self.knots_v, "v")

    @property
    def domain(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """Limits of u and of v."""
        return self.along[0].domain, self.along[1].domain

    @cached_property
    def net(self) -> NDArray:
        """Homogeneous control points (w x, w y, w z, w), shape (m, n, 4)."""
        w = self.weights[..., None]
        return np.concatenate([w * self.points, w], axis=-1)

    @cached_property
    def size(self) -> float:
        """Diagonal [mm] of the box round the control points, which holds the surface."""
        return float(np.linalg.norm(np.ptp(self.points.reshape(-1, 3), axis=0)))

    @property
    def orientation(self) -> float:
        """+1 or -1: turns r_u x r_v out of the material."""
        return -1.0 if self.flip else 1.0

    @cached_property
    def _poles(self) -> PoleRefiner:
        return PoleRefiner(self.along, self.points, self.weights, self.orientation)

    def jet(self, u: ArrayLike, v: ArrayLike) -> NurbsJet:
        """The surface at u, v of shape (n,); nan outside the domain."""
        u, v = self.inside(u, v)
        return self.complete(u, v, surface_derivatives(*self.along, self.net, u, v))

    def at(self, u: ArrayLike, v: ArrayLike) -> NDArray:
        """The surface's points at u, v of shape (n,) as ``jet`` has them, shape (n, 3); nan outside the domain."""
        return surface_points(*self.along, self.net, *self.inside(u, v))

    def inside(self, u: ArrayLike, v: ArrayLike) -> tuple[NDArray, NDArray]:
        """u and v, shape (n,), both nan where one is outside the domain by more than rounding."""
        outside, placed = np.False_, []
        for x, (low, high) in zip((u, v), self.domain, strict=True):
            clipped = np.clip(np.asarray(x, dtype=float), low, high)
            outside = outside | ~(np.abs(clipped - x) <= _ROUNDING * (high - low))
            placed.append(clipped)
        return np.where(outside, np.nan, placed[0]), np.where(outside, np.nan, placed[1])

    def complete(self, u: NDArray, v: NDArray, found: SurfaceDerivatives) -> NurbsJet:
        """The jet of derivatives found at u, v (here or on a device), with normals and limits at singular points.

        Where r_u x r_v vanishes, the normal is that of a step towards the middle of the domain; on a pole of a smooth
        surface every step gives the same. Curvatures are nan there, but for such poles.
        """
        limits = list(self._poles.refine(u, v, found))
        normal = np.cross(found.ru, found.rv)
        (u0, u1), (v0, v1) = self.domain
        length = np.linalg.norm(normal, axis=1)
        singular = np.flatnonzero(length <= _SINGULAR * self.size**2 / ((u1 - u0) * (v1 - v0)))
        if len(singular):
            at = SurfaceDerivatives(*(x[singular] for x in found))
            by_u = np.cross(at.ruu, at.rv) + np.cross(at.ru, at.ruv)
            by_v = np.cross(at.ruv, at.rv) + np.cross(at.ru, at.rvv)
            step_u, step_v = 0.5 * (u0 + u1) - u[singular], 0.5 * (v0 + v1) - v[singular]
            normal[singular] = step_u[:, None] * by_u + step_v[:, None] * by_v
            length[singular] = np.linalg.norm(normal[singular], axis=1)
            limits.insert(0, (singular, Curvature(*[np.array(np.nan)] * len(fields(Curvature)))))
        with np.errstate(invalid="ignore"):
            normal *= (self.orientation / length)[:, None]
        return NurbsJet(*found, normal, tuple(limits))

    @property
    def ways(self) -> tuple[Way, Way]:
        """Along both parameters."""
        return Way("u [share of the domain]"), Way("v [share of the domain]")

    def locate(self, length: ArrayLike, height: ArrayLike) -> tuple[NDArray, NDArray]:
        """Parameters of fractions, 0 to 1, of the domain along u and along v."""
        fractions = np.broadcast_arrays(np.asarray(length, dtype=float), np.asarray(height, dtype=float))
        u, v = (low + x * (high - low) for x, (low, high) in zip(fractions, self.domain, strict=True))
        return u, v

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """How far [mm] to look for the machined surface, into the material and out of it."""
        reach = np.full(np.shape(u), self.window or _WINDOW * self.size)
        return reach, reach


def _unit(a: NDArray, b: NDArray) -> tuple[NDArray, NDArray]:
    length = np.hypot(a, b)
    return a / length, b / length


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
