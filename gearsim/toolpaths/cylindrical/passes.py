"""One pass: the tool generates one flank at one height (Groover 2018, 2.35, 2.36 and 3.1)."""

from __future__ import annotations

from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.toolpaths.cylindrical.track import Track, track


def flank_pass(gear: CylindricalGear, side: Side, z: float, rolls: NDArray, distance: ArrayLike) -> Track:
    """Stations in space 0 at rolls (n,) [rad] of the tool's end, its axis ``distance`` [mm] from the flank along n.

    The heading is theta = f xi + Lambda and the tip P + d n = R_b e + (f R_b xi + f s d cos beta_b) t + ..., with
    e = (cos theta, sin theta) and t = (sin theta, -cos theta): both linear in xi, so that with all axes linear in
    time the flank between two stations is the exact involute.
    """
    f, s = flank_sign(side), gear.sign
    c, tilt = cos(gear.base_helix_angle), sin(gear.base_helix_angle)
    distance = np.broadcast_to(np.asarray(distance, dtype=float), rolls.shape)
    heading = f * rolls + gear.space_centre(0, z) + s * f * gear.space_half_angle
    along = f * (gear.base_radius * rolls + s * distance * c)
    e, t = (np.cos(heading), np.sin(heading)), (np.sin(heading), -np.cos(heading))
    x, y = (gear.base_radius * e[i] + along * t[i] for i in range(2))
    tip = np.stack([x, y, z + f * s * distance * tilt], axis=-1)
    return track(heading, tip, lever=_levers(gear, f, z, rolls))


def tool_distance(gear: CylindricalGear, z: float, rolls: NDArray, modification: FlankModification | None) -> NDArray:
    """What a modification adds to the tool's distance from the flank [mm], (n,); beyond the flank as at its ends."""
    if modification is None:
        return np.zeros(rolls.shape)
    low, high = sorted((gear.root_roll, gear.tip_roll))
    inside = np.clip(rolls, low, high)
    return modification.profile(gear, inside)[0] + modification.lead(gear, np.full(rolls.shape, z))[0]


def _levers(gear: CylindricalGear, f: int, z: float, rolls: NDArray) -> NDArray:
    """R_b xi [mm], times the turn's rate the speed of the contact on the flank: the largest up to the top face.

    A block counts with its larger end (4.35 and 4.39 take i + 1, which on an inward pass is the smaller). The speed of
    the tool's axis, omega abs(R_b xi + s d cos beta_b) (4.39 repaired), is counted in `feed` for every block.
    """
    reach = gear.base_radius * (rolls + max(-f * gear.twist, 0.0) * abs(z))
    return np.concatenate([[0.0], np.maximum(reach[1:], reach[:-1])])
