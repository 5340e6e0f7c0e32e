"""Roughing and finishing of teeth by generation: the passes of one space, layer by layer, level by level."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.operation import Operation
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.limits import check_tool, overrun, pass_levels, pass_range, stock_layers
from gearsim.toolpaths.cylindrical.links import visit
from gearsim.toolpaths.cylindrical.order import every_space
from gearsim.toolpaths.cylindrical.passes import flank_pass
from gearsim.toolpaths.cylindrical.settings import Finishing, Roughing
from gearsim.toolpaths.cylindrical.steps import roll_points, with_points
from gearsim.toolpaths.cylindrical.track import Track, join

ROUGHING = Roughing()
FINISHING = Finishing()


def rough_teeth(gear: CylindricalGear, machine: Machine, settings: Roughing = ROUGHING) -> Operation:
    """Layers of stock from the space's middle to the flanks, in steps of the radial immersion (Groover 2018, 3.1).

    Raises InputError for a tool that does not fit the spaces or is too short, and for unsuited machines.
    """
    cutting = settings.cutting
    step = settings.radial_immersion * cutting.tool.diameter
    layers = stock_layers(gear, cutting.radius, settings.stock, step)
    return _teeth(gear, machine, "tooth roughing", settings, layers, None)


def finish_teeth(gear: CylindricalGear, machine: Machine, settings: Finishing = FINISHING) -> Operation:
    """One layer down to the flank itself, or to its modification (the thesis's program leaves its stock here, too).

    Raises InputError as ``rough_teeth`` does, and for a modification that does not fit the gear.
    """
    if settings.modification is not None:
        settings.modification.check(gear)
    return _teeth(gear, machine, "tooth finishing", settings, np.zeros(1), settings.modification)


def _teeth(
    gear: CylindricalGear,
    machine: Machine,
    name: str,
    settings: Roughing | Finishing,
    layers: NDArray,
    modification: FlankModification | None,
) -> Operation:
    cutting = settings.cutting
    cutting.check_depth(f"{name}, face width and overrun", gear.facewidth + overrun(gear, cutting.radius))
    check_tool(gear, cutting.radius)
    levels = pass_levels(gear, cutting.radius, settings.axial_step)
    visits = []
    for stock in layers:
        for z in levels:
            passes = {side: _pass(gear, side, z, stock, settings, modification) for side in SIDES}
            right, left = _both(passes["right"], passes["left"])
            if right is not None and left is not None:
                visits.append(visit(gear, right, left, cutting.radius, stock, settings.clearance))
    if not visits:
        raise InputError(f"{name}: the tool leaves {layers[-1]:g} mm of stock nowhere in a space; leave less stock")
    return every_space(gear, GearTable(machine, gear.base_helix_angle), join(*visits), name, cutting)


def _pass(
    gear: CylindricalGear,
    side: Side,
    z: float,
    stock: float,
    settings: Roughing | Finishing,
    modification: FlankModification | None,
) -> Track | None:
    """A pass in the direction of down-milling, or None where the tool finds no room."""
    radius = settings.cutting.radius
    low, high = pass_range(gear, side, z, radius, stock)
    if not low < high:
        return None
    inward = (side == "right") != gear.is_internal
    ends = (high, low) if inward else (low, high)
    rolls = roll_points(gear.base_radius, *ends, settings.involute_step, settings.spacing)
    if modification is not None:
        rolls = with_points(rolls, modification.kinks)
    return flank_pass(gear, side, z, rolls, radius + stock, modification)


def _both(right: Track | None, left: Track | None) -> tuple[Track | None, Track | None]:
    """Where only one flank is reached, the way to it and back runs along that flank."""
    if right is None and left is not None:
        right = left.reversed()
    elif left is None and right is not None:
        left = right.reversed()
    return right, left
