"""A program run on a machine, as motions of its tools: what they remove from rays, whichever tool it was."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.generation_milling.disturbance import Disturbance
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.machine import MachineFor
from gearsim.motion.program import ProgramMotion
from gearsim.motion.segments import SegmentTable, compile_motion
from gearsim.motion.sources import MotionSource, MovedMotion
from gearsim.programs.blocks import Blocks
from gearsim.programs.operation import Tool
from gearsim.simulation.intervals import IntervalSet, nothing, unite


@dataclass(frozen=True)
class ToolMotion:
    """What one tool does relative to the gear: a table compiled from ``source``, whose rows count from ``first_row``.

    ``source`` moves the tool relative to the table; ``shift`` takes what is seen from there to the gear's frame.
    """

    cutter: Profile
    source: ProgramMotion
    table: SegmentTable
    shift: Rigid
    first_row: int

    @property
    def blocks(self) -> NDArray[np.integer]:
        """The block of every row of the table."""
        return self.source.rows[self.table.piece]

    def part(self, chosen: NDArray[np.bool_]) -> SegmentTable:
        """The rows of the chosen blocks."""
        return self.table.part(chosen[self.blocks])

    def passes(self, chosen: NDArray[np.bool_]) -> list[MotionSource]:
        """The exact motion of the chosen feed blocks, cut up at the rapids between them."""
        blocks = self.source.blocks
        number = np.cumsum(blocks.rapid)
        moving = np.isin(np.arange(len(blocks)), self.source.rows) & chosen & ~blocks.rapid
        return [MovedMotion(self.source.select(moving & (number == k)), self.shift) for k in np.unique(number[moving])]


@dataclass(frozen=True)
class ProgramCut:
    """All tools of a program; segments are numbered through, tool after tool."""

    motions: tuple[ToolMotion, ...]
    machine_for: MachineFor

    def removed(self, rays: RayBundle) -> IntervalSet:
        """What the program removes from rays. Raises NumericalError where a status forbids trust."""
        parts = []
        for motion in self.motions:
            machine = self.machine_for(motion.cutter)
            part = machine.removed(rays, motion.table)
            parts.append(_numbered(part, motion.first_row))
        return unite(parts)

    def removed_by(self, rays: RayBundle, chosen: NDArray[np.bool_]) -> IntervalSet:
        """What the chosen blocks, shape (n,) of the program, remove from rays; segments are not numbered."""
        parts = [
            self.machine_for(motion.cutter).removed(rays, motion.part(chosen))
            for motion in self.motions
            if chosen[motion.blocks].any()
        ]
        return unite(parts) if parts else nothing(len(rays))

    @property
    def blocks(self) -> NDArray[np.integer]:
        """The block of every segment."""
        return np.concatenate([m.blocks for m in self.motions])


def run_program(
    blocks: Blocks, tools: Mapping[int, Tool], real: Disturbance, machine_for: MachineFor, tolerance: float
) -> ProgramCut:
    """The motions of a program's blocks as a disturbed machine runs them, relative to the gear."""
    run = replace(blocks, machine=real.machine(blocks.machine))
    motions: list[ToolMotion] = []
    row = 0
    for number in sorted(set(blocks.tool.tolist()) & set(tools)):
        cutter = real.cutter(tools[number])
        source = ProgramMotion(run, blocks.tool == number)
        table = compile_motion(source, cutter.reach, tolerance).moved(real.mounting)
        motions.append(ToolMotion(cutter, source, table, real.mounting, row))
        row += len(table)
    return ProgramCut(tuple(motions), machine_for)


def _numbered(part: IntervalSet, first: int) -> IntervalSet:
    def shifted(segment: NDArray) -> NDArray:
        return np.where(segment >= 0, segment + first, segment)

    return replace(part, lo_segment=shifted(part.lo_segment), hi_segment=shifted(part.hi_segment))
