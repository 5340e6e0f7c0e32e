"""Involute flanks as machined surfaces: an end mill rolling along them in exact tangential motion."""

from __future__ import annotations

from numpy.typing import NDArray

from gearsim.cutters.end_mills import flat
from gearsim.motion.sources import CurveMotion
from gearsim.surfaces.involute import InvoluteFlank, tangential_motion
from gearsim.surfaces.tool_access import reachable_roll
from gearsim.verify.closed_form import Claimed, ClosedForm


def flank_form(flank: InvoluteFlank, tool_radius: float) -> ClosedForm:
    """A flank without modification as an end mill of ``tool_radius`` [mm] cuts it, its end at the bottom face.

    u runs along the reachable roll there, v up the facewidth along contact lines.
    """
    gear, bottom = flank.gear, -flank.gear.facewidth
    low, high = reachable_roll(gear, flank.side, tool_radius, bottom)
    source = CurveMotion(tangential_motion(flank, tool_radius, bottom), low, high)
    cutter = flat(2.0 * tool_radius, 2.0 * (gear.facewidth + tool_radius))

    def points(u: NDArray, v: NDArray) -> Claimed:
        z = bottom + v * gear.facewidth
        jet = flank.jet(low + u * (high - low) - flank.sign * gear.twist * (z - bottom), z)
        return Claimed(jet.r, jet.normal, None, jet.curvature(), u)

    return ClosedForm(f"{flank.side} flank", source, cutter, points, flank.side)
