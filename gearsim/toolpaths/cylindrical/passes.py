"""One pass: the tool generates one flank at one height (Groover 2018, 2.35, 2.36 and 3.1)."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.toolpaths.cylindrical.track import Track, track


def flank_pass(
    gear: CylindricalGear, side: Side, z: float, rolls: NDArray, distance: float,
    modification: FlankModification | None = None,
) -> Track:  # fmt: skip
    """Stations in space 0 at rolls (n,) [rad] of the tool's end, its axis ``distance`` [mm] from the flank along n.

    The heading is theta = f xi + Lambda and the tip P + d n = R_b e + (f R_b xi + f s d cos beta_b) t + ..., with
    e = (cos theta, sin theta) and t = (sin theta, -cos theta): both linear in xi, so that with all axes linear in
    time the flank between two stations is the exact involute.

    On a modified flank the tool's end stands on its amount, and the axis leans along with its slope along the contact
    line: flutes above must not cut with the amount of the end. n lies in the plane in which the tool tilts.
    """
    f, s = flank_sign(side), gear.sign
    amount, slope = _modified(gear, f, z, rolls, modification)
    toward = np.arctan(slope)
    tilt = gear.base_helix_angle - f * s * toward
    heading = f * rolls + gear.space_centre(0, z) + s * f * gear.space_half_angle
    away = [amount * cos(gear.base_helix_angle) + distance * np.cos(tilt),
            amount * sin(gear.base_helix_angle) + distance * np.sin(tilt)]  # fmt: skip
    along = f * (gear.base_radius * rolls + s * away[0])
    e, t = (np.cos(heading), np.sin(heading)), (np.sin(heading), -np.cos(heading))
    x, y = (gear.base_radius * e[i] + along * t[i] for i in range(2))
    tip = np.stack([x, y, z + f * s * away[1]], axis=-1)
    return track(heading, tip, lever=_levers(gear, f, z, rolls), lean=-f * s * toward)


def _modified(
    gear: CylindricalGear, f: int, z: float, rolls: NDArray, modification: FlankModification | None
) -> tuple[NDArray, NDArray]:
    """A modification's amounts [mm] at the tool's end, (n,), and their slopes along the contact line, upward.

    Beyond the flank it goes on as at its ends.
    """
    if modification is None:
        return np.zeros(rolls.shape), np.zeros(rolls.shape)
    low, high = sorted((gear.root_roll, gear.tip_roll))
    inside = np.clip(rolls, low, high)
    profile = modification.profile(gear, inside)
    lead = modification.lead(gear, np.full(rolls.shape, z))
    rising = np.where(inside == rolls, profile[1], 0.0)
    return profile[0] + lead[0], cos(gear.base_helix_angle) * (lead[1] - f * gear.twist * rising)


def _levers(gear: CylindricalGear, f: int, z: float, rolls: NDArray) -> NDArray:
    """R_b xi [mm], times the turn's rate the speed of the contact on the flank: the largest up to the top face.

    A block counts with its larger end (4.35 and 4.39 take i + 1, which on an inward pass is the smaller). The speed of
    the tool's axis, omega abs(R_b xi + s d cos beta_b) (4.39 repaired), is counted in `feed` for every block.
    """
    reach = gear.base_radius * (rolls + max(-f * gear.twist, 0.0) * abs(z))
    return np.concatenate([[0.0], np.maximum(reach[1:], reach[:-1])])
