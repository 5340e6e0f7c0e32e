"""A dense map of one flank of space 0: under the whole program, and under its last operation alone by both roads."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import machined_along
from gearsim.generation_milling.cutting import ProgramCut, ToolMotion
from gearsim.generation_milling.job import GearJob
from gearsim.generation_milling.probing import ReachedFlank
from gearsim.metrology.deviation import Deviation, measure
from gearsim.metrology.roads import road_gap
from gearsim.metrology.samples import sample_grid
from gearsim.metrology.surface import SurfaceResult
from gearsim.surfaces.cylindrical_gear import Side

WHOLE, LAST = "program", "last operation"


def measure_map(job: GearJob, cut: ProgramCut, side: Side) -> SurfaceResult:
    """Measure space 0's flank; for the envelope road, the blocks that make it and all between them.

    Each pass is a motion of its own: passes at other heights generate the same flank, to what rounding leaves.
    """
    m = job.scene.metrology
    patch = ReachedFlank(job.gear, side, 0, job.finishing.modification, job.reached[side])
    grid = sample_grid(patch, m.rows, m.columns, m.margin)
    rays, nowhere = grid.rays(), np.zeros(grid.shape, dtype=bool)
    whole = measure(rays, cut.removed(rays)).reshaped(grid.shape)
    surface = SurfaceResult(grid, nowhere, nowhere, {WHOLE: whole}, {}, {})
    made = _made_by(job, cut, whole)
    if made is not None:
        tool, chosen = made
        machine = cut.machine_for(tool.cutter)
        surface.deviations[LAST] = own = machine.measure([rays], tool.part(chosen))[0].reshaped(grid.shape)
        surface.gaps[LAST] = road_gap(machined_along(rays, tool.passes(chosen), tool.cutter), own)
    return surface


def _made_by(job: GearJob, cut: ProgramCut, deviation: Deviation) -> tuple[ToolMotion, NDArray[np.bool_]] | None:
    """The tool whose last operation cut the flank, and the blocks it took; None where none of them did."""
    blocks = job.program.blocks
    segment = np.unique(deviation.segment[deviation.segment >= 0])
    block = cut.blocks[segment]
    block = block[blocks.operation[block] == blocks.operation.max()]
    if not len(block):
        return None
    tool = next(m for m in cut.motions if blocks.tool[block[0]] == blocks.tool[m.source.rows[0]])
    number = np.arange(len(blocks))
    return tool, (number >= block.min()) & (number <= block.max()) & (blocks.tool == blocks.tool[block[0]])
