"""What flank milling paths share: the pose that touches along a line, and CL points at equal steps."""

from __future__ import annotations

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CLMotion, CurveMotion


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
    before = int(np.ceil((motion.start - toe) / -step - 1e-9))
    after = int(np.ceil((motion.end - heel) / step - 1e-9))
    pose = motion.curve(toe + step * np.arange(-before, points + after), 0)
    return CLMotion(pose.tip.value, pose.axis.value)
