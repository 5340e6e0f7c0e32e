"""How far along a flank a pass may go, and which part of the flank a tool reaches (Groover 2018, 3.2 and 3.3).

The tool's axis lies in a plane tangent to the base cylinder, along the contact line. On a flank with f kappa > 0 the
roll of the contact falls by kappa for each mm above the tool's end, on the other one it grows: whatever limits the
roll must hold from the tool's end up to the top face.
"""

from __future__ import annotations

from functools import lru_cache
from math import cos, sin, sqrt, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign
from gearsim.surfaces.tool_access import reachable_roll, tool_diameter_at
from gearsim.toolpaths.counts import check_count
from gearsim.toolpaths.cylindrical.steps import descent

TIP_CLEARANCE_MM = 0.5  # between tool and tip cylinder where a pass begins or ends in the open


def transverse(gear: CylindricalGear, distance: float) -> float:
    """N: a distance [mm] along the normal as it stands in the transverse plane (3.27 repaired)."""
    return distance / cos(gear.base_helix_angle)


@lru_cache(4096)  # every cause of an error budget plans the same passes
def pass_range(gear: CylindricalGear, side: Side, z: float, tool_radius: float, stock: float) -> tuple[float, float]:
    """Rolls [rad] at the tool's end, least and largest, of a pass at height z [mm] that leaves ``stock`` [mm].

    Empty where the first is not below the second. The tool keeps off both flanks (`reachable_roll`, for a tool that
    is thicker by the stock) and off the root circle. At the tip it runs into the open: an external gear's pass ends
    where all of the tool has left the tip cylinder (in place of 3.36), an internal one's as far beyond the tip as
    the base circle lets it.
    """
    offset = transverse(gear, tool_radius + stock)
    low, high = reachable_roll(gear, side, tool_radius + stock, z)
    lean = gear.twist * flank_sign(side) * abs(z)
    edge = transverse(gear, tool_radius)
    floor = gear.sign * _centre_roll(gear, gear.root_radius + gear.sign * edge, offset)
    if gear.is_internal:
        concave = (tool_radius + stock) * cos(gear.base_helix_angle) / gear.base_radius + max(lean, 0.0)
        beyond = _roll(gear, gear.tip_radius - TIP_CLEARANCE_MM) - abs(lean)
        return max(beyond, concave), min(high, -floor + min(lean, 0.0))
    reach = gear.tip_radius + edge + TIP_CLEARANCE_MM
    below = abs(gear.twist * (tool_radius + stock) * sin(gear.base_helix_angle))  # the tool's middle, on down flanks
    return max(low, floor + max(lean, 0.0)), _centre_roll(gear, reach, offset) + max(lean, below)


def overrun(gear: CylindricalGear, tool_radius: float) -> float:
    """How far the last pass goes below the bottom face [mm], for the leaning tool's end to leave it altogether.

    That takes the rise over its diameter; the passes of both flanks in the middle of a space overlap by half of it.
    """
    return 3.0 * tool_radius * abs(tan(gear.base_helix_angle))


def pass_levels(gear: CylindricalGear, tool_radius: float, axial_step: float) -> NDArray:
    """Heights [mm] of the passes over the facewidth, (n,)."""
    return descent(0.0, -gear.facewidth - overrun(gear, tool_radius), axial_step)


def reached_range(
    gear: CylindricalGear, side: Side, z: ArrayLike, tool_radius: float, axial_step: float
) -> tuple[NDArray, NDArray]:
    """Rolls [rad], least and largest, between which finishing reaches a flank at heights z [mm] from -b to 0, (n,).

    nan where it reaches none. Between two passes the range ends where the end of the next deeper one's tool does.
    """
    z = np.atleast_1d(np.asarray(z, dtype=float))
    low, high = np.full(len(z), np.inf), np.full(len(z), -np.inf)
    for level in pass_levels(gear, tool_radius, axial_step):
        start, end = pass_range(gear, side, level, tool_radius, 0.0)
        touched = (z >= level - 1e-9) & (start < end)
        shift = -flank_sign(side) * gear.twist * (z - level)
        low = np.where(touched, np.minimum(low, start + shift), low)
        high = np.where(touched, np.maximum(high, end + shift), high)
    first, last = sorted((gear.root_roll, gear.tip_roll))
    low, high = np.maximum(low, first), np.minimum(high, last)
    reached = low < high
    return np.where(reached, low, np.nan), np.where(reached, high, np.nan)


def stock_layers(gear: CylindricalGear, tool_radius: float, stock: float, step: float) -> NDArray:
    """Stock [mm] that each layer of roughing leaves, from the largest down to ``stock``, shape (n,).

    Steps count from the last layer (the thesis's program; 3.9 counts from the first). In the first one the tools of
    both flanks meet in the space's middle at the tip (at the base circle, if that is nearer the root), so that no
    web is left; where it is larger, that is for an external gear what the space is wider at the tip than where the
    involute ends at the root: the thesis's maximum 3.16, R_b cos(beta_b) inv(tip), where that is the base circle.
    """
    scale = gear.base_radius * cos(gear.base_helix_angle)
    mouth, bottom = (float(gear.half_space(r)) for r in (gear.tip_form_radius, gear.root_form_radius))
    first = scale * mouth - 2.0 * tool_radius
    if not gear.is_internal:
        first = max(first, scale * (mouth - bottom))
    check_count(max(first, stock) - stock, step)
    layers = np.arange(stock, max(first, stock) + 1e-9, step)
    if first - layers[-1] > 1e-6:
        layers = np.append(layers, first)
    return layers[::-1]


def check_tool(gear: CylindricalGear, tool_radius: float) -> None:
    """Raise InputError where a tool is too thick to finish any part of a flank."""
    for side in ("left", "right"):
        low, _ = reached_range(gear, side, np.array([0.0]), tool_radius, gear.facewidth / 100.0)
        if np.isnan(low[0]):
            raise InputError(
                f"tool of {2.0 * tool_radius:g} mm cannot enter the spaces: it reaches no part of the {side} flank; "
                f"where a tool generates the flank's tip a space is {tool_diameter_at(gear, gear.tip_roll):.4g} mm wide"
            )


def _centre_roll(gear: CylindricalGear, radius: float, offset: float) -> float:
    """Roll at which the tool's axis stands at a radius [mm], the transverse offset [mm] from the flank."""
    return _roll(gear, radius) - gear.sign * offset / gear.base_radius


def _roll(gear: CylindricalGear, radius: float) -> float:
    ratio = radius / gear.base_radius
    return sqrt(max((ratio - 1.0) * (ratio + 1.0), 0.0))
