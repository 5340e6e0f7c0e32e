"""Curves: curvature and torsion in space, and on a surface normal curvature, geodesic curvature and torsion.

Any parameter serves; a prime below is the derivative by it. Signs follow kappa = -(dr . dn)/(dr . dr).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry.jets import SurfaceJet


class Frenet(NamedTuple):
    """A space curve's curvature and torsion [1/mm], shape (...), and its trihedron, each (..., 3).

    Where the curvature is zero the trihedron and the torsion are undefined (nan); so is all at r' = 0.
    """

    curvature: NDArray
    torsion: NDArray
    tangent: NDArray
    principal_normal: NDArray
    binormal: NDArray


def frenet(r1: NDArray, r2: NDArray, r3: NDArray) -> Frenet:
    """From a curve's first three derivatives by any parameter, shape (..., 3) (Litvin 80, 85).

    A right-handed helix has positive torsion.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        across = np.cross(r1, r2)
        size, speed = np.linalg.norm(across, axis=-1), np.linalg.norm(r1, axis=-1)
        tangent, binormal = r1 / speed[..., None], across / size[..., None]
        torsion = _dot(across, r3) / size**2
    return Frenet(size / speed**3, torsion, tangent, np.cross(binormal, tangent), binormal)


class Darboux(NamedTuple):
    """A curve on a surface: trihedron (``tangent``, ``side`` = normal x tangent, ``normal``), each (..., 3),
    and normal curvature, geodesic curvature, geodesic torsion [1/mm], each (...).

    With arc length s (Bonnet-Kovalevski, Litvin 92; his 93 names 92 where it means 79):
        dt/ds = kg d + kn n,   dd/ds = -kg t + tg n,   dn/ds = -kn t - tg d.
    Reversing the normal reverses kn and kg, not tg.
    """

    tangent: NDArray
    side: NDArray
    normal: NDArray
    normal_curvature: NDArray
    geodesic_curvature: NDArray
    geodesic_torsion: NDArray

    @property
    def rotation(self) -> NDArray:
        """Rotation of the trihedron per arc length [rad/mm], shape (..., 3): tg t - kn d + kg n (Litvin 27)."""
        parts = (self.geodesic_torsion, -self.normal_curvature, self.geodesic_curvature)
        return sum(k[..., None] * e for k, e in zip(parts, self[:3], strict=True))


def darboux(velocity: NDArray, acceleration: NDArray, normal: NDArray, normal_rate: NDArray) -> Darboux:
    """From a curve's r' and r'', the surface's unit normal n and n' along the curve, each (..., 3).

    kn = -r'.n'/r'², kg = r''.(n x r')/|r'|³, tg = -n'.(n x r')/r'². No derivative of the surface itself is
    needed, so it serves envelopes too.
    """
    speed2 = _dot(velocity, velocity)
    speed = np.sqrt(speed2)
    side = np.cross(normal, velocity)
    return Darboux(
        velocity / speed[..., None],
        side / speed[..., None],
        normal,
        -_dot(velocity, normal_rate) / speed2,
        _dot(acceleration, side) / (speed * speed2),
        -_dot(normal_rate, side) / speed2,
    )


def surface_curve(jet: SurfaceJet, du: ArrayLike, dv: ArrayLike, ddu: ArrayLike = 0.0, ddv: ArrayLike = 0.0) -> Darboux:
    """A curve u(w), v(w) on a surface, from the derivatives of u and v by w, shape (...).

    Only the geodesic curvature depends on the second derivatives. Litvin 98-101 is the case v = w.
    """
    u1, v1, u2, v2 = (np.asarray(x, dtype=float)[..., None] for x in (du, dv, ddu, ddv))
    nu, nv = jet.normal_rates()
    bend = u1 * u1 * jet.ruu + 2.0 * u1 * v1 * jet.ruv + v1 * v1 * jet.rvv
    acceleration = bend + u2 * jet.ru + v2 * jet.rv
    return darboux(u1 * jet.ru + v1 * jet.rv, acceleration, jet.normal, u1 * nu + v1 * nv)


class PrincipalPair(NamedTuple):
    """Principal curvatures k1 >= k2 [1/mm] and the angle [rad] from the first to a given direction, (...)."""

    k1: NDArray
    k2: NDArray
    angle: NDArray


def principal_from_sections(kn1: ArrayLike, torsion1: ArrayLike, kn2: ArrayLike, mu: ArrayLike) -> PrincipalPair:
    """Litvin's problem 1: principal curvatures from two normal curvatures and one geodesic torsion [1/mm].

    ``mu`` [rad] leads from direction 1 to direction 2, positive about the normal; ``angle`` leads from the
    first principal direction to direction 1. On Mohr's circle kn = m + D cos 2q and t = -D sin 2q, hence
        D cos 2q1 = (kn1 - kn2 + t1 sin 2mu)/(1 - cos 2mu),   D sin 2q1 = -t1.
    Litvin 104-106 say the same with tan q and cot q, singular along principal directions, and leave open
    which curvature is which; he assigns them to the given directions, where they belong to the principal ones.
    Raises InputError where the two directions are parallel.
    """
    kn1, t1, kn2, mu = (np.asarray(x, dtype=float) for x in (kn1, torsion1, kn2, mu))
    across = 2.0 * np.sin(mu) ** 2
    if np.any(across < 1e-24):
        raise InputError("the two directions are parallel: mu must not be a multiple of 180 deg")
    along = (kn1 - kn2 + t1 * np.sin(2.0 * mu)) / across
    mean, spread = kn1 - along, np.hypot(along, t1)
    return PrincipalPair(mean + spread, mean - spread, 0.5 * np.arctan2(-t1, along))


def second_torsion(kn1: ArrayLike, torsion1: ArrayLike, kn2: ArrayLike, mu: ArrayLike) -> NDArray:
    """Litvin's problem 2: geodesic torsion along a second direction, t2 = (kn2 - kn1) cot mu - t1 (69, 107).

    ``mu`` [rad] as in `principal_from_sections`. Raises InputError where the two directions are parallel.
    """
    kn1, t1, kn2, mu = (np.asarray(x, dtype=float) for x in (kn1, torsion1, kn2, mu))
    if np.any(np.abs(np.sin(mu)) < 1e-12):
        raise InputError("the two directions are parallel: mu must not be a multiple of 180 deg")
    return (kn2 - kn1) * np.cos(mu) / np.sin(mu) - t1


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
