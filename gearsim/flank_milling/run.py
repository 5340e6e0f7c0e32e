"""Running a flank-milling job: both flanks, the root and the slot's tri-dexel."""

from __future__ import annotations

import numpy as np

from gearsim.errors import Status
from gearsim.flank_milling.job import Job
from gearsim.geometry.rays import join_rays
from gearsim.metrology.bevel import (
    Convergence,
    FlankMotion,
    FlankPlan,
    FlankResult,
    PatchResult,
    measure_convergence,
    measure_flank,
    measure_root,
)
from gearsim.metrology.dexel_check import DexelResult, measure_dexels, slot_box
from gearsim.metrology.findings import Finding, flank_findings, rapid_findings, root_findings
from gearsim.metrology.machine import MachineFor, MeasuringMachine
from gearsim.metrology.rapid_check import blank_rays, rapid_touch
from gearsim.metrology.roads import LIMIT_UM, RoadGap
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.metrology.verdict import no_witness, not_compared, untouched
from gearsim.motion.segments import join
from gearsim.programs.cldata import RAPID
from gearsim.result import GEAR_FRAME, FlankMillingResult, Verdict, versions
from gearsim.scene import scene_table
from gearsim.simulation.dexels import DexelBox
from gearsim.surfaces.patch import SIDES, Side


def measure(job: Job, machine_for: MachineFor, device: str) -> FlankMillingResult:
    """Measure everything the report holds; ``machine_for`` gives a measuring machine for a tool."""
    machine = machine_for(job.cutter)
    metrology = job.scene.metrology
    flanks = {side: _measure_side(job, machine, side) for side in SIDES}
    rows = max(3, metrology.rows // 2)
    root = measure_root(machine, job.tooth, job.program, rows, metrology.columns, metrology.margin, metrology.window)
    blank = job.tooth.blank
    box = slot_box(job.tooth.patches, blank, job.scene.simulation.dexel_pitch_mm)
    grids = [flank.grid for flank in flanks.values()]
    dexels = measure_dexels(lambda rays: machine.removed(rays, job.program), box, blank.stock, grids)
    findings: list[Finding] = []
    for flank in flanks.values():
        findings += flank_findings(flank, metrology.tolerance_um)
    findings += _rapids(job, machine, box)
    findings += root_findings(list(root.values()), metrology.root_tolerance_um)
    verdict, status = _verdict(flanks, root, dexels, findings)
    return FlankMillingResult(
        scene=scene_table(job.scene),
        device=device,
        tooth=job.tooth,
        cutter=job.cutter,
        cl_text=job.cl_text,
        nc_text=job.nc_text,
        notes=job.notes,
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


def _rapids(job: Job, machine: MeasuringMachine, box: DexelBox) -> list[Finding]:
    """The first rapid move that touches material, seen by rays through the whole blank and closer ones at the slot."""
    blank, program = job.tooth.blank, job.program
    rapid = np.array([name == RAPID for name in job.path_names])
    rays = join_rays([blank_rays(blank.stock), *(box.rays(axis) for axis in range(3))])
    touch = rapid_touch(
        blank.stock, rays, rapid, lambda some, chosen: machine.removed(some, program.part(chosen[program.path]))
    )  # fmt: skip
    number = 0 if touch is None else int(rapid[: touch.step + 1].sum())
    return rapid_findings(touch, blank, f"rapid move {number} of the CL data")


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


def _verdict(
    flanks: dict[Side, FlankResult], root: dict[str, PatchResult], dexels: DexelResult, findings: list[Finding]
) -> tuple[Verdict, str]:
    """Pass or fail by the findings; unchecked where nothing was judged or roads and dexels do not confirm it."""
    if reasons := _nothing_judged(flanks, root, dexels):
        return "unchecked", "; ".join(reasons)
    gaps = [g for flank in flanks.values() for g in _gaps(flank)]
    if not all(g.trusted for g in gaps):
        worst = max(g.max_um for g in gaps)
        apart = sum(g.disagree for g in gaps)
        return "unchecked", (
            f"the two roads differ by {worst:.3g} um (limit {LIMIT_UM:g}); {apart} samples are cut by only one of them"
        )
    if dexels.check_um > LIMIT_UM:
        return "unchecked", f"the tri-dexel differs from the rays by {dexels.check_um:.3g} um (limit {LIMIT_UM:g})"
    return ("fail" if any(f.fails for f in findings) else "pass"), Status.OK.name or "OK"


def _gaps(flank: FlankResult) -> list[RoadGap]:
    return [g for g in (flank.gap, flank.gap_cl, *flank.inspection_gaps) if g is not None]


def _nothing_judged(flanks: dict[Side, FlankResult], root: dict[str, PatchResult], dexels: DexelResult) -> list[str]:
    """Judged surfaces that no pass touches, and flanks at which nothing was compared."""
    judged = {f"the {side} flank": flank.all_passes for side, flank in flanks.items()}
    judged |= {f"the {name}": patch.deviation for name, patch in root.items()}
    reasons = [r for name, deviation in judged.items() for r in untouched(name, deviation)]
    for side, flank in flanks.items():
        reasons += not_compared(f"the {side} flank", (g for g in (flank.gap, flank.gap_cl) if g is not None))
    return reasons + no_witness(dexels)
