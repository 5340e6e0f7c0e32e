"""A user's file, G-code, CL data or a table of axis values, as the operations of its tools in the part's frame."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, read_input
from gearsim.motion.axes import AxisMotion
from gearsim.motion.sources import CLMotion, MovedMotion
from gearsim.processes.cl_tools import cl_cutters, cl_operations
from gearsim.programs.axis_table import parse_axis_table
from gearsim.programs.cldata import parse_cl, read_cl_text
from gearsim.programs.gcode import Program, read_program
from gearsim.scene.any_program import ProgramScene
from gearsim.simulation.operation import Operation, operation
from gearsim.simulation.program import program_operations


@dataclass(frozen=True)
class ReadFile:
    """The ``operations`` of a file; ``notes`` on how it was read; ``move`` calls a rapid (see `RapidInspection`).

    ``program``: what was read of G-code, None of other files.
    """

    operations: tuple[Operation, ...]
    notes: tuple[str, ...]
    move: str
    program: Program | None = None


def read_file(scene: ProgramScene, file: Path) -> ReadFile:
    """Read a scene's file by its ending.

    Raises InputError for a program that cannot be read, that moves none of the scene's tools, or another tool.
    """
    if scene.toolpath.is_gcode:
        return _gcode(scene, file)
    return _axis_table(scene, file) if scene.toolpath.is_axis_table else _cl_data(scene, file)


def _gcode(scene: ProgramScene, file: Path) -> ReadFile:
    machine, reading, cutters, table = scene.controller(), scene.reading(), scene.cutters(), scene.toolpath
    assert machine is not None
    assert reading is not None
    text = read_input(file, "program")
    program = read_program(file, machine, dialect=table.dialect, settings=reading)
    tolerance = scene.simulation.compile_tolerance_mm
    found = program_operations(
        program.blocks, cutters, tolerance, shift=table.mounting.build(), text=text, headings=program.operations,
        holders=scene.holders(), real=scene.faulty(),
    )  # fmt: skip
    if not found:
        listed = ", ".join(f"T{number} M06" for number in sorted(cutters))
        raise InputError(f"{file}: it moves none of the scene's tools; expected {listed} and moves behind it")
    return ReadFile(found, program.notes, "the rapid move of line {line}", program)


def _cl_data(scene: ProgramScene, file: Path) -> ReadFile:
    shift, mine, held = scene.toolpath.mounting.build(), scene.cutters(), scene.holders()
    program = parse_cl(read_cl_text(file), str(file))
    one = None if scene.cutter is None else mine[1]
    cutters, notes = cl_cutters(program, scene.toolpath.file, one, mine if scene.tools else None)
    holders = [next((held.get(n) for n, ours in mine.items() if ours == cutter), None) for cutter in cutters]
    sources = [MovedMotion(CLMotion(p.tips, p.axes), shift) for p in program.paths]
    found = cl_operations(program, cutters, sources, scene.simulation.compile_tolerance_mm, holders)
    told = tuple(f"CL file: {note}" for note in (*notes, *program.notes))
    return ReadFile(found, told, "rapid move {number} of the CL data")


def _axis_table(scene: ProgramScene, file: Path) -> ReadFile:
    """All axes linear between the blocks, none of them a rapid."""
    machine, (cutter,), shift = scene.controller(), scene.cutters().values(), scene.toolpath.mounting.build()
    assert machine is not None
    table = parse_axis_table(read_input(file, "axis table"), machine, str(file))
    source = MovedMotion(AxisMotion(machine, table.values), shift)
    tolerance, holder = scene.simulation.compile_tolerance_mm, _only(scene.holders())
    whole = operation("axis table", cutter, [source], tolerance, holder=holder, lines=[table.lines])
    return ReadFile((whole,), (), "rapid move {number}")


def _only(holders: dict[int, Profile]) -> Profile | None:
    """The holder of the one tool, where it is given."""
    return next(iter(holders.values()), None)
