"""Planned operations as a program has them: run with tip control or without, rounded, written and read back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.axis_speed import fastest_axis
from gearsim.machines.chain import Machine
from gearsim.programs.gcode import Program, ReadSettings, read_program
from gearsim.programs.operation import Operation
from gearsim.programs.post import write_program
from gearsim.programs.post_options import Header, PostOptions
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.toolpaths.cylindrical.plan import plan_gear
from gearsim.toolpaths.cylindrical.settings import Settings


def planned(
    gear: CylindricalGear, machine: Machine, steps: tuple[Settings, ...], tip_control: bool
) -> tuple[Operation, ...]:
    """The operations, their blocks run with or without tool-centre-point control."""
    operations = plan_gear(gear, machine, steps)
    if not tip_control:
        return operations
    return tuple(with_tip_control(op) for op in operations)


def with_tip_control(operation: Operation) -> Operation:
    """The same blocks, the tip straight on the workpiece between their ends."""
    blocks = operation.blocks
    return replace(operation, blocks=replace(blocks, tip_control=np.ones(len(blocks), dtype=bool)))


def as_printed(operation: Operation, options: PostOptions, feed: float) -> Operation:
    """The operation with its numbers rounded as a program prints them, and slowed down where that lengthens a block."""
    blocks = operation.blocks
    slides = sum(not joint.is_rotary for joint in blocks.machine.joints)

    def rounded(values: NDArray) -> NDArray:
        out = np.round(values, options.linear_decimals)
        out[..., slides:] = np.radians(np.round(np.degrees(values[..., slides:]), options.rotary_decimals))
        return out

    printed = replace(blocks, start=rounded(blocks.start), values=rounded(blocks.values))
    way = fastest_axis(blocks.machine, printed.before, printed.values - printed.before)
    straight = ~blocks.rapid & (blocks.sweep == 0.0)
    seconds = np.where(straight, np.maximum(blocks.seconds, 60.0 * way / feed), blocks.seconds)
    return replace(operation, blocks=replace(printed, seconds=seconds))


def posted(operations: tuple[Operation, ...], machine: Machine, decimals: int) -> Program:
    """Operations written with so many decimals and read back."""
    options = PostOptions(linear_decimals=decimals, rotary_decimals=decimals)
    tools = tuple({operation.tool.number for operation in operations})
    return read_program(write_program(operations, Header(), options), machine, settings=ReadSettings(tools=tools))
