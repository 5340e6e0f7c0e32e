"""One pass: the tool generates one flank at one height (Groover 2018, 2.35, 2.36 and 3.1)."""

from __future__ import annotations

from math import cos

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.toolpaths.cylindrical.track import Track, track


def flank_pass(
    gear: CylindricalGear, side: Side, z: float, rolls: NDArray, distance: float,
    modification: FlankModification | None = None,
) -> Track:  # fmt: skip
    """Stations in space 0 at rolls (n,) [rad] of the tool's end, its axis ``distance`` [mm] from the flank.

    The heading is theta = f xi + Lambda and the tip P + d n = R_b e + (f R_b xi + f s d cos beta_b) t + ..., with
    e = (cos theta, sin theta) and t = (sin theta, -cos theta): both linear in xi, so that with all axes linear in
    time the flank between two stations is the exact involute.

    On a modified flank the tool's end stands on its amount, and the axis leans with its slope along the contact line:
    flutes above must not cut with the amount of the end. The slope along the profile (which is infinite at the base
    circle) does not move the contact: that leaves the tool's radius times half its square, nanometres.
    Beyond the flank a modification goes on.
    """
    flank, level = InvoluteFlank(gear, side), np.full(rolls.shape, z)
    heading, pure = flank.theta(rolls, z), flank.jet(rolls, level)
    amount, slope = _modified(gear, flank.sign, z, rolls, modification)
    lean = np.arctan(slope)
    standing = np.cos(lean)[:, None] * pure.normal - np.sin(lean)[:, None] * flank.axis(rolls, level)
    tip = pure.r + amount[:, None] * pure.normal + distance * standing
    return track(heading, tip, lever=_levers(gear, flank.sign, z, rolls), lean=-flank.sign * gear.sign * lean)


def _modified(
    gear: CylindricalGear, f: int, z: float, rolls: NDArray, modification: FlankModification | None
) -> tuple[NDArray, NDArray]:
    """A modification's amounts [mm] at the tool's end, (n,), and their slopes along the contact line, upward."""
    if modification is None:
        return np.zeros(rolls.shape), np.zeros(rolls.shape)
    profile = modification.profile(gear, rolls)
    lead = modification.lead(gear, np.full(rolls.shape, z))
    return profile[0] + lead[0], cos(gear.base_helix_angle) * (lead[1] - f * gear.twist * profile[1])


def _levers(gear: CylindricalGear, f: int, z: float, rolls: NDArray) -> NDArray:
    """R_b xi [mm], times the turn's rate the speed of the contact on the flank: the largest up to the top face.

    A block counts with its larger end (4.35 and 4.39 take i + 1, which on an inward pass is the smaller). The speed of
    the tool's axis, omega abs(R_b xi + s d cos beta_b) (4.39 repaired), is counted in `feed` for every block.
    """
    reach = gear.base_radius * (rolls + max(-f * gear.twist, 0.0) * abs(z))
    return np.concatenate([[0.0], np.maximum(reach[1:], reach[:-1])])
