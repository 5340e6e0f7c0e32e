"""Poles of a NURBS surface: edges of its net that are one point, where r_u or r_v vanishes and limits must do."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.jets import Curvature, fundamental_curvature
from gearsim.geometry.nurbs import BSplineBasis, SurfaceDerivatives, surface_derivatives

COINCIDE = 1e-12
"""Part of the net's size within which points are one."""
_BESIDE = 1e-2
"""Part of the domain beside a pole in which the pole is made the origin, so that no digits are lost towards it."""
_AT = 1e-8
"""Part of the domain beside a pole in which its curvature stands for that of the point."""
_FAN = np.array([0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95])
_SMOOTH = 1e-6


class Pole(NamedTuple):
    """A collapsed edge: the parameter constant on it (0: u, 1: v), whether at its end, and the point [mm]."""

    axis: int
    at_end: bool
    point: NDArray


class PoleRefiner:
    """Evaluates beside the poles of a surface; ``orientation`` (+1 or -1) turns r_u x r_v out of the material."""

    def __init__(self, along: tuple[BSplineBasis, BSplineBasis], points: NDArray, weights: NDArray, orientation: float):
        self.along, self.points, self.weights, self.orientation = along, points, weights, orientation
        size = np.linalg.norm(np.ptp(points.reshape(-1, 3), axis=0))
        self.poles = []
        for axis, basis in enumerate(along):
            for at_end in (False, True):
                edge = np.take(points, -1 if at_end else 0, axis=axis)
                clamped = basis.knots[-1 if at_end else 0] == basis.domain[at_end]
                if clamped and np.ptp(edge, axis=0).max() <= COINCIDE * size:
                    self.poles.append(Pole(axis, at_end, edge[0]))

    def derivatives(self, pole: Pole, u: NDArray, v: NDArray) -> SurfaceDerivatives:
        """The surface seen from the pole as its origin: r_u (or r_v) is right to its last digits beside the pole."""
        w = self.weights[..., None]
        return surface_derivatives(*self.along, np.concatenate([w * (self.points - pole.point), w], axis=-1), u, v)

    def refine(self, u: NDArray, v: NDArray, found: SurfaceDerivatives) -> Iterator[tuple[NDArray[np.intp], Curvature]]:
        """Replace what was found beside the poles; gives the points on each pole and the limit of their curvature."""
        for pole in self.poles:
            low, high = self.along[pole.axis].domain
            distance = abs((u, v)[pole.axis] - (high if pole.at_end else low)) / (high - low)
            beside = np.flatnonzero(distance < _BESIDE)
            if len(beside):
                for old, new in zip(found, self.derivatives(pole, u[beside], v[beside]), strict=True):
                    old[beside] = new
                found.r[beside] += pole.point
                at = beside[distance[beside] <= _AT]
                yield at, self.limit(pole)

    def limit(self, pole: Pole) -> Curvature:
        """Curvature at a pole, arrays of one row; nan where the surface is not twice smooth there (a cone's apex).

        All lines towards the pole have tangents t and curvatures n.r''/t² there; three of them make the tensor, seven
        show whether there is one.
        """
        low, high = self.along[pole.axis].domain
        other = self.along[1 - pole.axis].domain
        fan = other[0] + _FAN * (other[1] - other[0])
        edge = np.full(len(fan), high if pole.at_end else low)
        d = self.derivatives(pole, *((edge, fan) if pole.axis == 0 else (fan, edge)))
        tangent, second = (d.ru, d.ruu) if pole.axis == 0 else (d.rv, d.rvv)
        with np.errstate(all="ignore"):
            # r_u = (v - end) r_uv beside an end of v, and likewise r_v beside an end of u
            normal = np.cross(d.ru, d.ruv) if pole.axis == 0 else np.cross(d.ruv, d.rv)
            normal *= (-1.0 if pole.at_end else 1.0) * self.orientation
            normal /= np.linalg.norm(normal, axis=1, keepdims=True)
            n = normal.mean(axis=0)
            length = np.linalg.norm(tangent, axis=1)
            e1 = tangent[len(fan) // 2] / length[len(fan) // 2]
            e2 = np.cross(n, e1)
            c, s, bend = tangent @ e1 / length, tangent @ e2 / length, second @ n / length**2
        system = np.stack([c * c, 2.0 * c * s, s * s], axis=1)
        tensor = np.full(3, np.nan)
        if np.isfinite(system).all() and np.abs(normal - n).max() <= _SMOOTH:
            fit, _, rank, _ = np.linalg.lstsq(system, bend, rcond=1e-9)
            if rank == 3 and np.abs(system @ fit - bend).max() <= _SMOOTH * np.abs(bend).max():
                tensor = fit
        return fundamental_curvature(e1[None], e2[None], *tensor[:, None])
