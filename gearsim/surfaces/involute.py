"""Flanks of cylindrical gears: involute helicoids, with designed deviations along their normals."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, degrees, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.jets import Curvature, fundamental_curvature
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.patch import Way

_STEEPEST = 1.45  # rad; a normal closer to the middle's direction meets it too far off to matter


@dataclass(frozen=True)
class FlankJet:
    """Points with first and second derivatives by roll and height, and unit normals, each of shape (..., 3)."""

    r: NDArray
    ru: NDArray
    rv: NDArray
    ruu: NDArray
    ruv: NDArray
    rvv: NDArray
    normal: NDArray

    def second_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """L = n.r_uu, M = n.r_uv, N = n.r_vv, each of shape (...)."""
        n = self.normal
        return _dot(n, self.ruu), _dot(n, self.ruv), _dot(n, self.rvv)

    def curvature(self) -> Curvature:
        """Curvatures; infinite or nan at the base circle, where r_u vanishes."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return fundamental_curvature(self.ru, self.rv, *self.second_form())


@dataclass(frozen=True)
class InvoluteFlank:
    """One flank of one space over u = roll angle xi [rad] and v = height z [mm] (a `surfaces.patch.Patch`).

    With theta = f xi + Lambda and Lambda = phi(z) + s f eta_b its points are R_b (e + f xi (sin theta, -cos theta)),
    e = (cos theta, sin theta), and its normal out of the material is n = f s (sin theta cos beta_b, -cos theta
    cos beta_b, sin beta_b) (ISO 21771; Groover 2.22-2.24 print n without f). One principal curvature is 0, along
    the contact line T, the other -s cos(beta_b) / (R_b xi), along e. A modification shifts points along n.

    Raises InputError for a space that is not there or a modification that does not fit the gear.
    """

    gear: CylindricalGear
    side: Side
    space: int = 0
    modification: FlankModification | None = None

    def __post_init__(self) -> None:
        flank_sign(self.side)
        if not 0 <= self.space < self.gear.count:
            raise InputError(f"space must be one of 0 to {self.gear.count - 1}, got {self.space}")
        if self.modification is not None:
            self.modification.check(self.gear)

    @property
    def name(self) -> str:
        return self.side

    @property
    def blank(self) -> None:
        """No blank: a surface of its own, without bounds."""
        return None

    @property
    def ways(self) -> tuple[Way, Way]:
        """Down the facewidth, and up the profile."""
        ends = (degrees(self.gear.root_roll), degrees(self.gear.tip_roll))
        return Way("z along the face [mm]", 0.0, -self.gear.facewidth), Way("roll angle [°], tip up", *ends)

    @property
    def sign(self) -> int:
        """f: +1 for the right flank, -1 for the left one."""
        return flank_sign(self.side)

    @property
    def limits(self) -> tuple[float, float]:
        """Least and largest roll [rad] between the root and the tip circle; what a tool reaches may be less."""
        low, high = sorted((self.gear.root_roll, self.gear.tip_roll))
        return low, high

    def lambda_(self, z: ArrayLike) -> NDArray:
        """Polar angle Lambda [rad] of the flank on the base circle at heights z [mm], any shape."""
        return self.gear.space_centre(self.space, z) + self.gear.sign * self.sign * self.gear.space_half_angle

    def theta(self, u: ArrayLike, z: ArrayLike) -> NDArray:
        """Polar angle [rad] at which the normal through a point touches the base cylinder, shape (...)."""
        return self.sign * np.asarray(u, dtype=float) + self.lambda_(z)

    def axis(self, u: ArrayLike, v: ArrayLike) -> NDArray:
        """Unit direction T of the contact line through points, to the top, shape (..., 3): an end mill's axis."""
        theta = self.theta(u, v)
        c, s = cos(self.gear.base_helix_angle), sin(self.gear.base_helix_angle)
        return np.stack([-np.sin(theta) * s, np.cos(theta) * s, np.full(theta.shape, c)], axis=-1)

    def jet(self, u: ArrayLike, v: ArrayLike) -> FlankJet:
        """Points at rolls u [rad] and heights v [mm], shape (...); the normal holds at the base circle, too."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        pure = self._pure(u, v)
        return pure if self.modification is None else self._modified(pure, u, v, self.modification)

    def locate(self, length: ArrayLike, height: ArrayLike) -> tuple[NDArray, NDArray]:
        """Rolls and heights: ``length`` 0 to 1 from the top to the bottom face, ``height`` from root end to tip end."""
        root, tip = self.gear.root_roll, self.gear.tip_roll
        u = root + (tip - root) * np.asarray(height, dtype=float)
        return u, -self.gear.facewidth * np.asarray(length, dtype=float)

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Lengths [mm] of the normal inside half the tooth and inside half the space, shape (n,).

        Seen along the contact line the normal touches the base circle, and the middle of the space (of the tooth)
        crosses it at the roll y = tan(xi + s eta_b) (minus s psi_b), or hardly ever; one Newton step leads from there
        to the normal's own heights.
        """
        gear, s = self.gear, self.gear.sign
        c, lean = cos(gear.base_helix_angle), sin(gear.base_helix_angle) ** 2 / cos(gear.base_helix_angle)
        angles = (u - s * gear.tooth_half_angle, u + s * gear.space_half_angle)
        tooth, space = (np.tan(np.clip(angle, -_STEEPEST, _STEEPEST)) for angle in angles)
        inward, outward = s * gear.base_radius * (u - tooth), s * gear.base_radius * (space - u)
        return inward / (c + lean * (1.0 + tooth**2)), outward / (c + lean * (1.0 + space**2))

    def _pure(self, u: NDArray, v: NDArray) -> FlankJet:
        radius, twist, f = self.gear.base_radius, self.gear.twist, self.sign
        e, t = polar_frame(self.theta(u, v))
        xi = u[..., None]
        up = np.array([0.0, 0.0, 1.0])
        r = radius * (e - f * xi * t) + v[..., None] * up
        rv = twist * radius * (t + f * xi * e) + up
        ruu, ruv = radius * (e + f * xi * t), radius * twist * xi * t
        rvv = twist**2 * radius * (f * xi * t - e)
        c, s = cos(self.gear.base_helix_angle), sin(self.gear.base_helix_angle)
        return FlankJet(r, radius * xi * e, rv, ruu, ruv, rvv, f * self.gear.sign * (s * up - c * t))

    def _modified(self, pure: FlankJet, u: NDArray, v: NDArray, modification: FlankModification) -> FlankJet:
        """r + delta n: in the frame e, T, n its normal is n - delta_e / (1 + delta / rho) e - delta_T T."""
        gear, f, twist = self.gear, self.sign, self.gear.twist
        profile, lead = modification.profile(gear, u), modification.lead(gear, v)
        shift = (profile[0] + lead[0])[..., None]
        du, duu = profile[1][..., None], profile[2][..., None]
        dv, dvv = lead[1][..., None], lead[2][..., None]
        e, t = polar_frame(self.theta(u, v))
        c, n = gear.sign * cos(gear.base_helix_angle), pure.normal
        nu, nv = c * e, f * twist * c * e
        r = pure.r + shift * n
        ru, rv = pure.ru + du * n + shift * nu, pure.rv + dv * n + shift * nv
        ruu = pure.ruu + duu * n + 2.0 * du * nu + shift * (f * c * t)
        ruv = pure.ruv + du * nv + dv * nu + shift * (twist * c * t)
        rvv = pure.rvv + dvv * n + 2.0 * dv * nv + shift * (f * twist**2 * c * t)
        stretch = gear.base_radius * u[..., None] + c * shift
        lean = np.divide(du, stretch, out=np.zeros(np.shape(stretch)), where=stretch != 0.0)
        along = abs(c) * (dv - f * twist * du)
        tilted = n - lean * e - along * self.axis(u, v)
        return FlankJet(r, ru, rv, ruu, ruv, rvv, tilted / np.linalg.norm(tilted, axis=-1, keepdims=True))


