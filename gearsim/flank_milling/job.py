"""A flank-milling job: a scene made ready to run, with its geometry, program and motions, nothing cut yet."""

from __future__ import annotations

from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

from gearsim.cutters.profile import Profile
from gearsim.flank_milling.program import machine_program
from gearsim.metrology.bevel import FlankMotion
from gearsim.metrology.dexel_check import slot_box
from gearsim.motion.segments import SegmentTable, compile_motion, join
from gearsim.motion.sources import CLMotion, MotionSource
from gearsim.programs.cldata import RAPID, CLPath, CLProgram, assemble, check_cutter, format_cl, parse_cl, read_cl_text
from gearsim.scene import FlankMillingScene
from gearsim.scene.program import ProgramTable
from gearsim.surfaces.patch import SIDES, Side, Tooth
from gearsim.toolpaths.links import clear_rapids
from gearsim.toolpaths.tangent import FlankPass


@dataclass(frozen=True)
class Job:
    """A scene made ready to run: geometry, program and motions, nothing cut yet.

    ``paths`` are the program's exact motions in order, ``path_names`` their names, ``path_tables`` the
    tables compiled from them; ``theory`` holds the planner's continuous motions, by flank. ``nc_text`` is the same
    path for the scene's machine (empty: it has none); it is written, not simulated. ``notes``: what a person must be
    told of the user's CL file.
    """

    scene: FlankMillingScene
    tooth: Tooth
    cutter: Profile
    cl_text: str
    nc_text: str
    path_names: tuple[str, ...]
    paths: tuple[MotionSource, ...]
    path_tables: tuple[SegmentTable, ...]
    planners: dict[Side, FlankPass]
    theory: dict[Side, FlankMotion]
    notes: tuple[str, ...] = ()

    @property
    def program(self) -> SegmentTable:
        return join(list(self.path_tables))

    def own_paths(self, side: Side) -> list[int]:
        """Indices of the paths that finish a flank: those named after it, else every cutting path."""
        named = [i for i, name in enumerate(self.path_names) if name == side]
        return named or [i for i, name in enumerate(self.path_names) if name != RAPID]

    def compiled(self, source: MotionSource) -> SegmentTable:
        """A motion of this job's cutter as a table, to the scene's tolerance."""
        return compile_motion(source, self.cutter.reach, self.scene.simulation.compile_tolerance_mm)

    def segment_count(self) -> int:
        """Rows of the program's table."""
        return len(self.program)

    def ring_pairs(self) -> int:
        """Rays times segments for ring-shaped heads, which mill no flanks."""
        return 0

    def envelope_samples(self) -> int:
        """Samples the envelope road will solve for."""
        m = self.scene.metrology
        motions = 2 if self.theory else 1
        return 2 * motions * (m.rows * m.columns + m.inspection_rows * m.inspection_columns)

    def ray_count(self) -> int:
        """Rays the run will cut, the tri-dexel's check (a few thousand) left out."""
        m = self.scene.metrology
        dense, coarse = m.rows * m.columns, m.inspection_rows * m.inspection_columns
        motions = 3 if self.theory else 2
        others = dense if len(set(self.path_names)) > 1 else 0
        flank = motions * (dense + coarse) + 2 * len(m.profile_offsets_mm) + others
        converge = (len(m.convergence) + 1) * dense if self.theory and m.convergence else 0
        box = slot_box(self.tooth.patches, self.tooth.blank, self.scene.simulation.dexel_pitch_mm).counts
        dexels = int(box[0] * box[1] + box[1] * box[2] + box[0] * box[2])
        return 2 * (flank + converge) + 3 * max(3, m.rows // 2) * m.columns + dexels


def plan(scene: FlankMillingScene, folder: Path) -> Job:
    """Build the geometry, plan or read the toolpath, and compile the motions of a scene.

    ``folder`` is where a relative CL file name is looked up.
    """
    tooth, cutter = scene.tooth(), scene.tool()
    tooth.check()
    table = scene.toolpath
    planners: dict[Side, FlankPass] = {}
    notes: tuple[str, ...] = ()
    if table.file is not None:
        text = read_cl_text(folder / table.file)
        program = parse_cl(text, str(folder / table.file))
        notes = (*check_cutter(program.cutter, cutter, table.file), *program.notes, *_pass_notes(program))
        notes += _posting_notes(program, scene.program)
    else:
        planners = scene.planners()
        text = _planned_program(planners, cutter, tooth, scene)
        program = parse_cl(text, "planned CL data")
    sources = [CLMotion(p.tips, p.axes) for p in program.paths]
    theory_motions = {side: planner.motion for side, planner in planners.items()}
    tolerance = scene.simulation.compile_tolerance_mm
    tables = [compile_motion(s, cutter.reach, tolerance) for s in sources]
    theory = {
        side: FlankMotion([motion], compile_motion(motion, cutter.reach, tolerance))
        for side, motion in theory_motions.items()
    }
    names = tuple(p.name for p in program.paths)
    nc_text = machine_program(scene, scene.program, program, cutter) if scene.program else ""
    return Job(scene, tooth, cutter, text, nc_text, names, tuple(sources), tuple(tables), planners, theory, notes)


def _planned_program(
    planners: dict[Side, FlankPass], cutter: Profile, tooth: Tooth, scene: FlankMillingScene
) -> str:  # fmt: skip
    """Our own CL program as text, its rapids clear of the blank; what is simulated is read back from it."""
    table = scene.toolpath
    passes = []
    for side, planner in planners.items():
        planner.check_passage()
        motion = planner.cl_motion(table.points)
        passes.append(CLPath(side, motion.tips, motion.axes))
    program = assemble(passes, table.retract_mm, cutter)
    program = clear_rapids(program, cutter, tooth.blank.stock, table.retract_mm)
    return format_cl(program, scene.name, table.feed_mm_min, table.decimals)


def _pass_notes(program: CLProgram) -> list[str]:
    """Pass names that are no flank's, and flanks that no pass is named after while others are."""
    notes = []
    strange = {name: line for name, line in program.named if name not in SIDES}
    if strange:
        told = ", ".join(f"{name!r} (line {line}{_nearest(name)})" for name, line in strange.items())
        notes.append(f"passes named after no flank: {told}; flanks are {' and '.join(SIDES)}")
    if program.named:
        notes += [
            f"no pass is named {side}: every cutting pass counts as its own" for side in SIDES if not program.path(side)
        ]
    return notes


def _posting_notes(program: CLProgram, table: ProgramTable | None) -> tuple[str, ...]:
    """Where the machine's program says other conditions than the CL file."""
    if table is None:
        return ()
    notes = []
    if program.feed is not None and program.fastest is not None and program.fastest > program.feed:
        feeds = f"{program.feed:g} to {program.fastest:g} mm/min"
        notes.append(f"the feeds of cutting moves are {feeds}; program.nc keeps the slowest throughout")
    if program.spindle is not None and program.spindle != table.spindle_rpm:
        notes.append(
            f"SPINDL states {program.spindle:g}/min; program.nc runs at the scene's program.spindle_rpm, "
            f"{table.spindle_rpm:g}"
        )
    return tuple(notes)


def _nearest(name: str) -> str:
    near = get_close_matches(name, SIDES, n=1, cutoff=0.6)
    return f", did you mean {near[0]}?" if near else ""
