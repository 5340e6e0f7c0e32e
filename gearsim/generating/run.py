"""Running a generating job: every surface under every motion, by both roads."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearsim.errors import Status
from gearsim.generating.job import GeneratingJob
from gearsim.metrology.bevel import Convergence, FlankMotion, measure_convergence
from gearsim.metrology.findings import Finding, surface_findings
from gearsim.metrology.machine import MeasuringMachine
from gearsim.metrology.roads import LIMIT_UM
from gearsim.metrology.surface import SurfaceResult, measure_surface, surface_rays
from gearsim.motion.segments import SegmentTable
from gearsim.motion.sources import MotionSource
from gearsim.result import GeneratingResult, Verdict, versions
from gearsim.scene import scene_table


def measure(job: GeneratingJob, machine: MeasuringMachine, device: str) -> GeneratingResult:
    """Measure everything the report holds."""
    motions = {name: job.compiled(source) for name, source in job.sources.items()}
    generating = motions[job.generating]
    surfaces = {}
    for patch in job.patches:
        surface = measure_surface(machine, job.grid(patch), generating, motions)
        surface.convergence.update(_convergence(job, machine, generating, surface))
        surfaces[patch.name] = surface
    findings: list[Finding] = []
    for surface in surfaces.values():
        findings += surface_findings(surface, job.scene.metrology.judged, job.scene.metrology.tolerance_um)
    verdict, status = _verdict(job, surfaces, findings)
    return GeneratingResult(
        scene=scene_table(job.scene),
        device=device,
        cutter=job.cutter,
        findings=tuple(findings),
        verdict=verdict,
        status=status,
        counts={
            "rays": machine.rays,
            "segments": sum(len(m.table) for m in motions.values()),
            "pairs": machine.pairs,
            "candidates": machine.candidates,
        },
        timings_s={},
        versions=versions(),
        frame=job.frame,
        surfaces=surfaces,
        sources=dict(job.sources),
        texts=dict(job.texts),
        programs=dict(job.programs),
        dexels=None,
    )


def _convergence(
    job: GeneratingJob, machine: MeasuringMachine, generating: FlankMotion, surface: SurfaceResult
) -> dict[str, Convergence]:
    """How motions of N points approach the generating one on a surface."""
    points, rays = job.scene.metrology.convergence, surface_rays(surface)
    if not points or not len(rays):
        return {}
    out = {}
    for name, make in job.sampled.items():

        def table(n: int, make: Callable[[int], MotionSource] = make) -> SegmentTable:
            return job.compiled(make(n)).table

        out[name] = measure_convergence(machine, rays, generating.table, table, points)
    return out


def _verdict(job: GeneratingJob, surfaces: dict[str, SurfaceResult], findings: list[Finding]) -> tuple[Verdict, str]:
    """Pass or fail by the findings; unchecked where closed form, envelope and removal do not confirm each other."""
    for name, surface in surfaces.items():
        own = surface.deviations[job.generating]
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
                f"the two roads differ by {worst:.3g} um on {name} (limit {LIMIT_UM:g}); {apart} samples are cut by "
                "only one of them"
            )
    return ("fail" if any(f.fails for f in findings) else "pass"), Status.OK.name or "OK"
