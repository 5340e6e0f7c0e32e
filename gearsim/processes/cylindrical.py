"""Cylindrical gears milled by end mills on a five-axis machine: planned, posted and read back, or read from a file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np

from gearsim.errors import InputError, read_input
from gearsim.machines.chain import Machine
from gearsim.metrology.dexel_check import DexelInspection
from gearsim.metrology.gear_inspection import gear_size
from gearsim.metrology.gear_iso import GearProbing, ProbedGear
from gearsim.metrology.gear_reach import ReachInspection
from gearsim.metrology.gear_roughness import RoughnessInspection
from gearsim.metrology.gear_section import SectionInspection, SpaceInspection, section_rays, space_box
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.other_spaces import SpacesInspection
from gearsim.metrology.program_times import ProgramInspection
from gearsim.metrology.rapid_check import RapidInspection
from gearsim.processes.claims import Claim, Involute
from gearsim.processes.errors import error_notes
from gearsim.processes.frames import FACE_FRAME
from gearsim.processes.gear_budget import disturbed_operations, gear_budget
from gearsim.processes.settings import settings
from gearsim.programs.gcode import Program, read_program
from gearsim.programs.operation import Tool
from gearsim.programs.post import write_program
from gearsim.programs.post_options import Header
from gearsim.scene import CylindricalGearScene, scene_table
from gearsim.scene.cylindrical import ErrorsTable
from gearsim.simulation.disturbance import Disturbance
from gearsim.simulation.operation import Variant
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side
from gearsim.surfaces.finished_gear import FinishedGear
from gearsim.surfaces.gear_root import GearRoot
from gearsim.surfaces.gear_stock import back_radius, gear_stock
from gearsim.surfaces.involute import InvoluteFlank
from gearsim.surfaces.part import Intended, Part, Tolerance
from gearsim.surfaces.reached_flank import ReachedFlank
from gearsim.toolpaths.cylindrical.limits import reached_range
from gearsim.toolpaths.cylindrical.posting import as_printed, planned
from gearsim.toolpaths.cylindrical.settings import Finishing, RootMilling, Settings

PROGRAM, LAST = "program", "last operation"
_HEIGHTS = 41
_CONVENTIONS = {
    "transverse": "traces, parameters and budget are transverse (ISO 1328-1); maps are along the normal",
    "slopes": "positive where material grows from root to tip, or from the top face to the bottom",
    "spaces": "counted from 1; space 1 on +x at the top face z = 0",
    "grids": "rows root to tip, columns top to bottom face",
}


def plan(scene: CylindricalGearScene, folder: Path) -> Job:
    """Plan and post a scene's gear and read the program back; or read the user's own, relative to ``folder``.

    Raises InputError where the gear cannot be cut this way or has no tolerances, or for a program that cannot be read
    or moves without a tool of the scene, a length or an offset that is known (``ReadSettings.tools``).
    """
    made = programmed(scene, folder)
    program, probed, tools = made.program, made.probed, made.tools
    tolerance, real = scene.simulation.compile_tolerance_mm, disturbance(scene.errors)
    whole = disturbed_operations(
        program.blocks, tools, real, tolerance, made.text, program.operations, scene.holders()
    )  # fmt: skip
    variants, inspections = [Variant(PROGRAM, "the whole program", whole)], list(gear_inspections(scene, probed))
    known = [step.cutting.feed for step in scene.paths()]
    feeds = [np.nan] * len(program.operations) if scene.program.file else known
    inspections.append(ProgramInspection(PROGRAM, program, tuple(feeds)))
    if scene.budget:
        causes, budget = gear_budget(scene, probed, scene.controller(), tools, PROGRAM)
        variants += causes
        inspections.append(budget)
    return Job(
        name=scene.name,
        part=gear_part(scene, probed),
        variants=tuple(variants),
        main=PROGRAM,
        inspections=tuple(inspections),
        settings=settings(scene),
        scene=scene_table(scene),
        files={"program.nc": made.text},
        notes=(*program.notes, *made.notes, *error_notes(scene.errors)),
        conventions=_CONVENTIONS,
    )


class Programmed(NamedTuple):
    """A gear's program as it is read, its text, its tools by number, what is probed, and what must be told."""

    program: Program
    text: str
    tools: dict[int, Tool]
    probed: ProbedGear
    notes: tuple[str, ...]


