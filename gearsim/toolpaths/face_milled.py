"""Flank milling of a generated tooth with a conical cutter, for comparison with the ruled one (Zhou 4.4.2)."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import tan

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.surfaces.lengthwise import lengthwise_curve, profile_points
from gearsim.surfaces.patch import SIDES
from gearsim.surfaces.ruled_bevel import Spine
from gearsim.surfaces.slot_patch import GeneratedPatch
from gearsim.toolpaths.lengthwise_line import LengthwiseLine
from gearsim.toolpaths.tangent import check_mouth, cl_points, tangent_pose

_STATIONS = 65


@dataclass(frozen=True)
class GeneratedFlankPath:
    """The pass that finishes one generated flank from toe to heel, as `FlankPath` does the ruled one.

    The source plans it as the ruled tooth's (4.4.2): along the lengthwise curve, the axis in the profile plane of the
    curve's point. The profile there has no straight line; its tangent at the contact path, which lies at mid working
    depth (4.23), takes the rule's place. The cutter's flank begins ``start_height`` [mm] over the root, measured along
    that tangent: the height at which the blade's edge radius ends (4.27). ``run`` [mm] is how far the path goes on
    beyond toe and heel, ``allowance`` [mm] what is left on the flank. The parameter is the cone distance [mm] of the
    lengthwise curve's point.
    """

    patch: GeneratedPatch
    cutter: Profile
    start_height: float
    run: float
    allowance: float = 0.0

    @property
    def line(self) -> LengthwiseLine:
        """The slot's lengthwise curve as far as the path goes."""
        return LengthwiseLine(self.patch.blank, self.spine, lambda cone: cone, self.run)

    @property
    def motion(self) -> CurveMotion:
        """The theoretical motion over the face and its run-in and run-out.

        Raises InputError where the flank, prolonged, does not reach that far.
        """
        cone = self._track[0]
        return CurveMotion(self.poses, float(cone[0]), float(cone[-1]))

    def cl_motion(self, points: int) -> CLMotion:
        """The path as CL data with ``points`` points over the face, the run at the same spacing."""
        return cl_points(self.motion, self.patch.blank.toe, self.patch.blank.cone_distance, points)

    def contact_height(self, cone: NDArray | float) -> NDArray:
        """Profile height [mm] of the contact path over the root: mid working depth (Zhou 4.23)."""
        return np.asarray(self.patch.blank.mid_working_depth_at(cone))

    def poses(self, cone: NDArray, order: int) -> PoseSeries:
        """Tip and axis as series in the cone distance [mm], shape (n,) (Zhou 4.24-4.27).

        nan where the flank, prolonged, does not reach that cone distance.
        """
        cone = np.asarray(cone, dtype=float)
        spine = self.spine(cone, order)
        height = spine.cone * self._slope + float(self.contact_height(0.0))
        near = self._near(cone, len(SIDES))
        _, _, contact, normal = profile_points(self.patch, spine, height, near)
        rule = series.unit(series.cross(spine.x, normal))
        rise = series.dot(rule, spine.z)
        sense = np.sign(rise.value)
        distance = (height - self.start_height) / (rise * sense)
        contact = contact + normal * self.allowance
        return tangent_pose(self.cutter, contact, rule * sense[:, None], -normal, distance)

    def spine(self, cone: NDArray, order: int) -> Spine:
        """Profile frames of the slot at cone distances [mm], shape (n,), as series in them."""
        return lengthwise_curve(self._walls, (self._near(cone, 0), self._near(cone, 1)), cone, order)

    def check_passage(self) -> None:
        """Raise InputError where the cutter would cut the next tooth's tip away (`check_mouth`)."""
        blank, length = self.patch.blank, np.linspace(0.0, 1.0, _STATIONS)
        cone = blank.toe + blank.face_width * length
        tips = [(wall, wall.locate(length, np.ones(_STATIONS))) for wall in map(self.patch.tooth.flank, SIDES)]
        mouth = np.mean([wall.jet(*at).r for wall, at in tips], axis=0)
        half_land, half_mouth = self.patch.windows(*tips[SIDES.index(self.patch.side)][1])
        check_mouth(self.cutter, self.poses(cone, 0), mouth, cone, half_land, half_mouth)

    @property
    def _walls(self) -> tuple[GeneratedPatch, GeneratedPatch]:
        one, other = (self.patch.tooth.flank(side) for side in SIDES)
        return one, other

    @cached_property
    def _track(self) -> tuple[NDArray, tuple[tuple[NDArray, NDArray], ...]]:
        """Cone distances [mm], shape (n,), and parameters near there: of both walls on the pitch cone, of contacts.

        Raises InputError where the flank, prolonged, does not reach that far.
        """
        blank = self.patch.blank
        cone = np.linspace(blank.toe - self.run, blank.cone_distance + self.run, _STATIONS)
        above = self.contact_height(cone) - blank.dedendum_at(cone)
        on_the_pitch_cone = [wall.meet(cone, np.zeros(_STATIONS)) for wall in self._walls]
        return cone, (*on_the_pitch_cone, self.patch.meet(cone, above))

    def _near(self, cone: NDArray, which: int) -> tuple[NDArray, NDArray]:
        along, tracks = self._track
        u, v = (np.interp(cone, along, track) for track in tracks[which])
        return u, v

    @property
    def _slope(self) -> float:
        """Rise of the mid working depth along the cone."""
        blank = self.patch.blank
        return 0.5 * (tan(blank.face_angle - blank.pitch) + tan(blank.pitch - blank.root_angle))