def tangential_motion(flank: InvoluteFlank, offset: float, z: float) -> Callable[[NDArray, int], PoseSeries]:
    """The pose of an end mill that rolls along a flank without modification, as a function of the roll.

    Its axis lies along the contact line; its end's centre ``offset`` [mm] (tool radius and stock) out of the
    flank's point at height z. `motion.sources.CurveMotion` takes it.
    """
    gear, f = flank.gear, flank.sign
    c, s = cos(gear.base_helix_angle), sin(gear.base_helix_angle)
    side = f * gear.sign

    def pose(roll: NDArray, order: int) -> PoseSeries:
        xi = Series.variable(roll, order)
        e = series.exp((f * xi + float(flank.lambda_(z))) * 1j)
        along = xi * (f * gear.base_radius) + side * offset * c
        tip = e * gear.base_radius - e * 1j * along
        level = xi * 0.0
        return PoseSeries(
            series.stack([tip.real, tip.imag, level + z + side * offset * s]),
            series.stack([-e.imag * s, e.real * s, level + c]),
        )

    return pose


def polar_frame(theta: NDArray) -> tuple[NDArray, NDArray]:
    """Unit vectors outward and around at polar angles, shape (..., 3)."""
    c, s, nil = np.cos(theta), np.sin(theta), np.zeros(np.shape(theta))
    return np.stack([c, s, nil], axis=-1), np.stack([-s, c, nil], axis=-1)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
