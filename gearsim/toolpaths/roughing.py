"""Roughing a bevel slot, both walls in one pass along the lengthwise curve (Zhou 2015, section 4.2.3, 4.28 and 4.29).

Strategy I: the axis is normal to the root cone; strategy II: normal to the pitch cone. Depth H of a pass is the
distance of the tip from the pitch cone's point q_s, down the axis; negative between pitch cone and face cone. 4.28 is
printed with a tip that is not H off q_s; here o_c = q_s - H l in both.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin, tan
from typing import Literal

from numpy.typing import NDArray

from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.surfaces.ruled_bevel import Spine
from gearsim.toolpaths.lengthwise_line import LengthwiseLine
from gearsim.toolpaths.tangent import cl_points

Strategy = Literal["I", "II"]


@dataclass(frozen=True)
class RoughPath:
    """One pass from before the toe to behind the heel.

    It goes ``share`` of the way from the face cone down to ``lift`` [mm] above the root cone, both along the axis.
    """

    line: LengthwiseLine
    strategy: Strategy
    share: float
    lift: float

    def depth(self, spine: Spine) -> Series:
        """H [mm] of the pass along the lengthwise curve."""
        top, root = mouth_depth(self.line, spine), root_depth(self.line, self.strategy, spine)
        return top + (root - self.lift - top) * self.share

    def poses(self, parameter: NDArray, order: int) -> PoseSeries:
        """Tip and axis as series in the line's parameter, shape (n,)."""
        spine = self.line.frames(parameter, order)
        return rough_pose(self.line, self.strategy, spine, self.depth(spine))

    @property
    def motion(self) -> CurveMotion:
        """The continuous motion over the face and its run-in and run-out."""
        return CurveMotion(self.poses, *self.line.ends)

    def cl_motion(self, points: int) -> CLMotion:
        """The path as CL data with ``points`` points over the face, the run at the same spacing."""
        return cl_points(self.motion, *self.line.face, points)


def rough_pose(line: LengthwiseLine, strategy: Strategy, spine: Spine, depth: Series) -> PoseSeries:
    """The pose of a strategy at depth H [mm]: tip o_c = q_s - H l, axis l (Zhou 4.28 as corrected, 4.29)."""
    lean = _lean(line, strategy)
    axis = spine.x * sin(lean) + spine.z * cos(lean)
    return PoseSeries(spine.x * spine.cone.column - axis * depth.column, axis)


def root_depth(line: LengthwiseLine, strategy: Strategy, spine: Spine) -> Series:
    """H [mm] at which the tip reaches the root cone: H_s (Zhou 3.28), down a leaning axis its cosine times that."""
    blank = line.blank
    dedendum = spine.cone * tan(blank.pitch - blank.root_angle) + float(blank.dedendum_at(0.0))
    return dedendum * cos(_lean(line, strategy))


def _lean(line: LengthwiseLine, strategy: Strategy) -> float:
    """Angle [rad] of the axis from the pitch cone's normal."""
    return line.blank.pitch - line.blank.root_angle if strategy == "I" else 0.0


def mouth_depth(line: LengthwiseLine, spine: Spine) -> Series:
    """H [mm] of a tip on the face cone, straight above q_s."""
    blank = line.blank
    return -(spine.cone * tan(blank.face_angle - blank.pitch) + float(blank.addendum_at(0.0)))
