"""Many cylindrical gears planned together: machines with errors of all kinds run one program.

Of the program only the blocks are compiled that bring a tool near a probed point; see `nearby`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import GearsimError
from gearsim.metrology.gear_iso import GearProbing
from gearsim.metrology.gear_probing import all_rays, probing
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.kept import Kept
from gearsim.metrology.samples import sample_grid
from gearsim.motion.program import ProgramMotion
from gearsim.motion.real_motion import RealMotion
from gearsim.processes.brief import Brief, Planned, kept, shortened
from gearsim.processes.cylindrical import (
    PROGRAM,
    Programmed,
    disturbance,
    gear_inspections,
    gear_part,
    plan,
    programmed,
)
from gearsim.processes.gear_budget import disturbed_operations
from gearsim.processes.settings import settings
from gearsim.scene import CylindricalGearScene
from gearsim.scene.cylindrical import ErrorsTable
from gearsim.simulation.disturbance import Disturbance
from gearsim.simulation.near import Cloud, rows_near
from gearsim.simulation.operation import Variant
from gearsim.surfaces.cylindrical_gear import SIDES
from gearsim.surfaces.part import Part

_NEAR_MM = 0.1  # what is measured must be smaller than half of it, and what errors move the tool by, too
_EVERY = 61  # of the blocks, by which it is told how far errors move the tool


@dataclass(frozen=True)
class _Basis:
    """What gears that differ by their errors alone share; ``near``: the blocks that may touch what is probed."""

    made: Programmed
    part: Part
    inspections: tuple[Inspection, ...]
    near: NDArray[np.bool_]


_BASES: Kept[_Basis] = Kept(4)


def plan_many(scenes: Sequence[CylindricalGearScene], folder: Path, brief: Brief) -> list[Planned | GearsimError]:
    """Each scene's job with what the brief wants alone, or why it has none. Figures are those of ``plan``'s job."""
    return [_planned(scene, folder, brief) for scene in scenes]


def _planned(scene: CylindricalGearScene, folder: Path, brief: Brief) -> Planned | GearsimError:
    whole = partial(_whole, scene, folder, brief)
    try:
        basis, real = _basis(scene, folder, brief), disturbance(scene.errors)
        if 2.0 * _moved(basis.made, real) > _NEAR_MM:
            return Planned(whole())
        blocks, tools, tolerance = basis.made.program.blocks, basis.made.tools, scene.simulation.compile_tolerance_mm
        operations = disturbed_operations(blocks, tools, real, tolerance, chosen=basis.near)
        variant = Variant(PROGRAM, "the program's blocks that come near what is probed", operations)
        job = Job(scene.name, basis.part, (variant,), PROGRAM, basis.inspections, settings(scene))
        return Planned(job, 0.5 * _NEAR_MM, whole)
    except GearsimError as error:
        return error


def _whole(scene: CylindricalGearScene, folder: Path, brief: Brief) -> Job:
    return shortened(plan(scene.model_copy(update={"budget": None}), folder), brief)


def _basis(scene: CylindricalGearScene, folder: Path, brief: Brief) -> _Basis:
    """What the scene shares with those that differ by their errors; kept."""
    bare = scene.model_copy(update={"errors": ErrorsTable(), "budget": None, "reference": None})
    return _BASES.get((bare.model_dump_json(), folder, brief), lambda: _made(bare, folder, brief))


def _made(bare: CylindricalGearScene, folder: Path, brief: Brief) -> _Basis:
    made = programmed(bare, folder)
    inspections = tuple(kept(gear_inspections(bare, made.probed), PROGRAM, brief))
    part = gear_part(bare, made.probed)
    near = nearby(made, _points(part, inspections), bare.simulation.compile_tolerance_mm)
    return _Basis(made, part, inspections, near)


def _points(part: Part, inspections: Sequence[Inspection]) -> NDArray[np.floating]:
    """Where inspections measure, shape (n, 3)."""
    found: list[NDArray] = []
    for i in inspections:
        if isinstance(i, GearProbing):
            lines = (probing(i.probed.gear, side, i.probed.reached[side], i.points) for side in SIDES)
            found += [all_rays(line, i.spaces).origin for line in lines]
        elif isinstance(i, GridInspection):
            grid = sample_grid(part.patch(i.surface), i.rows, i.columns, i.margin, i.window)
            found.append(grid.point.reshape(-1, 3))
    points = np.concatenate(found)
    return points[np.isfinite(points).all(axis=1)]


def nearby(made: Programmed, points: NDArray, tolerance: float) -> NDArray[np.bool_]:
    """The blocks of a program that may bring a tool within ``_NEAR_MM`` of points, shape (n, 3).

    All others leave at least so much on a point's ray either way. While no error moves the tool by half of it, they
    decide no deviation smaller than the other half.
    """
    cloud, near = Cloud(points, _NEAR_MM), np.zeros(len(made.program.blocks), dtype=bool)
    for operation in disturbed_operations(made.program.blocks, made.tools, Disturbance(), tolerance):
        near[operation.step[rows_near(operation.table, operation.cutter, cloud)]] = True
    return near


def _moved(made: Programmed, real: Disturbance) -> float:
    """How far [mm] errors move a point of a tool, as every so many blocks' ends show it, and the tool's own size."""
    blocks, machine = made.program.blocks, real.machine(made.program.blocks.machine)
    size = abs(real.tool_radius) + abs(real.tool_runout) + abs(real.eccentricity)
    if machine is None:
        return size
    seen = np.isin(blocks.tool, list(made.tools)) & (np.arange(len(blocks)) % _EVERY == 0)
    program = ProgramMotion(blocks, seen)
    run = RealMotion(program, machine)
    last = np.searchsorted(run.rows, program.rows, side="right") - 1
    ends = np.ones(len(last))
    as_meant, as_run = program.pose(np.arange(program.pieces), ends, 0), run.pose(last, ends, 0)
    reach = max(real.cutter(tool).reach for tool in made.tools.values())
    off = np.linalg.norm(as_run.tip.value - as_meant.tip.value, axis=1)
    off += reach * np.linalg.norm(as_run.axis.value - as_meant.axis.value, axis=1)
    return size + float(off.max())