def programmed(scene: CylindricalGearScene, folder: Path) -> Programmed:
    """The program of a scene's gear, whatever errors it is run with. Raises InputError as ``plan``."""
    gear, machine, steps = scene.gear(), scene.controller(), scene.paths()
    gear_size(gear)
    program, text = _program(scene, folder, gear, machine, steps)
    tools = {t.number: t.build() for t in scene.tools}
    if not set(np.unique(program.blocks.tool).tolist()) & set(tools):
        listed = ", ".join(f"T{number} M06" for number in sorted(tools))
        raise InputError(f"program: it moves none of the scene's tools; expected {listed} and moves behind it")
    finishing, notes = scene.finishing(), _finished_by(scene, program)
    probed = ProbedGear(gear, {side: _reached(gear, side, finishing) for side in SIDES}, finishing.modification)
    return Programmed(program, text, tools, probed, notes)


def disturbance(errors: ErrorsTable) -> Disturbance:
    """The scene's errors in mm."""
    x, y, z = (1e-3 * e for e in errors.pivot_um)
    return Disturbance(
        1e-3 * errors.tool_radius_um, 1e-3 * errors.tool_runout_um, (x, y, z), 1e-3 * errors.eccentricity_um,
        errors.of_axes(),
    )  # fmt: skip


def _program(
    scene: CylindricalGearScene, folder: Path, gear: CylindricalGear, machine: Machine, steps: tuple[Settings, ...]
) -> tuple[Program, str]:
    """The program that is cut, and its text."""
    reading = scene.reading()
    if scene.program.file:
        file = folder / scene.program.file
        text = read_input(file, "program")
        return read_program(file, machine, dialect=scene.program.dialect, settings=reading), text
    exact = planned(gear, machine, steps, scene.program.tip_control)
    options = scene.program.options()
    operations = [as_printed(op, options, step.cutting.feed) for op, step in zip(exact, steps, strict=True)]
    text = write_program(operations, _header(scene, gear), options)
    return read_program(text, machine, settings=reading), text


def _finished_by(scene: CylindricalGearScene, program: Program) -> tuple[str, ...]:
    """A note where a program of the user's own ends with another tool than the one that is said to finish the flanks.

    What that one reaches is probed. Raises InputError where it cuts nothing.
    """
    if not scene.program.file:
        return ()
    cutting = program.blocks.tool[~program.blocks.rapid]
    number, there = scene.finishing().cutting.tool.number, sorted(set(cutting.tolist()))
    if number not in there:
        listed = ", ".join(f"T{tool}" for tool in there)
        raise InputError(
            f"toolpath.finishing.tool: T{number} cuts nothing in {scene.program.file}, {listed} does; what the tool "
            "that finishes the flanks reaches is probed: name that one"
        )
    last = int(cutting[-1])
    told = (
        f"toolpath.finishing.tool is T{number}, and what it reaches is probed; {scene.program.file} ends with T{last}"
    )
    return (told,) * (last != number)


def gear_part(scene: CylindricalGearScene, probed: ProbedGear) -> Part:
    tolerance = Tolerance.both(scene.metrology.tolerance_um)
    flanks = {
        side: Intended(ReachedFlank(probed.gear, side, 0, probed.design, probed.reached[side]), tolerance)
        for side in SIDES
    }
    blank, named = gear_stock(probed.gear, scene.surface.rim_mm), {str(s): i for s, i in flanks.items()}
    if _root_heading(scene) is not None:
        named["root"] = Intended(GearRoot(scene.surface.outline()), _root_tolerance(scene))
    return Part(FACE_FRAME, blank, named, whole=_whole(scene, probed))


