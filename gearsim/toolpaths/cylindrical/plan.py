"""A whole gear: the operations asked for, one after the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import pi

import numpy as np

from gearsim.machines.chain import Machine
from gearsim.programs.operation import Operation
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.preparation import bore, face, outside_diameter, reference_ring
from gearsim.toolpaths.cylindrical.root import mill_root
from gearsim.toolpaths.cylindrical.settings import (
    Bore,
    Facing,
    Finishing,
    OutsideDiameter,
    ReferenceRing,
    RootMilling,
    Roughing,
    Settings,
    Slotting,
)
from gearsim.toolpaths.cylindrical.slots import slot_spaces
from gearsim.toolpaths.cylindrical.teeth import finish_teeth, rough_teeth


def plan_gear(gear: CylindricalGear, machine: Machine, steps: Sequence[Settings]) -> tuple[Operation, ...]:
    """The operations that the settings stand for, in their order; each one's blocks carry its index.

    Raises InputError where one of them cannot be: see the functions of the operations.
    """
    made: list[Operation] = []
    for i, step in enumerate(steps):
        operation = _numbered(_plan(gear, machine, step), i)
        made.append(_from_there_on(made[-1], operation) if made else operation)
    return tuple(made)


def usual_steps(gear: CylindricalGear) -> tuple[Settings, ...]:
    """Roughing and finishing with the thesis's values, for an external gear after slots that open the root."""
    teeth: tuple[Settings, ...] = (Roughing(), Finishing())
    return teeth if gear.is_internal else (Slotting(), *teeth)


def _plan(gear: CylindricalGear, machine: Machine, step: Settings) -> Operation:
    match step:
        case Slotting():
            return slot_spaces(gear, machine, step)
        case Roughing():
            return rough_teeth(gear, machine, step)
        case Finishing():
            return finish_teeth(gear, machine, step)
        case RootMilling():
            return mill_root(gear, machine, step)
        case Facing():
            return face(machine, step)
        case Bore():
            return bore(machine, step)
        case OutsideDiameter():
            return outside_diameter(machine, step)
        case ReferenceRing():
            return reference_ring(machine, step)
    raise TypeError(f"no operation for {type(step).__name__}")


def _from_there_on(before: Operation, operation: Operation) -> Operation:
    """The same operation some whole turns of the table farther, nearest to where the one before ended."""
    blocks = operation.blocks
    column = GearTable(blocks.machine, 0.0).column
    turns = 2.0 * pi * np.round((before.blocks.values[-1, column] - blocks.start[column]) / (2.0 * pi))
    start, values = blocks.start.copy(), blocks.values.copy()
    start[column] += turns
    values[:, column] += turns
    return replace(operation, blocks=replace(blocks, start=start, values=values))


def _numbered(operation: Operation, index: int) -> Operation:
    blocks = operation.blocks
    return replace(operation, blocks=replace(blocks, operation=blocks.operation * 0 + index))
