"""Running a generating job: every surface under every motion, by both roads."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from gearsim.errors import Status
from gearsim.generating.job import Cut, GeneratingJob
from gearsim.metrology.bevel import FlankMotion, measure_convergence
from gearsim.metrology.dexel_check import DexelResult, measure_dexels, slot_box
from gearsim.metrology.findings import Finding, surface_findings
from gearsim.metrology.machine import MachineFor, MeasuringMachine
from gearsim.metrology.roads import LIMIT_UM
from gearsim.metrology.surface import SurfaceResult, measure_surface, surface_rays
from gearsim.metrology.verdict import no_witness, not_compared, untouched
from gearsim.motion.segments import SegmentTable
from gearsim.motion.sources import MotionSource
from gearsim.result import CutResult, GeneratingResult, Verdict, versions
from gearsim.scene import scene_table


def measure(job: GeneratingJob, machine_for: MachineFor, device: str) -> GeneratingResult:
    """Measure everything the report holds; ``machine_for`` gives a measuring machine for a tool."""
    cuts, machines, segments = [], [], 0
    witnesses: list[DexelResult] = []
    for cut in job.cuts:
        machine = machine_for(cut.cutter)
        motions = {name: job.compiled(cut, source) for name, source in cut.sources.items()}
        surfaces = {p.name: _surface(job, cut, machine, motions, i) for i, p in enumerate(cut.patches)}
        cuts.append(CutResult(cut.cutter, cut.sources, surfaces))
        machines.append(machine)
        segments += sum(len(m.table) for m in motions.values())
        if job.blank is not None:
            witnesses.append(_dexels(job, cut, machine, motions, surfaces))
    m = job.scene.metrology
    findings = [f for c in cuts for s in c.surfaces.values() for f in surface_findings(s, m.judged, m.tolerance_um)]
    verdict, status = _verdict(cuts, m.judged, witnesses, findings)
    return GeneratingResult(
        scene=scene_table(job.scene),
        device=device,
        findings=tuple(findings),
        verdict=verdict,
        status=status,
        counts={
            "rays": sum(m.rays for m in machines),
            "segments": segments,
            "pairs": sum(m.pairs for m in machines),
            "candidates": sum(m.candidates for m in machines),
        },
        timings_s={"kernel": sum(m.kernel_s for m in machines)},
        versions=versions(),
        frame=job.frame,
        cuts=tuple(cuts),
        texts=dict(job.texts),
        programs=dict(job.programs),
        notes=job.notes,
        blank=job.blank,
        dexels=witnesses[-1] if witnesses else None,
    )


def _surface(
    job: GeneratingJob, cut: Cut, machine: MeasuringMachine, motions: dict[str, FlankMotion], index: int
) -> SurfaceResult:
    generating = motions[cut.generating]
    surface = measure_surface(machine, job.grid(cut.patches[index]), generating, motions)
    points, rays = job.scene.metrology.convergence, surface_rays(surface)
    if points and len(rays):
        for name, make in cut.sampled.items():

            def table(n: int, make: Callable[[int], MotionSource] = make) -> SegmentTable:
                return job.compiled(cut, make(n)).table

            surface.convergence[name] = measure_convergence(machine, rays, generating.table, table, points)
    return surface


def _dexels(
    job: GeneratingJob, cut: Cut, machine: MeasuringMachine, motions: dict[str, FlankMotion],
    surfaces: dict[str, SurfaceResult],
) -> DexelResult:  # fmt: skip
    assert job.blank is not None
    grids, table = [surface.grid for surface in surfaces.values()], motions[cut.generating].table
    box = slot_box(cut.patches, job.blank, job.scene.simulation.dexel_pitch_mm)
    return measure_dexels(lambda rays: machine.removed(rays, table), box, job.blank.stock, grids)


def _verdict(
    cuts: list[CutResult], judged: Sequence[str], witnesses: list[DexelResult], findings: list[Finding]
) -> tuple[Verdict, str]:
    """Pass or fail by the findings; unchecked where nothing was judged, or the three witnesses do not agree on it."""
    if not judged:
        return "unchecked", "metrology.judged names no motion: nothing was judged"
    if reasons := [r for cut in cuts for name, s in cut.surfaces.items() for r in _nothing_judged(name, s, judged)]:
        return "unchecked", "; ".join(reasons)
    for cut in cuts:
        for name, surface in cut.surfaces.items():
            own = surface.deviations[next(iter(cut.sources))]
            off = 1e3 * float(np.nanmax(np.abs(own.value[surface.measurable]), initial=0.0))
            lost = int(np.count_nonzero(surface.measurable & ~own.measured))
            if off > LIMIT_UM or lost:
                return "unchecked", (
                    f"the closed form of {name} differs from what its own motion removes by {off:.3g} um "
                    f"(limit {LIMIT_UM:g}); {lost} samples are not cut near it"
                )
            worst = max(gap.max_um for gap in surface.gaps.values())
            apart = sum(gap.disagree for gap in surface.gaps.values())
            if worst > LIMIT_UM or apart:
                return "unchecked", (
                    f"the two roads differ by {worst:.3g} um on {name} (limit {LIMIT_UM:g}); {apart} samples are cut "
                    "by only one of them"
                )
    for dexels in witnesses:
        if reasons := no_witness(dexels):
            return "unchecked", "; ".join(reasons)
        if dexels.check_um > LIMIT_UM:
            return "unchecked", f"the tri-dexel differs from the rays by {dexels.check_um:.3g} um (limit {LIMIT_UM:g})"
    return ("fail" if any(f.fails for f in findings) else "pass"), Status.OK.name or "OK"


def _nothing_judged(name: str, surface: SurfaceResult, judged: Sequence[str]) -> list[str]:
    """Judged motions that do not touch a surface, or under which nothing was compared."""
    if not surface.measurable.any():
        return [f"no sample of {name} lies on the machined surface: nothing of it was judged"]
    reasons = []
    for motion in judged:
        what = f"{name} under the motion {motion}"
        reasons += untouched(what, surface.deviations[motion]) or not_compared(what, [surface.gaps[motion]])
    return reasons