def _whole(scene: CylindricalGearScene, probed: ProbedGear) -> FinishedGear:
    """All of the gear's surface, flanks, root and what was turned before them each by its own tolerance."""
    m, outline = scene.metrology, scene.surface.outline()
    flank, body = Tolerance.both(m.tolerance_um), Tolerance.both(m.body_tolerance_um)
    back = back_radius(probed.gear, scene.surface.rim_mm)
    return FinishedGear(outline, back, flank, _root_tolerance(scene), body, probed.design)


def _root_heading(scene: CylindricalGearScene) -> int | None:
    """Which of the planned operations mills the root; None: none does, or the program is the user's own."""
    planned_root = (i for i, step in enumerate(scene.paths()) if isinstance(step, RootMilling))
    return None if scene.program.file else next(planned_root, None)


def _root_tolerance(scene: CylindricalGearScene) -> Tolerance:
    return Tolerance(scene.metrology.root_tolerance_um, scene.metrology.root_excess_um)


def gear_inspections(scene: CylindricalGearScene, probed: ProbedGear) -> Iterator[Inspection]:
    m, gear, rim = scene.metrology, probed.gear, scene.surface.rim_mm
    spaces = tuple(range(m.spaces or gear.count))
    yield GearProbing(PROGRAM, probed, spaces, m.points, m.iso_class, scene.name)
    grids = tuple(
        GridInspection(side, (PROGRAM,), (), m.rows, m.columns, m.margin, judged=(PROGRAM,), last=LAST)
        for side in SIDES
    )
    yield from grids
    heading = _root_heading(scene)
    if heading is not None:
        yield GridInspection(
            "root", (PROGRAM,), (), m.rows, m.columns, m.margin, judged=(PROGRAM,), last=LAST, heading=heading
        )
    if len(spaces) < gear.count:
        yield SpacesInspection(PROGRAM, gear.count, grids, spaces)
    box = space_box(gear, scene.simulation.dexel_pitch_mm)
    yield RapidInspection(PROGRAM, box, "the rapid move of line {line}")
    if scene.holders():
        yield HolderInspection(PROGRAM, grids, box)
    yield ReachInspection(PROGRAM, probed, scene.finishing().cutting.tool.diameter)
    yield SpaceInspection(DexelInspection(PROGRAM, box, grids), gear, dict(probed.reached))
    yield RoughnessInspection(PROGRAM, probed)
    yield SectionInspection(PROGRAM, section_rays(gear, rim, m.section_pitch_mm))


def _reached(gear: CylindricalGear, side: Side, finishing: Finishing) -> tuple[float, float]:
    """Rolls at the root and the tip end of what finishing reaches at every height of a flank.

    Raises InputError where no part is reached over the whole facewidth.
    """
    heights = np.linspace(-gear.facewidth, 0.0, _HEIGHTS)
    low, high = reached_range(gear, side, heights, finishing.cutting.radius, finishing.axial_step)
    first, last = float(np.max(low)), float(np.min(high))
    if not first < last:
        raise InputError(
            f"the tool of {finishing.cutting.tool.diameter:g} mm reaches no part of the {side} flank over the whole "
            "facewidth; take a thinner one or a narrower gear"
        )
    return (last, first) if gear.is_internal else (first, last)


def _header(scene: CylindricalGearScene, gear: CylindricalGear) -> Header:
    kind = "internal" if gear.is_internal else "external"
    return Header(
        scene.program.number,
        scene.name,
        (
            f"{kind} gear, {gear.count} teeth, normal module {gear.module:.6g}, normal pressure angle "
            f"{np.degrees(gear.pressure_angle):.6g} deg, helix angle {np.degrees(gear.helix_angle):.6g} deg",
            f"facewidth {gear.facewidth:g}, tip radius {gear.tip_radius:.4f}, root radius {gear.root_radius:.4f}",
            "z = 0 at the top face, space 1 on +X",
        ),
    )


def claims(scene: CylindricalGearScene, folder: Path) -> list[Claim]:
    """Both flanks as the finishing end mill generates them, without modification."""
    gear, radius = scene.gear(), scene.finishing().cutting.radius
    return [Involute(InvoluteFlank(gear, side), radius) for side in SIDES]
