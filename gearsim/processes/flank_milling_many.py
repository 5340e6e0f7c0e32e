"""Many flank-milled teeth planned together: what their tables share is built once, all motions compiled at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gearsim.cutters.profile import Profile
from gearsim.errors import GearsimError
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.job import Job
from gearsim.motion.segments import SegmentTable, compile_cl
from gearsim.motion.sources import CLMotion
from gearsim.processes.brief import Brief, Planned, shortened
from gearsim.processes.cl_tools import cl_operations
from gearsim.processes.errors import mounted
from gearsim.processes.flank_milling import PROGRAM, limits, plan, real_cutters, tooth_and_part
from gearsim.processes.settings import settings
from gearsim.processes.slot_program import slot_program
from gearsim.programs.cldata import CLProgram, as_read
from gearsim.scene import FlankMillingScene
from gearsim.simulation.operation import Variant
from gearsim.surfaces.part import Part
from gearsim.surfaces.patch import SIDES


@dataclass(frozen=True)
class _Half:
    """A scene whose program is known and not compiled yet."""

    scene: FlankMillingScene
    part: Part
    program: CLProgram
    sources: tuple[CLMotion, ...]
    cutters: tuple[Profile, ...]

    @property
    def reaches(self) -> list[float]:
        """Of each source its cutter's."""
        return [self.cutters[path.tool].reach for path in self.program.paths]

    def job(self, tables: Sequence[SegmentTable]) -> Job:
        bare = (None,) * len(self.cutters)
        tolerance = self.scene.simulation.compile_tolerance_mm
        operations = cl_operations(self.program, self.cutters, self.sources, tolerance, bare, tables)
        whole, m = Variant(PROGRAM, "the whole CL program", operations), self.scene.metrology
        grids = (
            GridInspection(side, (PROGRAM,), (), m.rows, m.columns, m.margin, m.window, judged=(PROGRAM,))
            for side in SIDES
        )
        return Job(self.scene.name, self.part, (whole,), PROGRAM, tuple(grids), settings(self.scene))


def plan_many(scenes: Sequence[FlankMillingScene], folder: Path, brief: Brief) -> list[Planned | GearsimError]:
    """Each scene's job with the maps of its flanks alone, or why it has none. Figures are those of ``plan``'s job."""
    out: dict[int, Planned | GearsimError] = {}
    halves: dict[int, _Half] = {}
    for i, scene in enumerate(scenes):
        try:
            if scene.toolpath.file is None and not scene.runs_program:
                halves[i] = _half(scene)
            else:
                out[i] = Planned(shortened(plan(scene, folder), brief))
        except GearsimError as error:
            out[i] = error
    return [job for _, job in sorted({**out, **_compiled(halves)}.items())]


def _half(scene: FlankMillingScene) -> _Half:
    tooth, part = tooth_and_part(scene.surface, limits(scene.metrology))
    planned = slot_program(scene, tooth, scene.planners())
    program = as_read(planned.program, scene.toolpath.decimals)
    sources = tuple(mounted(CLMotion(p.tips, p.axes), scene.errors) for p in program.paths)
    return _Half(scene, part, program, sources, real_cutters(scene, [tool.cutter for tool in planned.tools]))


def _compiled(halves: dict[int, _Half]) -> dict[int, Planned | GearsimError]:
    """The jobs; scenes of one tolerance are compiled together, one by one where one of them cannot be."""
    by_tolerance: dict[float, list[int]] = {}
    for i, half in halves.items():
        by_tolerance.setdefault(half.scene.simulation.compile_tolerance_mm, []).append(i)
    out: dict[int, Planned | GearsimError] = {}
    for tolerance, members in by_tolerance.items():
        try:
            sources = [source for i in members for source in halves[i].sources]
            reaches = [reach for i in members for reach in halves[i].reaches]
            tables = iter(compile_cl(sources, reaches, tolerance))
            out |= {i: Planned(halves[i].job([next(tables) for _ in halves[i].sources])) for i in members}
        except GearsimError as error:
            if len(members) == 1:
                out[members[0]] = error
            else:
                for i in members:
                    out |= _compiled({i: halves[i]})
    return out
