"""One verb: run a scene and return its Result. Writing files is the output room's work."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Protocol

import numpy as np

from gearsim import generating
from gearsim.cutters.profile import Profile
from gearsim.envelope import prepare_envelope
from gearsim.errors import Status
from gearsim.generating import GeneratingJob
from gearsim.job import Job, plan
from gearsim.metrology.bevel import (
    Convergence,
    FlankMotion,
    FlankPlan,
    FlankResult,
    measure_convergence,
    measure_flank,
    measure_root,
)
from gearsim.metrology.dexel_check import DexelResult, measure_dexels
from gearsim.metrology.findings import Finding, flank_findings, rapid_findings, root_findings
from gearsim.metrology.machine import MeasuringMachine
from gearsim.metrology.roads import LIMIT_UM
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.motion.segments import join
from gearsim.programs.cldata import RAPID
from gearsim.result import GEAR_FRAME, FlankMillingResult, Result, Verdict, versions
from gearsim.scene import FlankMillingScene, GeneratedScene, Scene, load_scene, scene_table
from gearsim.simulation.removal import prepare
from gearsim.surfaces.ruled_bevel import SIDES, Side


class Progress(Protocol):
    """Told of a run's progress; the silent default does nothing."""

    def stage(self, name: str, total: int) -> None: ...

    def advance(self, amount: int) -> None: ...


class _Silent:
    def stage(self, name: str, total: int) -> None:
        pass

    def advance(self, amount: int) -> None:
        pass


def run(
    scene: Scene | str | Path, *, device: str = "cpu", overrides: tuple[str, ...] = (), folder: Path | None = None,
    progress: Progress | None = None,
) -> Result:  # fmt: skip
    """Simulate a scene and measure the machined tooth.

    ``scene`` is a Scene, a built-in name or a path; ``overrides`` are ``table.key=value`` strings for the
    latter two; ``folder`` is where relative file names in the scene are looked up (default: the scene file's
    own folder); ``device`` is ``cpu`` or ``cuda:0``, .... Raises InputError for anything wrong in the input and
    NumericalError where a kernel status forbids trust.
    """
    started = perf_counter()
    progress = progress or _Silent()
    progress.stage("planning", 0)
    if not isinstance(scene, Scene):
        scene, found_in = load_scene(scene, overrides)
        folder = folder or found_in
    job: Job | GeneratingJob
    if isinstance(scene, FlankMillingScene):
        job = plan(scene, folder or Path())
    else:
        assert isinstance(scene, GeneratedScene)
        job = generating.plan(scene)
    planned = perf_counter()
    progress.stage("compiling kernels", 0)
    compile_s = prepare(device) + prepare_envelope()
    settings = job.scene.simulation

    def machine_for(cutter: Profile) -> MeasuringMachine:
        return MeasuringMachine(cutter, device, settings.tolerance_mm, settings.interval_slots, progress.advance)

    result: Result
    if isinstance(job, GeneratingJob):
        progress.stage("cutting and measuring", job.ray_count() + job.samples())
        result = generating.measure(job, machine_for, device)
    else:
        progress.stage("cutting and measuring", job.ray_count() + job.envelope_samples())
        result = _measure(job, machine_for(job.cutter), device)
    timings = {"compile": compile_s, "plan": planned - started, **result.timings_s}
    return replace(result, timings_s={**timings, "total": perf_counter() - started})


def _measure(job: Job, machine: MeasuringMachine, device: str) -> FlankMillingResult:
    """Measure everything the report holds."""
    metrology = job.scene.metrology
    flanks = {side: _measure_side(job, machine, side) for side in SIDES}
    rows = max(3, metrology.rows // 2)
    root = measure_root(machine, job.tooth, job.program, rows, metrology.columns, metrology.margin, metrology.window)
    pitch = job.scene.simulation.dexel_pitch_mm
    grids = [flank.grid for flank in flanks.values()]
    dexels = measure_dexels(machine, job.tooth.patches, job.tooth.blank, job.program, pitch, grids)
    rapid = np.array([name == RAPID for name in job.path_names])[job.program.path]
    findings: list[Finding] = []
    for flank in flanks.values():
        findings += flank_findings(flank, metrology.tolerance_um)
    findings += rapid_findings(dexels, grids[0], rapid)
    findings += root_findings(list(root.values()), metrology.root_tolerance_um)
    verdict, status = _verdict(list(flanks.values()), dexels, findings)
    return FlankMillingResult(
        scene=scene_table(job.scene),
        device=device,
        tooth=job.tooth,
        cutter=job.cutter,
        cl_text=job.cl_text,
        flanks=flanks,
        patches=root,
        dexels=dexels,
        theory={side: motion.sources[0] for side, motion in job.theory.items()},
        own_sources={side: [job.paths[i] for i in job.own_paths(side)] for side in SIDES},
        findings=tuple(findings),
        verdict=verdict,
        status=status,
        counts={
            "rays": machine.rays,
            "segments": len(job.program),
            "pairs": machine.pairs,
            "candidates": machine.candidates,
        },
        timings_s={"kernel": machine.kernel_s},
        versions=versions(),
        frame=GEAR_FRAME,
    )


def _measure_side(job: Job, machine: MeasuringMachine, side: Side) -> FlankResult:
    metrology, patch = job.scene.metrology, job.tooth.flank(side)
    grid = sample_grid(patch, metrology.rows, metrology.columns, metrology.margin, metrology.window)
    inspection = sample_grid(
        patch, metrology.inspection_rows, metrology.inspection_columns, metrology.inspection_margin,
        metrology.window,
    )  # fmt: skip
    own = job.own_paths(side)
    others = [t for i, t in enumerate(job.path_tables) if i not in own]
    blank = job.tooth.blank
    plan = FlankPlan(
        patch=patch,
        grid=grid,
        inspection=inspection,
        contact_height=float(blank.mid_working_depth_at(blank.mean)),
        profile_offsets=np.array(metrology.profile_offsets_mm),
        theory=job.theory.get(side),
        cl=FlankMotion([job.paths[i] for i in own], join([job.path_tables[i] for i in own])),
        program=job.program,
        others=join(others) if others else None,
    )
    return measure_flank(machine, plan, _convergence(job, machine, side, grid))


def _convergence(job: Job, machine: MeasuringMachine, side: Side, grid: SampleGrid) -> Convergence | None:
    points = job.scene.metrology.convergence
    if side not in job.planners or not points:
        return None
    planner = job.planners[side]
    return measure_convergence(
        machine, grid.rays(), job.theory[side].table, lambda n: job.compiled(planner.cl_motion(n)), points
    )


def _verdict(flanks: list[FlankResult], dexels: DexelResult, findings: list[Finding]) -> tuple[Verdict, str]:
    """Pass or fail by the findings; unchecked where roads and dexels do not confirm each other."""
    gaps = [g for flank in flanks for g in (flank.gap, flank.gap_cl, *flank.inspection_gaps) if g is not None]
    if not all(g.trusted for g in gaps):
        worst = max(g.max_um for g in gaps)
        apart = sum(g.disagree for g in gaps)
        return "unchecked", (
            f"the two roads differ by {worst:.3g} um (limit {LIMIT_UM:g}); {apart} samples are cut by only one of them"
        )
    if dexels.check_um > LIMIT_UM:
        return "unchecked", f"the tri-dexel differs from the rays by {dexels.check_um:.3g} um (limit {LIMIT_UM:g})"
    return ("fail" if any(f.fails for f in findings) else "pass"), Status.OK.name or "OK"
