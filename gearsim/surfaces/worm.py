"""Worm threads as screws of a straight line, and the cone that grinds them (Litvin and Chen 1994, 004)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, pi, sin, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.grazing import MeridianPoints
from gearsim.geometry.jets import SurfaceJet
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series


@dataclass(frozen=True)
class RuledWorm:
    """One thread side: a line in screw motion about z (Litvin 73, 108 for the Archimedean worm, offset 0).

    | parameter | meaning |
    | --- | --- |
    | pressure_angle | angle between the line and the plane normal to the axis [rad] |
    | screw | axial travel per radian [mm/rad], positive for a right-hand thread |
    | offset | distance of the line from the axis [mm]: 0 (ZA), p cot alpha (the involute worm, ZI) |

    Raises InputError for impossible values.
    """

    pressure_angle: float
    screw: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        if not abs(self.pressure_angle) < 0.5 * pi:
            raise InputError(
                f"pressure angle must lie within -90 to 90 deg, got {np.degrees(self.pressure_angle):g} deg"
            )
        if self.screw == 0.0:
            raise InputError("the screw parameter must not be 0: the line would turn in a plane or cone")

    @staticmethod
    def involute(pressure_angle: float, screw: float) -> RuledWorm:
        """The developable case: the line touches the base cylinder, of radius p cot alpha, along its helix."""
        if pressure_angle == 0.0:
            raise InputError("an involute worm needs a pressure angle other than 0: its base radius is p cot alpha")
        return RuledWorm(pressure_angle, screw, screw / tan(pressure_angle))

    def jet(self, u: ArrayLike, theta: ArrayLike) -> SurfaceJet:
        """Points at u [mm] along the line and rotation theta [rad], shape (...); normals r_u x r_theta.

        For alpha > 0 and u > 0 they leave the thread (Litvin 75). r_theta keeps its length: (119) prints a unit
        vector, which (115) may not take.
        """
        u, theta = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(theta, dtype=float))
        c, s = np.cos(theta), np.sin(theta)
        ca, sa = cos(self.pressure_angle), sin(self.pressure_angle)
        nil = np.zeros(u.shape)
        x, y = u * ca * c - self.offset * s, u * ca * s + self.offset * c
        return SurfaceJet(
            np.stack([x, y, self.screw * theta - u * sa], axis=-1),
            np.stack([ca * c, ca * s, nil - sa], axis=-1),
            np.stack([-y, x, nil + self.screw], axis=-1),
            np.zeros((*u.shape, 3)),
            np.stack([-ca * s, ca * c, nil], axis=-1),
            np.stack([-x, -y, nil], axis=-1),
        )

    def parameters_at(self, radius: ArrayLike, height: ArrayLike) -> tuple[NDArray, NDArray]:
        """(u, theta) of the point at a radius and a height z [mm], on the side u > 0.

        Raises InputError for a radius not above the offset.
        """
        inside = np.asarray(radius, dtype=float) ** 2 - self.offset**2
        if np.any(inside <= 0.0):
            raise InputError(f"the thread has no point there: the radius must exceed the offset, {self.offset:g} mm")
        u = np.sqrt(inside) / cos(self.pressure_angle)
        return u, (np.asarray(height, dtype=float) + u * sin(self.pressure_angle)) / self.screw


@dataclass(frozen=True)
class GrindingCone:
    """A grinding wheel's cone with its apex at the tool's origin, opening along +z (Litvin 32, 33).

    ``half_angle`` [rad] between axis and generatrix; Litvin's "cone apex angle" is this half-angle.
    """

    half_angle: float

    def __post_init__(self) -> None:
        if not 0.0 < self.half_angle < 0.5 * pi:
            raise InputError(f"half angle must lie between 0 and 90 deg, got {np.degrees(self.half_angle):g} deg")

    def jet(self, u: ArrayLike, theta: ArrayLike) -> SurfaceJet:
        """Points at u [mm] from the apex and theta [rad] about the axis, shape (...); normals out of the wheel."""
        u, theta = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(theta, dtype=float))
        c, s = np.cos(theta), np.sin(theta)
        sg, cg = sin(self.half_angle), cos(self.half_angle)
        nil, u1 = np.zeros(u.shape), u[..., None]
        along, around = np.stack([sg * c, sg * s, nil + cg], axis=-1), np.stack([-sg * s, sg * c, nil], axis=-1)
        back = np.stack([-sg * c, -sg * s, nil], axis=-1)
        return SurfaceJet(u1 * along, along, u1 * around, 0.0 * along, around, u1 * back, -1.0)

    def meridian(self, u: NDArray) -> MeridianPoints:
        """The same points as a meridian, u [mm] of shape (n,): the arc length."""
        sg, cg, ones = sin(self.half_angle), cos(self.half_angle), np.ones(np.shape(u))
        return MeridianPoints(sg * u, cg * u, cg * ones, -sg * ones, 0.0 * ones)


def screw_motion(tip: NDArray, axis: NDArray, screw: float) -> Callable[[NDArray, int], PoseSeries]:
    """A tool's pose, both shape (3,), carried about z by a screw [mm/rad]: the pose at rotations theta [rad].

    With a cone it generates the ZK worm; `motion.sources.CurveMotion` takes it.
    """

    def pose(theta: NDArray, order: int) -> PoseSeries:
        angle = Series.variable(theta, order)
        turn = series.exp(angle * 1j)
        level = angle * 0.0
        around = [turn * complex(v[0], v[1]) for v in (tip, axis)]
        return PoseSeries(
            series.stack([around[0].real, around[0].imag, angle * screw + tip[2]]),
            series.stack([around[1].real, around[1].imag, level + axis[2]]),
        )

    return pose
