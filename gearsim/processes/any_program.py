"""A program of the user's own, G-code or CL data, cut into any surface."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from difflib import get_close_matches
from pathlib import Path

from gearsim.errors import InputError, read_input
from gearsim.metrology.dexel_check import DexelInspection
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.rapid_check import RapidInspection
from gearsim.motion.sources import CLMotion, MovedMotion
from gearsim.processes.cl_tools import cl_cutters, cl_operations
from gearsim.processes.parts import Limits, part_of
from gearsim.processes.settings import settings
from gearsim.programs.cldata import parse_cl, read_cl_text
from gearsim.programs.gcode import read_program
from gearsim.scene import scene_table
from gearsim.scene.any_program import ProgramScene
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import Operation, Variant
from gearsim.simulation.program import program_operations
from gearsim.surfaces.part import Part, Tolerance

PROGRAM, LAST = "program", "last operation"


def plan(scene: ProgramScene, folder: Path) -> Job:
    """Read the program, relative to ``folder``, and lay its tools over the surface.

    Raises InputError for a program that cannot be read, that moves none of the scene's tools, or another tool.
    """
    m = scene.metrology
    limits = Limits(Tolerance.both(m.tolerance_um), Tolerance(m.root_tolerance_um or m.tolerance_um, float("inf")))
    part, box = part_of(scene.surface, folder, limits, m.window_mm, scene.simulation.dexel_pitch_mm)
    judged = _judged(scene, part)
    free = {name: replace(s, tolerance=s.tolerance if name in judged else None) for name, s in part.surfaces.items()}
    part = replace(part, surfaces=free)
    file = folder / scene.toolpath.file
    operations, notes = _gcode(scene, file) if scene.toolpath.is_gcode else _cl_data(scene, file)
    move = "the rapid move of line {line}" if scene.toolpath.is_gcode else "rapid move {number} of the CL data"
    return Job(
        name=scene.name,
        part=part,
        variants=(Variant(PROGRAM, f"the whole of {scene.toolpath.file}", operations),),
        main=PROGRAM,
        inspections=tuple(_inspections(scene, part, box, judged, move)),
        settings=settings(scene),
        scene=scene_table(scene),
        notes=notes,
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


def _gcode(scene: ProgramScene, file: Path) -> tuple[tuple[Operation, ...], tuple[str, ...]]:
    machine, reading, cutters, table = scene.controller(), scene.reading(), scene.cutters(), scene.toolpath
    assert machine is not None
    assert reading is not None
    text = read_input(file, "program")
    program = read_program(file, machine, dialect=table.dialect, settings=reading)
    tolerance = scene.simulation.compile_tolerance_mm
    found = program_operations(
        program.blocks, cutters, tolerance, shift=table.mounting.build(), text=text, headings=program.operations
    )
    if not found:
        listed = ", ".join(f"T{number} M06" for number in sorted(cutters))
        raise InputError(f"{file}: it moves none of the scene's tools; expected {listed} and moves behind it")
    return found, program.notes


def _cl_data(scene: ProgramScene, file: Path) -> tuple[tuple[Operation, ...], tuple[str, ...]]:
    shift, name = scene.toolpath.mounting.build(), scene.toolpath.file
    program = parse_cl(read_cl_text(file), str(file))
    one = None if scene.cutter is None else scene.cutters()[1]
    cutters, notes = cl_cutters(program, name, one, scene.cutters() if scene.tools else None)
    sources = [MovedMotion(CLMotion(p.tips, p.axes), shift) for p in program.paths]
    found = cl_operations(program, cutters, sources, scene.simulation.compile_tolerance_mm)
    return found, tuple(f"CL file: {note}" for note in (*notes, *program.notes))


def _inspections(
    scene: ProgramScene, part: Part, box: DexelBox | None, judged: tuple[str, ...], move: str
) -> Iterator[Inspection]:
    m = scene.metrology
    grids = tuple(
        GridInspection(
            name, (PROGRAM,), (), m.rows, m.columns, m.margin, m.window,
            judged=(PROGRAM,) if name in judged else (), last=LAST if name in judged else "",
        )
        for name in part.surfaces
    )  # fmt: skip
    yield from grids
    if box is not None:
        yield RapidInspection(PROGRAM, box, move)
        yield DexelInspection(PROGRAM, box, grids)
