"""Finish flank milling of the ruled spiral bevel tooth (Zhou 2015, section 4.2.2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from math import cos, tan

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.surfaces.patch import Side
from gearsim.surfaces.ruled_bevel import RuledBevelTooth
from gearsim.toolpaths.lengthwise_line import LengthwiseLine
from gearsim.toolpaths.tangent import check_mouth, cl_points, tangent_pose

_STATIONS = 65


@dataclass(frozen=True)
class FlankPath:
    """The pass that finishes one flank from toe to heel.

    At each lengthwise parameter the cutter's straight flank touches the tooth at the contact path, with
    its axis in the plane of the surface normal and the profile's straight line, and the cutter's flank
    begins where the tooth's does. ``run`` [mm] is how far the path goes on beyond toe and heel. ``allowance`` [mm] is
    left on the flank: the cutter stands that much off it along the normal.
    """

    tooth: RuledBevelTooth
    side: Side
    cutter: Profile
    run: float
    allowance: float = 0.0

    @property
    def line(self) -> LengthwiseLine:
        """The slot's lengthwise curve as far as the path goes."""
        return LengthwiseLine(self.tooth.blank, self.tooth.spine, self.tooth.phi_at, self.run)

    def contact_height(self, cone: NDArray | float) -> NDArray:
        """Profile height h [mm] of the contact path: mid working depth (Zhou 4.23)."""
        return np.asarray(self.tooth.blank.mid_working_depth_at(cone))

    @property
    def motion(self) -> CurveMotion:
        """The theoretical motion over the face and its run-in and run-out."""
        blank = self.tooth.blank
        start, end = self.tooth.phi_at(np.array([blank.toe - self.run, blank.cone_distance + self.run]))
        return CurveMotion(self.poses, float(start), float(end))

    def poses(self, phi: NDArray, order: int) -> PoseSeries:
        """Tip and axis as series in the lengthwise parameter phi [rad], shape (n,) (Zhou 4.24-4.27)."""
        phi = np.asarray(phi, dtype=float)
        contact, *frame = _contact(self.tooth, self.side, phi.tobytes(), order)
        contact = contact - frame[1] * self.allowance
        return tangent_pose(self.cutter, contact, *frame)

    def cl_motion(self, points: int) -> CLMotion:
        """The path as CL data with ``points`` points over the face, the run at the same spacing."""
        toe, heel = self.tooth.phi_at(np.array([self.tooth.blank.toe, self.tooth.blank.cone_distance]))
        return cl_points(self.motion, float(toe), float(heel), points)

    def check_passage(self) -> None:
        """Raise InputError where the cutter would cut the next tooth's tip away (`check_mouth`)."""
        phi, *mouth = _mouth(self.tooth, self.side)
        check_mouth(self.cutter, self.poses(phi, 0), *mouth)


@lru_cache(maxsize=256)
def _contact(tooth: RuledBevelTooth, side: Side, phi: bytes, order: int) -> tuple[Series, ...]:
    """Contact, rule, direction into the gear and distance as ``tangent_pose`` wants them, whatever the cutter.

    ``phi`` [rad] are a float array's bytes. What is kept serves the cutters and paths that are planned next.
    """
    sign = tooth.side_sign(side)
    slope = sign * tan(tooth.pressure_angle)
    spine = tooth.spine(np.frombuffer(phi), order + 1)
    blank = tooth.blank
    rise = 0.5 * (tan(blank.face_angle - blank.pitch) + tan(blank.pitch - blank.root_angle))
    h = spine.cone * rise + float(blank.mid_working_depth_at(0.0))
    y = h * slope + sign * float(tooth.half_width(0.0))
    origin, _ = tooth.flank(side).wall(spine)
    along = origin.derivative() + y.column * spine.y.derivative() + h.column * spine.z.derivative()
    rule = spine.y * slope + spine.z
    into_gear = series.unit(series.cross(along, rule)) * -tooth.flank(side).orientation
    contact = origin + spine.y * y.column + spine.z * h.column
    return contact, series.unit(rule), into_gear, (h - tooth.fillet_height) * (1.0 / cos(tooth.pressure_angle))


@lru_cache(maxsize=8)
def _mouth(tooth: RuledBevelTooth, side: Side) -> tuple[NDArray, ...]:
    """Stations phi along the face, and of the slot's mouth there what ``check_mouth`` asks."""
    blank = tooth.blank
    phi = tooth.phi_at(np.linspace(blank.toe, blank.cone_distance, _STATIONS))
    spine = tooth.spine(phi, 1)
    depth = np.asarray(blank.whole_depth_at(spine.cone.value))
    half_land, half_mouth = tooth.flank(side).windows(phi, depth)
    return phi, spine.origin.value + spine.z.value * depth[:, None], spine.cone.value, half_land, half_mouth
