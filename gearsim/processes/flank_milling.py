"""Flank milling of a bevel tooth slot: two passes, planned here or read from CL data."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from math import inf
from pathlib import Path

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.metrology.convergence import Series
from gearsim.metrology.dexel_check import DexelInspection, slot_box
from gearsim.metrology.grid import COARSE, GridInspection
from gearsim.metrology.holder_check import HolderInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job
from gearsim.metrology.mean_profile import ProfileInspection, Published
from gearsim.metrology.other_spaces import SpacesInspection
from gearsim.metrology.rapid_check import RapidInspection
from gearsim.metrology.root import RootInspection
from gearsim.motion.sources import CLMotion, MotionSource
from gearsim.processes.cl_notes import pass_notes, posting_notes
from gearsim.processes.cl_tools import cl_cutters, cl_operations
from gearsim.processes.claims import Claim, Swept
from gearsim.processes.errors import error_notes, mounted
from gearsim.processes.flank_program import machine_program, operation_of, run_operations
from gearsim.processes.parts import Limits, bevel_part, held
from gearsim.processes.settings import settings
from gearsim.processes.slot_program import slot_program
from gearsim.programs.cldata import RAPID, CLProgram, format_cl, parse_cl, read_cl_text
from gearsim.scene import FlankMillingScene, scene_table
from gearsim.scene.flank_milling import FaceMilledFlankTable, MetrologyTable, ReferenceTable, RuledBevelTable
from gearsim.simulation.operation import Operation, Variant, operation
from gearsim.surfaces.part import Part, Tolerance
from gearsim.surfaces.patch import SIDES, Side, Tooth
from gearsim.toolpaths.tangent import FlankPass

THEORY, OWN, PROGRAM, OTHERS, LAST = "theory", "own pass", "program", "other passes", "last operation"
PROGRAM_FILE = "program.nc"
_RAPID, _RAPID_LINE = "rapid move {number} of the CL data", "the rapid move of line {line}"
_RUN = (
    "program is what the machine, errors of its axes included, does with program.nc as it is written; "
    "the other motions are those of the CL data, without them"
)
_CONVENTIONS = {
    THEORY: "the flank's own pass, planner's continuous motion (what planning costs)",
    OWN: "the flank's own pass as CL data (adds what discretisation costs)",
    PROGRAM: "the whole CL program, rapid moves included (adds what the other flank's pass costs)",
    OTHERS: "the whole CL program but the flank's own pass",
}


def plan(scene: FlankMillingScene, folder: Path) -> Job:
    """Build the geometry, plan or read the toolpath, and compile the motions of a scene.

    ``folder`` is where a relative CL file name is looked up.
    """
    cutter, m = scene.tool(), scene.metrology
    tooth, part = tooth_and_part(scene.surface, limits(m))
    planners = {} if scene.toolpath.file is not None else scene.planners()
    if scene.toolpath.file is not None:
        text = read_cl_text(folder / scene.toolpath.file)
        program = parse_cl(text, str(folder / scene.toolpath.file))
        cutters, notes = cl_cutters(program, scene.toolpath.file, cutter)
        notes += (*program.notes, *pass_notes(program))
        notes += posting_notes(program, scene.program)
        told = tuple(f"CL file: {note}" for note in notes)
        holders = tuple(scene.held() if one == cutter else None for one in cutters)
    else:
        planned = slot_program(scene, tooth, planners)
        text = format_cl(planned.program, scene.name, scene.toolpath.feed_mm_min, scene.toolpath.decimals)
        program, told = parse_cl(text, "planned CL data"), planned.notes
        cutters, holders = zip(*planned.tools, strict=True)
    files = {"toolpath.cl": text}
    if scene.program:
        files[PROGRAM_FILE] = machine_program(scene, scene.program, program, cutters)
    real = real_cutters(scene, cutters)
    run = run_operations(scene, program, real, holders, files.get(PROGRAM_FILE, ""))
    return Job(
        name=scene.name,
        part=part,
        variants=tuple(_variants(scene, program, planners, real, holders, run)),
        main=PROGRAM,
        inspections=(
            *_inspections(scene, tooth, program, planners, run is not None),
            *held(PROGRAM, tooth, m.tooth),
        ),
        settings=settings(scene),
        scene=scene_table(scene),
        files=files,
        notes=(*told, *error_notes(scene.errors), *[_RUN] * (run is not None)),
        conventions={"grids": "rows root to tip, columns toe to heel"},
    )


def limits(table: MetrologyTable) -> Limits:
    """What of flanks and roots is tolerated."""
    root = Tolerance(table.root_tolerance_um, table.root_excess_um or inf)
    return Limits(Tolerance.both(table.tolerance_um), root)


@lru_cache(maxsize=8)
def tooth_and_part(surface: RuledBevelTable | FaceMilledFlankTable, within: Limits) -> tuple[Tooth, Part]:
    """The tooth slot that a surface table describes, and the part with it; kept, for jobs beside each other share them.

    Raises InputError for a slot that no gear has.
    """
    tooth = surface.build()
    return tooth, bevel_part(tooth, within, mate=tooth.blank.mate(surface.mate_teeth).stock)


def claims(scene: FlankMillingScene, folder: Path) -> list[Claim]:
    """The envelopes of the cutter's profile elements under each flank's planned path, or each path of its CL file.

    Nothing has errors here.
    """
    cutter, table = scene.tool(), scene.toolpath
    if table.file is None:
        return [Swept(p.motion, cutter, side) for side, p in scene.planners().items()]
    program = parse_cl(read_cl_text(folder / table.file), str(folder / table.file))
    cutters, _ = cl_cutters(program, table.file, cutter)
    cuts = [p for p in program.paths if p.name != RAPID]
    names = [_numbered([p.name for p in cuts[: i + 1]]) for i in range(len(cuts))]
    return [Swept(CLMotion(p.tips, p.axes), cutters[p.tool], name) for p, name in zip(cuts, names, strict=True)]


def real_cutters(scene: FlankMillingScene, cutters: Sequence[Profile]) -> tuple[Profile, ...]:
    """The program's cutters, that of the scene with its errors. Raises InputError where it is none of them."""
    nominal, real = scene.tool(), scene.real_tool()
    if real != nominal and nominal not in cutters:
        raise InputError(
            f"errors: {', '.join(t for t in scene.errors.acting() if t.startswith('tool_'))}: they are those of "
            f"[cutter], but no tool of {scene.toolpath.file} is like it"
        )
    return tuple(real if cutter == nominal else cutter for cutter in cutters)


