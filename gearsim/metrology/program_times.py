"""What a program takes: time in feed of each of its operations, and how fast its tools run over the part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearsim.machines.axis_speed import fastest_axis
from gearsim.metrology.inspection import Reading, Steps
from gearsim.programs.gcode import Program

if TYPE_CHECKING:
    from gearsim.metrology.job import Job


@dataclass(frozen=True)
class ProgramMeasurement:
    """By operation: time in feed [s], largest speed of the tool's axis on the part in straight feed blocks, and the
    feed asked for [mm/min] (nan: none is known); how many ``blocks`` and ``lines`` there are.
    """

    variant: str
    cutting_s: dict[str, float]
    speeds: dict[str, tuple[float, float]]
    blocks: int
    lines: int
    surface: str = ""
    inspection: str = "program"


@dataclass(frozen=True)
class ProgramInspection:
    """A program as it was read; ``feeds`` [mm/min] asked for in each of its operations."""

    variant: str
    program: Program
    feeds: tuple[float, ...]
    name: str = "program"

    def steps(self, job: Job) -> Steps[Reading]:
        yield []
        text = next((o.text for o in job.variant(self.variant).operations), "")
        cutting, speeds, blocks = self._cutting_seconds(), self._fastest(), self.program.blocks
        return Reading((ProgramMeasurement(self.variant, cutting, speeds, len(blocks), text.count("\n")),))

    def _cutting_seconds(self) -> dict[str, float]:
        blocks = self.program.blocks
        return {
            name: float(np.nansum(blocks.seconds[(blocks.operation == i) & ~blocks.rapid]))
            for i, name in enumerate(self.program.operations)
        }

    def _fastest(self) -> dict[str, tuple[float, float]]:
        blocks, names = self.program.blocks, self.program.operations
        way = fastest_axis(blocks.machine, blocks.before, blocks.values - blocks.before)
        fed = ~blocks.rapid & ~blocks.tip_control & (blocks.sweep == 0.0) & (blocks.seconds > 0.0)
        speed = np.where(fed, 60.0 * way / np.where(fed, blocks.seconds, 1.0), 0.0)
        largest = (float(np.max(speed[blocks.operation == i], initial=0.0)) for i in range(len(names)))
        return dict(zip(names, zip(largest, self.feeds, strict=True), strict=True))
