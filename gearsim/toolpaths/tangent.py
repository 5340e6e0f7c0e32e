"""What flank milling paths share: the pose that touches along a line, CL points at equal steps, room to pass."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion
from gearsim.toolpaths.lengthwise_line import LengthwiseLine

_MOST_POINTS = 100_000


class FlankPass(Protocol):
    """The pass that finishes one flank of a tooth from toe to heel."""

    @property
    def motion(self) -> CurveMotion:
        """The theoretical motion over the face and its run-in and run-out."""
        ...

    def cl_motion(self, points: int) -> CLMotion:
        """The path as CL data with ``points`` points over the face, the run at the same spacing."""
        ...

    @property
    def line(self) -> LengthwiseLine:
        """The slot's lengthwise curve as far as the path goes."""
        ...

    def check_passage(self) -> None:
        """Raise InputError where the cutter is so wide that it would cut the next tooth's tip away."""
        ...


def tangent_pose(cutter: Profile, contact: Series, rule: Series, into_gear: Series, distance: Series) -> PoseSeries:
    """The pose whose straight flank lies along the unit vector ``rule`` at ``contact`` [mm].

    The cutter's normal there is ``into_gear``; its flank begins ``distance`` [mm] below the contact along the
    rule (Zhou 2015, 4.24-4.27).
    """
    start = cutter.elements[cutter.flank].at(np.array(0.0))
    taper_sine, taper_cosine = -float(start.nz), float(start.nr)
    axis = rule * taper_cosine - into_gear * taper_sine
    radial = (into_gear + axis * taper_sine) * (1.0 / taper_cosine)
    radius = distance * taper_sine + float(start.r)
    height = distance * taper_cosine + float(start.z)
    tip = contact - radial * radius.column - axis * height.column
    return PoseSeries(tip, Series(axis.c[: tip.order + 1]))


def cl_points(motion: CurveMotion, toe: float, heel: float, points: int) -> CLMotion:
    """CL data with ``points`` points from the parameter ``toe`` to ``heel``, the run-out at the same spacing."""
    if points < 2:
        raise InputError(f"CL data needs at least 2 points over the face, got {points}")
    step = (heel - toe) / (points - 1)
    longest = max(abs(motion.start - toe), abs(motion.end - heel))
    if not longest <= _MOST_POINTS * abs(step):
        raise InputError(
            f"the run before toe and after heel is more than {_MOST_POINTS} times as long as the spacing of the "
            f"{points} CL points over the face; wanted is a wider face, a shorter run, or fewer points"
        )
    before = int(np.ceil((motion.start - toe) / -step - 1e-9))
    after = int(np.ceil((motion.end - heel) / step - 1e-9))
    pose = motion.curve(toe + step * np.arange(-before, points + after), 0)
    return CLMotion(pose.tip.value, pose.axis.value)


def check_mouth(
    cutter: Profile, pose: PoseSeries, mouth: NDArray, cone: NDArray, half_land: NDArray, half_mouth: NDArray
) -> None:
    """Raise InputError where the cutter cuts more than half the next tooth's tip land away.

    Compares its diameter at the mouth's middle, ``mouth`` [mm], shape (n, 3), with the distance of the slot's tip
    edges there, normal to the lengthwise curve. ``half_land``, ``half_mouth`` [mm], shape (n,): half the tooth's
    thickness and half the slot's width at the tip at cone distances ``cone`` [mm].
    """
    height = ((mouth - pose.tip.value) * pose.axis.value).sum(1)
    width = 2.0 * cutter.radii_at(np.minimum(height, cutter.height))
    excess = width - 2.0 * half_mouth - half_land
    worst = int(np.argmax(excess))
    if excess[worst] > 0.0:
        raise InputError(
            "the cutter cannot pass between the tip edges: at cone distance "
            f"{cone[worst]:.2f} mm it is {width[worst]:.2f} mm wide at the slot's mouth of "
            f"{2.0 * half_mouth[worst]:.2f} mm, and would cut the next tooth's tip away; "
            "choose a smaller bottom radius, fillet or taper"
        )