def _numbered(names: list[str]) -> str:
    """The last of some names, with its number from the second of that name on."""
    count = names.count(names[-1])
    return names[-1] if count == 1 else f"{names[-1]} {count}"


def own_paths(program: CLProgram, side: Side) -> list[int]:
    """Which paths of a CL program finish a flank: those named after it, else every cutting path; the last one's tool's.

    Passes of other tools prepare it.
    """
    named = [i for i, path in enumerate(program.paths) if path.name == side]
    passes = named or [i for i, path in enumerate(program.paths) if path.name != RAPID]
    return [i for i in passes if program.paths[i].tool == program.paths[passes[-1]].tool]


def _variants(
    scene: FlankMillingScene, program: CLProgram, planners: Mapping[Side, FlankPass], cutters: Sequence[Profile],
    holders: Sequence[Profile | None], run: tuple[Operation, ...] | None,
) -> Iterator[Variant]:  # fmt: skip
    tolerance, cutter, errors = scene.simulation.compile_tolerance_mm, scene.real_tool(), scene.errors
    sources = [mounted(CLMotion(p.tips, p.axes), errors) for p in program.paths]
    whole = Variant(PROGRAM, _CONVENTIONS[PROGRAM], cl_operations(program, cutters, sources, tolerance, holders))
    yield whole if run is None else Variant(PROGRAM, _RUN, run)
    for side in SIDES:
        own = own_paths(program, side)
        rest = [i for i in range(len(sources)) if i not in own]
        if side in planners:
            exact = operation(f"{side} flank, continuous", cutter, [mounted(planners[side].motion, errors)], tolerance)
            yield Variant(THEORY, _CONVENTIONS[THEORY], (exact,), (side,))
        yield Variant(OWN, _CONVENTIONS[OWN], _along(whole, own), (side,))
        if rest:
            yield Variant(OTHERS, _CONVENTIONS[OTHERS], _along(whole, rest), (side,))
        if side in planners:
            for n in scene.metrology.convergence:
                yield _of_points(n, side, mounted(planners[side].cl_motion(n), errors), cutter, tolerance)


