"""Radial slots: the spaces of an external gear cut open with a radial tool (Groover 2018, A.4.5)."""

from __future__ import annotations

from dataclasses import replace
from math import atan, pi

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.operation import Operation
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.limits import transverse
from gearsim.toolpaths.cylindrical.order import every_space
from gearsim.toolpaths.cylindrical.settings import Slotting
from gearsim.toolpaths.cylindrical.steps import parts
from gearsim.toolpaths.cylindrical.track import Track, join, moved_out, polar, track

SLOTTING = Slotting()
_EXACT_MM = 1e-9
_CLEAR_MM = 1.0  # between the tool's flutes and a face where it turns round


def slot_spaces(gear: CylindricalGear, machine: Machine, settings: Slotting = SLOTTING) -> Operation:
    """Slots with radial walls from the tip inward and from the middle to the walls, as deep as the tool finds room.

    The room is that of the space where the tool's end is: it narrows to the root or, where that lies inside it, to the
    base circle, under which walls go on radially. The last walls stand there, the stock off the flanks (the thesis has
    eta_b; on the finished flank at the base circle, which lies inside the root of 42 teeth and more). On helical gears
    the flutes farther out, where the helix is steeper, bite r (1 - cos(its change)) deeper: 1.3 um on the thesis's
    gear. Down-milling, from the top face: the left wall downward, the right one upward. Radii at which the tool is
    wider than the slot are left to the generating passes.

    Raises InputError for internal gears, a tool wider than the slot at the tip or shorter than the tooth, and
    unsuited machines.
    """
    if gear.is_internal:
        raise InputError("radial slots need an external gear: an internal gear's tool cannot stand radially in it")
    cutting = settings.cutting
    depth = gear.tip_radius - gear.root_radius - (settings.root_stock or 0.0)
    if depth <= 0.0:
        raise InputError(f"slots: root_stock_mm = {settings.root_stock:g} leaves nothing of the teeth to be cut")
    cutting.check_depth("slots, tooth depth", depth)
    radii = np.linspace(gear.tip_radius, gear.tip_radius - depth, parts(depth, settings.radial_step) + 1)[1:]
    open_ = radii[_half_width(gear, radii, settings.stock) >= cutting.radius - _EXACT_MM]
    if not len(open_):
        width = 2.0 * float(_half_width(gear, np.array([gear.tip_radius]), settings.stock)[0])
        raise InputError(
            f"slots: the tool of {cutting.tool.diameter:g} mm is wider than the slot, "
            f"{max(width, 0.0):.4g} mm between its walls at the tip circle"
        )
    wall = float(_wall_angle(gear, open_[-1:], settings.stock)[0])
    step = settings.radial_immersion * cutting.tool.diameter
    space = join(*(_cut(gear, radius, wall, step, cutting.radius) for radius in open_))
    rim = gear.tip_radius + settings.clearance.rim
    first, last = (track(space.heading[[i]], moved_out(space.tip[i], rim), rapid=True) for i in (0, -1))
    table = GearTable(machine, 0.5 * pi)
    return every_space(gear, table, join(first, space, last), "slots", cutting)


def _wall_angle(gear: CylindricalGear, radii: NDArray, stock: float) -> NDArray:
    """From a space's middle to walls that reach radii [mm] and keep the stock [mm] from the flanks [rad], (n,)."""
    return gear.half_space(np.maximum(radii, gear.base_radius)) - transverse(gear, stock) / gear.base_radius


def _half_width(gear: CylindricalGear, radii: NDArray, stock: float) -> NDArray:
    """Radius [mm] of the tool that fits with its end at radii [mm], (n,), along both walls at once; negative: none."""
    return radii * np.tan(_wall_angle(gear, radii, stock))


def _cut(gear: CylindricalGear, radius: float, wall: float, step: float, tool_radius: float) -> Track:
    """All passes with the tool's end at one radius [mm]."""
    first = min(atan(tool_radius / radius), wall)
    walls = np.unique(np.linspace(first, wall, parts((wall - first) * radius, step) + 1))
    return join(*(_both_walls(gear, radius, angle, tool_radius) for angle in walls))


def _both_walls(gear: CylindricalGear, radius: float, angle: float, tool_radius: float) -> Track:
    """Down the left wall and up the right one, ``angle`` [rad] from the middle; the first station by rapid."""
    top = 2.0 * tool_radius + _CLEAR_MM
    down = np.array([top, -gear.facewidth - top])
    left = _wall(gear, radius, -1, angle, down, tool_radius)
    right = _wall(gear, radius, 1, angle, down[::-1], tool_radius)
    return join(replace(left, rapid=np.array([True, False])), right)


def _wall(gear: CylindricalGear, radius: float, f: int, angle: float, z: NDArray, tool_radius: float) -> Track:
    """The tool, parallel to the wall's radius, one tool radius off it along the helicoid's normal at its end."""
    around = f * angle + gear.space_centre(0, z)
    slope = np.arctan(gear.twist * radius)
    normal = f * np.stack(
        [np.sin(around) * np.cos(slope), -np.cos(around) * np.cos(slope), np.full(len(z), np.sin(slope))], axis=-1
    )
    return track(around - 0.5 * pi, polar(radius, around, z) + tool_radius * normal)
