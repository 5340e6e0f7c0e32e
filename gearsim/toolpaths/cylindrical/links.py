"""Moves between passes: into a space, from one flank to the other, and out again (Groover 2018, A.4.10)."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, cos, sin, tan

import numpy as np

from gearsim.errors import InputError
from gearsim.geometry.involute import roll_inv
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.toolpaths.cylindrical.limits import overrun, transverse
from gearsim.toolpaths.cylindrical.settings import Clearance
from gearsim.toolpaths.cylindrical.track import Track, across, join, moved_out, polar, track

_TURN_RAD = 0.05
_LIFT_MM = 0.5


def safe_radius(gear: CylindricalGear, tool_radius: float, clearance: Clearance) -> float:
    """Radius [mm] at which a leaning tool goes down beside (or inside) the tip cylinder, clear of it all the way.

    Raises InputError where a bore is too small for that.
    """
    lean = (gear.facewidth + overrun(gear, tool_radius)) * abs(tan(gear.base_helix_angle))
    away = clearance.rim + transverse(gear, tool_radius) + lean
    radius = gear.tip_radius + gear.sign * away
    if radius <= 0.0:
        raise InputError(
            f"the tool cannot go down in the bore: its tip radius {gear.tip_radius:g} mm must exceed {away:g} mm, the "
            f"clearance with the tool's radius and lean; take a smaller clearance rim than {clearance.rim:g} mm"
        )
    return radius


def visit(
    gear: CylindricalGear, right: Track, left: Track, tool_radius: float, stock: float, clearance: Clearance
) -> Track:
    """Both passes of one layer at one height: down, in, right flank, across, left flank, out, up.

    Down-milling with the spindle clockwise (M03): right flanks from tip to root, left flanks from root to tip, on
    external and internal gears (figures 3.2, 3.3). Rapids run above the top face or clear of the tip cylinder; the end
    of a leaning tool hangs below its tip.
    """
    rim, top = safe_radius(gear, tool_radius, clearance), clearance.top + tool_radius * abs(sin(gear.base_helix_angle))
    entry, leave = (
        _lifted(flank, i, _lift(gear, flank, i, tool_radius + stock) if gear.is_internal else 0.0, f)
        for flank, i, f in ((right, 0, 1.0), (left, -1, -1.0))
    )
    down = np.concatenate([moved_out(entry.tip[0], rim, top), moved_out(entry.tip[0], rim)])
    up = np.concatenate([moved_out(leave.tip[0], rim), moved_out(leave.tip[0], rim, top)])
    away, back = track(entry.heading[0], down, rapid=True), track(leave.heading[0], up, rapid=True)
    if gear.is_internal:
        away = join(away, entry)
        back = join(leave, replace(back, rapid=np.array([False, True])))
    return join(away, right, _around(gear.sign, right, left), left, back)


def _lift(gear: CylindricalGear, flank: Track, station: int, distance: float) -> float:
    """How far [mm] a tool whose axis stands a ``distance`` [mm] off its flank may move towards the middle of the space.

    The distances of a point of the axis from both flanks add up to 2 R_b cos(beta_b) (eta_b + s inv), inv of its own
    radius: that of the tool's end, or that at the top face if the axis leans outward.
    """
    tip = flank.tip[station]
    along = abs(float(tip @ across(float(flank.heading[station])))) + abs(tip[2] * tan(gear.base_helix_angle))
    half = gear.space_half_angle + gear.sign * float(roll_inv(along / gear.base_radius))
    room = gear.base_radius * cos(gear.base_helix_angle) * half - distance
    return min(_LIFT_MM, max(room, 0.0))


def _lifted(flank: Track, station: int, lift: float, f: float) -> Track:
    """A concave flank is met and left along its normal: retreating radially would mark it. f of the flank."""
    heading = flank.heading[[station]]
    return track(heading, flank.tip[[station]] - f * lift * across(float(heading[0])))


def _around(s: int, right: Track, left: Track) -> Track:
    """Stations between the root ends of a space's flanks, along the root circle; s of the gear.

    All axes linear would lead through the base circle: an external gear's flanks and root would be cut into, an
    internal gear's tool go a long way. Between stations the chord in the turning frame sags by R turn² / 8; the
    stations stand four times that away from the root, so that the first and the last block, which lead there, do not
    sag below the ends either.
    """
    ends = [right.heading[-1], left.heading[0]]
    count = max(2, ceil(abs(ends[1] - ends[0]) / _TURN_RAD))
    t = np.linspace(0.0, 1.0, count + 1)[1:-1]
    heading = ends[0] + t * (ends[1] - ends[0])
    angle = np.unwrap([np.arctan2(p[1], p[0]) for p in (right.tip[-1], left.tip[0])])
    radius = np.array([right.radius[-1], left.radius[0]])
    lift = 0.5 * s * radius.max() * ((ends[1] - ends[0]) / count) ** 2
    z = [right.tip[-1, 2], left.tip[0, 2]]
    tip = polar(*(a + t * (b - a) for a, b in (radius + lift, angle, z)))
    return track(heading, tip)