def _along(whole: Variant, paths: Sequence[int]) -> tuple[Operation, ...]:
    """The whole program's operations along some of its paths alone."""
    return whole.chosen(lambda _, operation: np.isin(operation.step, paths)).operations


def _of_points(n: int, side: Side, motion: MotionSource, cutter: Profile, tolerance: float) -> Variant:
    given = operation(f"{side} flank, {n} points", cutter, [motion], tolerance)
    return Variant(f"N = {n}", f"the flank's own pass as {n} CL points", (given,), (side,))


def _inspections(
    scene: FlankMillingScene, tooth: Tooth, program: CLProgram, planners: Mapping[Side, FlankPass], run: bool
) -> Iterator[Inspection]:
    m = scene.metrology
    box = slot_box(tooth.patches, tooth.blank, scene.simulation.dexel_pitch_mm)
    dense = []
    for side in SIDES:
        alone = len(own_paths(program, side)) == len(program.paths)
        motions = (THEORY, OWN) if planners else (OWN,)
        points = m.convergence if planners else ()
        series = (Series(OWN, THEORY, points, tuple(f"N = {n}" for n in points)),) if points else ()
        grid = GridInspection(
            side, (*motions, PROGRAM), motions, m.rows, m.columns, m.margin, m.window, judged=(PROGRAM,),
            strangers="" if alone else OTHERS, series=series,
        )  # fmt: skip
        if run:  # no other motion is the program's, so both roads are asked for what of it finishes the flank
            grid = replace(
                grid,
                variants=(PROGRAM, *motions),
                last=LAST,
                heading=operation_of(program, own_paths(program, side)[-1]),
            )
        dense.append(grid)
        yield grid
        yield GridInspection(
            side, (*motions, PROGRAM), motions, m.inspection_rows, m.inspection_columns, m.inspection_margin, m.window,
            rotated=True, name=COARSE,
        )  # fmt: skip
        height = float(tooth.blank.mid_working_depth_at(tooth.blank.mean))
        yield ProfileInspection(side, motions[0], m.profile_offsets_mm, height, _published(scene.reference, side))
    yield RapidInspection(PROGRAM, box, _RAPID_LINE if run else _RAPID)
    if scene.has_holders:
        yield HolderInspection(PROGRAM, tuple(dense), box)
    root = tuple(p.name for p in tooth.patches if p.part != "flank")
    yield RootInspection(root, PROGRAM, max(3, m.rows // 2), m.columns, m.margin, m.window)
    roots = tuple(GridInspection(s, (PROGRAM,), (), max(3, m.rows // 2), m.columns, m.margin, m.window) for s in root)
    yield SpacesInspection(PROGRAM, tooth.blank.teeth, tuple(dense), roots=roots)
    yield DexelInspection(PROGRAM, box, tuple(dense))


def _published(reference: ReferenceTable | None, side: Side) -> Published | None:
    if reference is None:
        return None
    turn = -1.0 if reference.overcut_is_positive else 1.0
    um = tuple(turn * value for value in getattr(reference, f"{side}_um"))
    return Published(reference.source, reference.note, reference.overcut_is_positive, um)
