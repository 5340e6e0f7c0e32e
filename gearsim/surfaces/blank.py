"""Bevel gear blanks (ISO 23509 terms): cones, teeth heights and the turned stock.

Axial half plane: radius from the gear axis and z along it, pitch apex at the origin. A second pair of
coordinates is used throughout: ``cone`` runs along the pitch cone's generator from the apex (the cone
distance), ``height`` along its normal, away from the axis.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, degrees, pi, sin, tan

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.turned import Turned

_NARROWEST = 1e-6


def pitch_angle(teeth: int, mate_teeth: int, shaft_angle: float) -> float:
    """Pitch angle [rad] of a bevel gear from the tooth numbers and the shaft angle [rad]."""
    return atan2(sin(shaft_angle), mate_teeth / teeth + cos(shaft_angle))


def outer_cone_distance(module: float, teeth: int, pitch: float) -> float:
    """Outer cone distance [mm]: half the outer pitch diameter over the sine of the pitch angle."""
    return 0.5 * module * teeth / sin(pitch)


@dataclass(frozen=True)
class BevelBlank:
    """A bevel gear blank; lengths in mm, angles in rad.

    Source of the numbers of the worked example: Zhou 2015, table 3.3 and the points of table 3.2. Heights
    are measured at the outer cone distance; ``clearance`` is constant along the face, because the root
    cone is parallel to the mate's face cone. ``rim`` is the material left under the root at the heel.
    """

    teeth: int
    pitch: float
    cone_distance: float
    face_width: float
    addendum: float
    dedendum: float
    face_angle: float
    root_angle: float
    clearance: float
    rim: float

    def __post_init__(self) -> None:
        problems = []
        if not _NARROWEST * self.cone_distance <= self.face_width < self.cone_distance:
            problems.append(
                f"face width {self.face_width:g} mm must be at least {_NARROWEST:g} of the cone distance "
                f"{self.cone_distance:g} mm and below it"
            )
        if not 0.0 < self.root_angle <= self.pitch <= self.face_angle < pi:
            problems.append(
                f"root angle {degrees(self.root_angle):.4g}, pitch angle {degrees(self.pitch):.4g} and face "
                f"angle {degrees(self.face_angle):.4g} deg must rise in this order (are they in degrees?)"
            )
        elif self.dedendum_at(self.toe) <= 0.0 or self.whole_depth_at(self.toe) <= 0.0:
            problems.append("the tooth vanishes at the toe: dedendum or whole depth is not positive there")
        if not 0.0 <= self.clearance < self.whole_depth_at(self.mean):
            problems.append(
                f"clearance {self.clearance:g} mm must be at least 0 and below the mean whole depth "
                f"{self.whole_depth_at(self.mean):g} mm"
            )
        if problems:
            raise InputError("impossible bevel blank: " + "; ".join(problems))

    @property
    def toe(self) -> float:
        """Cone distance of the inner end [mm]."""
        return self.cone_distance - self.face_width

    @property
    def mean(self) -> float:
        """Mean cone distance [mm]."""
        return self.cone_distance - 0.5 * self.face_width

    def addendum_at(self, cone: NDArray | float) -> NDArray | float:
        """Height [mm] of the face cone over the pitch cone at a cone distance [mm]."""
        return self.addendum - (self.cone_distance - cone) * tan(self.face_angle - self.pitch)

    def dedendum_at(self, cone: NDArray | float) -> NDArray | float:
        """Depth [mm] of the root cone under the pitch cone at a cone distance [mm] (Zhou 3.28)."""
        return self.dedendum - (self.cone_distance - cone) * tan(self.pitch - self.root_angle)

    def whole_depth_at(self, cone: NDArray | float) -> NDArray | float:
        """Height [mm] of the face cone over the root cone (Zhou 3.35)."""
        return self.addendum_at(cone) + self.dedendum_at(cone)

    def mid_working_depth_at(self, cone: NDArray | float) -> NDArray | float:
        """Height [mm] over the root cone of the middle of the working depth (Zhou 4.23)."""
        return 0.5 * (self.whole_depth_at(cone) + self.clearance)

    @property
    def root_apex(self) -> float:
        """Signed distance [mm] along +z from the root cone's apex to the pitch apex (Zhou 3.29)."""
        return self._apex_offset(-self.dedendum, self.root_angle)

    @property
    def face_apex(self) -> float:
        """Signed distance [mm] along +z from the pitch apex to the face cone's apex."""
        return -self._apex_offset(self.addendum, self.face_angle)

    def _apex_offset(self, height: float, angle: float) -> float:
        radius, z = self.axial(np.array([self.cone_distance]), np.array([height]))
        return float(radius[0] / tan(angle) - z[0])

    def axial(self, cone: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
        """(cone, height) to (radius, z)."""
        return (
            cone * sin(self.pitch) + height * cos(self.pitch),
            cone * cos(self.pitch) - height * sin(self.pitch),
        )

    def cone_height(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """(cone, height) [mm] of points, shape (..., 3), in the gear frame."""
        radius, z = np.hypot(points[..., 0], points[..., 1]), points[..., 2]
        return (
            radius * sin(self.pitch) + z * cos(self.pitch),
            radius * cos(self.pitch) - z * sin(self.pitch),
        )

    def cone_directions(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Unit vectors along the pitch cone's generator and its normal beside points, shape (..., 3).

        The gradients of ``cone_height``.
        """
        around = points[..., :2] / np.hypot(points[..., 0], points[..., 1])[..., None]
        s, c = sin(self.pitch), cos(self.pitch)
        rise = np.ones((*points.shape[:-1], 1))
        return (
            np.concatenate([around * s, rise * c], axis=-1),
            np.concatenate([around * c, -rise * s], axis=-1),
        )

    def mate(self, teeth: int) -> BevelBlank:
        """The mating blank for perpendicular shafts and parallel root and face cones (table 3.2)."""
        pitch = 0.5 * pi - self.pitch
        face_angle, root_angle = pitch + self.pitch - self.root_angle, pitch - self.face_angle + self.pitch
        return BevelBlank(
            teeth, pitch, self.cone_distance, self.face_width, self.dedendum - self.clearance,
            self.addendum + self.clearance, face_angle, root_angle, self.clearance, self.rim,
        )  # fmt: skip

    @cached_property
    def stock(self) -> Turned:
        """The turned blank: back cone, face cone, front cone, and a back parallel to the root cone."""
        heel, toe = self.cone_distance, self.toe
        ends = np.array([heel, heel, toe, toe])
        under = self.rim
        heights = np.array(
            [-self.dedendum - under, self.addendum, self.addendum_at(toe), -self.dedendum_at(toe) - under]
        )
        radius, z = self.axial(ends, heights)
        if radius.min() <= 0.0:
            raise InputError(
                f"rim {self.rim:g} mm reaches past the gear axis; it must be below "
                f"{self.rim + radius.min() / cos(self.pitch):.3g} mm"
            )
        return Turned(np.column_stack([radius, z]))
