"""Bevel teeth that cannot be, told before anything is cut: neighbouring slots that meet, slots beside the blank."""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Jet, ToothSurface

_STATIONS = 9


def check_slot(concave: ToothSurface, convex: ToothSurface, bottoms: Sequence[ToothSurface]) -> None:
    """Raise InputError where a slot between two flanks leaves no tooth, or its bottom is not in the blank.

    At nine stations along the face: at the tip the tooth's land, at the flanks' root the slot and the tooth beneath
    must be wider than nothing; the bottom lands must lie under the face cone and over the rim's underside. Raises what
    the surfaces raise where they do not reach so far.
    """
    _ = concave.blank.stock  # refuses a rim that reaches past the axis
    for bottom in bottoms:
        _check_depth(bottom, bottom.blank)
    for height, where in ((1.0, "tip"), (0.0, "root")):
        _check_widths(concave, convex, height, where)


def _check_widths(concave: ToothSurface, convex: ToothSurface, height: float, where: str) -> None:
    """The slot's width and what the pitch leaves of the tooth, around the axis, at one end of the flanks."""
    length = np.linspace(0.0, 1.0, _STATIONS)
    blank = concave.blank
    ends = [patch.jet(*patch.locate(length, np.full(_STATIONS, height))) for patch in (concave, convex)]
    slot, pitch = slot_and_pitch(blank, ends[0], ends[1])
    cone = blank.cone_height(ends[0].r)[0]
    i = int(np.argmin(slot))
    if not slot[i] >= 0.0:
        raise InputError(
            f"the flanks of one slot cross at the {where}: at cone distance {cone[i]:.4g} mm it is {slot[i]:.4g} mm "
            "wide around the gear axis; wanted is a greater point width, or smaller blade angles"
        )
    i = int(np.argmin(pitch - slot))
    if not pitch[i] - slot[i] > 0.0:
        across = float(np.cos(spiral_angle(blank, ends[0])[i])) * (slot[i] - pitch[i])
        raise InputError(
            f"neighbouring slots overlap at the tooth's {where}: at cone distance {cone[i]:.4g} mm the slot is "
            f"{slot[i]:.4g} mm wide around the gear axis, the pitch {pitch[i]:.4g} mm, which leaves "
            f"{pitch[i] - slot[i]:.4g} mm of tooth; wanted is a slot narrower by more than {across:.4g} mm, measured "
            "across (point width, bottom width, blade or pressure angles), less depth, or fewer teeth"
        )


def slot_and_pitch(blank: BevelBlank, concave: Jet, convex: Jet) -> tuple[NDArray, NDArray]:
    """Width [mm] of the slot and the pitch, both around the gear axis, shape (n,).

    The flanks' points are of one cone distance and height, pair by pair. Negative: the flanks cross.
    """
    here, there = concave.r, convex.r
    turn = np.angle((there[:, 0] + 1j * there[:, 1]) / (here[:, 0] + 1j * here[:, 1]))
    radius = np.hypot(here[:, 0], here[:, 1])
    into_slot = np.sign(concave.normal[:, 1] * here[:, 0] - concave.normal[:, 0] * here[:, 1])
    return radius * turn * into_slot, 2.0 * pi * radius / blank.teeth


def spiral_angle(blank: BevelBlank, jet: Jet) -> NDArray:
    """Angle [rad] from the cone's generator to flank traces on the cone, in (-pi/2, pi/2]; one hand is positive."""
    generator, normal = blank.cone_directions(jet.r)
    trace = np.cross(jet.normal, normal)
    along = np.sum(trace * generator, axis=1)
    across = np.sum(trace * np.cross(normal, generator), axis=1)
    return np.arctan2(np.where(along < 0.0, -across, across), np.abs(along))


def _check_depth(bottom: ToothSurface, blank: BevelBlank) -> None:
    """The bottom land lies in the material of the blank."""
    jet = bottom.jet(*bottom.locate(np.linspace(0.0, 1.0, _STATIONS), np.full(_STATIONS, 0.5)))
    cone, above = blank.cone_height(jet.r)
    depth, under = np.asarray(blank.addendum_at(cone)) - above, above + np.asarray(blank.dedendum_at(cone)) + blank.rim
    i, j = int(np.argmin(depth)), int(np.argmin(under))
    if not depth[i] > 0.0:
        raise InputError(
            f"the slot's bottom lies outside the blank: at cone distance {cone[i]:.4g} mm it is {-depth[i]:.4g} mm "
            "over the face cone; check sliding base, machine root angle and machine centre to back"
        )
    if not under[j] > 0.0:
        raise InputError(
            f"the slot cuts the blank through: at cone distance {cone[j]:.4g} mm its bottom is "
            f"{blank.rim - under[j]:.4g} mm under the root cone, the rim is {blank.rim:.4g} mm; check sliding base, "
            "machine root angle and machine centre to back"
        )
