"""In which order a gear is cut, and its spaces one after the other on the machine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.chain import Machine
from gearsim.programs.blocks import Blocks
from gearsim.programs.operation import Operation
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.toolpaths.cylindrical.axes import GearTable
from gearsim.toolpaths.cylindrical.feed import block_seconds, cutting_seconds
from gearsim.toolpaths.cylindrical.settings import Cutting
from gearsim.toolpaths.cylindrical.track import Track


def every_space(gear: CylindricalGear, table: GearTable, space: Track, name: str, cutting: Cutting) -> Operation:
    """A space's track repeated in all spaces, as an operation.

    The teeth come last in the order: a space is finished, layer by layer and each layer from top to bottom, before
    the next (Groover 2018, chapter 3). Only the table tells the spaces apart; it goes on turning the same way.
    """
    values = table.values(space.heading, space.tip, space.lean)
    moved = np.concatenate([[True], (np.diff(values, axis=0) != 0.0).any(axis=1)])
    values, rapid, lever = values[moved], space.rapid[moved], space.lever[moved]
    seconds = block_seconds(table.machine, values, rapid, lever, table.column, cutting.feed)
    turns = gear.pitch_angle * np.arange(gear.count)
    everywhere = np.concatenate([table.turned(values, turn) for turn in turns])
    rapid, seconds = (np.tile(column, gear.count) for column in (rapid, seconds))
    blocks = straight(table.machine, everywhere, rapid, seconds, cutting)
    return Operation(name, cutting.tool, cutting.spindle, blocks, comments=(told_time(seconds),))


def straight(machine: Machine, values: NDArray, rapid: NDArray, seconds: NDArray, cutting: Cutting) -> Blocks:
    """Blocks without arcs from axis values (n + 1, k), whose first are the start; the columns have n + 1 rows, too."""
    n = len(values) - 1
    nil = np.zeros(n, dtype=int)
    return Blocks(
        machine, values[0], values[1:], rapid[1:], np.zeros(n, dtype=bool), seconds[1:],
        line=nil, tool=nil + cutting.tool.number, operation=nil,
        sweep=np.zeros(n), centre=np.zeros((n, 3)), normal=nil + 2,
    )  # fmt: skip


def told_time(seconds: NDArray) -> str:
    """The comment that states an operation's cutting time."""
    return f"cutting time {cutting_seconds(seconds) / 60.0:.1f} min without rapids"
