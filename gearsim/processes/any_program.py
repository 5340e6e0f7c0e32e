"""A program of the user's own, G-code, CL data or axis values, cut into any surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path

from gearsim.errors import InputError
from gearsim.metrology.dexel_check import DexelInspection
from gearsim.metrology.grid import COARSE, GridInspection
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.other_spaces import SpacesInspection
from gearsim.metrology.program_times import ProgramInspection
from gearsim.metrology.rapid_check import RapidInspection
from gearsim.metrology.tooth_check import ToothInspection
from gearsim.processes.any_part import part_of
from gearsim.processes.claims import Claim, head_claims
from gearsim.processes.errors import error_notes
from gearsim.processes.generating import generating
from gearsim.processes.parts import Limits, held
from gearsim.processes.read_file import ReadFile, read_file
from gearsim.processes.settings import settings
from gearsim.scene import scene_table
from gearsim.scene.any_program import ProgramScene
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import Variant
from gearsim.surfaces.face_milled import FaceMilledTooth
from gearsim.surfaces.hypoid import HypoidPinion
from gearsim.surfaces.part import Part, Tolerance
from gearsim.surfaces.patch import SIDES

PROGRAM, LAST = "program", "last operation"


def plan(scene: ProgramScene, folder: Path) -> Job:
    """Read the program, relative to ``folder``, and lay its tools over the surface.

    Raises InputError for a program that cannot be read, that moves none of the scene's tools, or another tool.
    """
    m = scene.metrology
    limits = Limits(Tolerance.both(m.tolerance_um), Tolerance(m.root_tolerance_um or m.tolerance_um, float("inf")))
    tooth = scene.tooth()
    part, box = part_of(scene, tooth, folder, limits)
    judged = _judged(scene, part)
    free = {name: replace(s, tolerance=s.tolerance if name in judged else None) for name, s in part.surfaces.items()}
    part = replace(part, surfaces=free)
    read = read_file(scene, folder / scene.toolpath.file)
    whole = Variant(PROGRAM, f"the whole of {scene.toolpath.file}", read.operations)
    own = generating(tooth, scene.simulation.compile_tolerance_mm)
    on_blank = held(PROGRAM, tooth, m.tooth)
    asked = _Plan(scene, part, box, judged, read, own[0].name if own else "", on_blank)
    return Job(
        name=scene.name,
        part=part,
        variants=(whole, *own),
        main=PROGRAM,
        inspections=tuple(asked.inspections()),
        settings=settings(scene),
        scene=scene_table(scene),
        notes=(*read.notes, *error_notes(scene.errors)),
        conventions={"grids": "rows root to tip, columns along the face (a net: along v and u)"},
    )


def _judged(scene: ProgramScene, part: Part) -> tuple[str, ...]:
    """The surfaces to be held against a tolerance."""
    for name in scene.metrology.judged:
        if name not in part.surfaces:
            near = get_close_matches(name, part.surfaces, n=1, cutoff=0.4)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise InputError(f"metrology.judged: got {name!r}, expected one of {', '.join(part.surfaces)}{hint}")
    return scene.metrology.judged or tuple(part.surfaces)


@dataclass(frozen=True)
class _Plan:
    """What the inspections are made of; ``own`` names the motion that generates the surfaces (empty: none does).

    ``tooth``: how they are held against their blank, where a head generates them.
    """

    scene: ProgramScene
    part: Part
    box: DexelBox | None
    judged: tuple[str, ...]
    read: ReadFile
    own: str
    tooth: tuple[ToothInspection, ...]

    def inspections(self) -> Iterator[Inspection]:
        grids = tuple(self._dense(name) for name in self.part.surfaces)
        yield from grids
        yield from (self._coarse(side) for side in SIDES if side in self.part.surfaces)
        count = self.scene.spaces()
        if count > 1:
            yield SpacesInspection(PROGRAM, count, tuple(grid for grid in grids if grid.judged))
        if self.box is not None:
            yield RapidInspection(PROGRAM, self.box, self.read.move)
            yield DexelInspection(PROGRAM, self.box, grids)
        if self.scene.holders():
            yield HolderInspection(PROGRAM, grids, self.box)
        if self.read.program is not None:
            unknown = (float("nan"),) * len(self.read.program.operations)
            yield ProgramInspection(PROGRAM, self.read.program, unknown)
        yield from self.tooth

    def _dense(self, surface: str) -> GridInspection:
        m, judged = self.scene.metrology, surface in self.judged
        motions = (self.own,) if self.own else ()
        others = [name for name in self.part.surfaces if name not in self.judged]
        return GridInspection(
            surface, (PROGRAM, *motions), motions, m.rows, m.columns, m.margin, m.window,
            judged=(PROGRAM,) if judged else (), generating=self.own, last=LAST if judged else "",
            remark=f"not judged: {', '.join(others)}" if others else "",
        )  # fmt: skip

    def _coarse(self, side: str) -> GridInspection:
        m = self.scene.metrology
        return GridInspection(
            side, (PROGRAM,), (), m.inspection_rows, m.inspection_columns, m.inspection_margin, m.window, rotated=True,
            name=COARSE,
        )  # fmt: skip


def claims(scene: ProgramScene, folder: Path) -> list[Claim]:
    """What is known of a tooth that a head generates."""
    tooth = scene.tooth()
    return head_claims(tooth) if isinstance(tooth, FaceMilledTooth | HypoidPinion) else []
