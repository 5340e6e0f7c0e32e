"""Running a generation-milling job: the whole gear cut from its program, inspected, and held against two witnesses."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.errors import Status
from gearsim.generation_milling.budget import budget
from gearsim.generation_milling.cutting import ProgramCut, run_program
from gearsim.generation_milling.findings import gear_findings
from gearsim.generation_milling.flank_map import LAST, WHOLE, measure_map
from gearsim.generation_milling.inspect import inspect, roughness
from gearsim.generation_milling.job import GearJob, disturbance
from gearsim.generation_milling.stock import gear_stock, section_rays, space_box
from gearsim.metrology.dexel_check import DexelResult, measure_dexels
from gearsim.metrology.findings import Finding
from gearsim.metrology.gear_inspection import GearInspection
from gearsim.metrology.machine import MachineFor, MeasuringMachine
from gearsim.metrology.roads import LIMIT_UM
from gearsim.metrology.surface import SurfaceResult
from gearsim.metrology.verdict import no_witness, not_compared, untouched
from gearsim.result import GearResult, Verdict, versions
from gearsim.scene import scene_table
from gearsim.simulation.section import Section, section
from gearsim.surfaces.cylindrical_gear import SIDES, Side
from gearsim.toolpaths.cylindrical.feed import fastest_axis

GEAR_FRAME = "gear frame: z along the gear axis, z = 0 at the top face, space 0 on +x there"


@dataclass
class _Machines:
    """Measuring machines as they are asked for, kept for their totals."""

    machine_for: MachineFor
    made: list[MeasuringMachine] = field(default_factory=list)

    def __call__(self, cutter: Profile) -> MeasuringMachine:
        self.made.append(self.machine_for(cutter))
        return self.made[-1]


def measure(job: GearJob, machine_for: MachineFor, device: str) -> GearResult:
    """Cut and inspect everything the report holds; ``machine_for`` gives a measuring machine for a tool."""
    scene, machines = job.scene, _Machines(machine_for)
    real = disturbance(scene.errors)
    cut = run_program(job.program.blocks, job.tools, real, machines, scene.simulation.compile_tolerance_mm)
    inspection = inspect(job, cut, scene.name)
    maps = {side: measure_map(job, cut, side) for side in SIDES}
    stock = gear_stock(job.gear, scene.surface.rim_mm)
    box = space_box(job.gear, scene.simulation.dexel_pitch_mm)
    dexels = measure_dexels(cut.removed, box, stock, [m.grid for m in maps.values()])
    findings = gear_findings(job, cut, inspection, maps, dexels)
    verdict, status = _verdict(_nothing_judged(job, inspection, maps, dexels), list(maps.values()), dexels, findings)
    return GearResult(
        scene=scene_table(scene),
        device=device,
        findings=tuple(findings),
        verdict=verdict,
        status=status,
        counts={
            "segments": sum(len(m.table) for m in cut.motions),
            "blocks": len(job.program.blocks),
            **{name: sum(getattr(m, name) for m in machines.made) for name in ("rays", "pairs", "candidates")},
        },
        timings_s={"kernel": sum(m.kernel_s for m in machines.made)},
        versions=versions(),
        frame=GEAR_FRAME,
        gear=job.gear,
        cutter=real.cutter(job.finishing.cutting.tool),
        operations=job.operations,
        program=job.text,
        notes=job.program.notes,
        reached={str(side): job.reached[side] for side in SIDES},
        inspection=inspection,
        maps={str(side): surface for side, surface in maps.items()},
        roughness=roughness(job, cut),
        budget=budget(job, scene.budget, machines) if scene.budget else (),
        section=_section(job, cut),
        dexels=dexels,
        cutting_s=_cutting_seconds(job),
        speeds=_fastest(job),
    )


def _section(job: GearJob, cut: ProgramCut) -> Section:
    rim = job.scene.surface.rim_mm
    rays = section_rays(job.gear, rim, job.scene.metrology.section_pitch_mm)
    return section(rays, gear_stock(job.gear, rim), cut.removed(rays))


def _cutting_seconds(job: GearJob) -> dict[str, float]:
    """Time in feed [s] of each operation, as the program says it."""
    blocks = job.program.blocks
    return {
        name: float(np.nansum(blocks.seconds[(blocks.operation == i) & ~blocks.rapid]))
        for i, name in enumerate(job.program.operations)
    }


def _fastest(job: GearJob) -> dict[str, tuple[float, float]]:
    """By operation: largest speed [mm/min] of the tool's axis on the gear in straight feed blocks, and the feed."""
    blocks = job.program.blocks
    way = fastest_axis(blocks.machine, blocks.before, blocks.values - blocks.before)
    fed = ~blocks.rapid & ~blocks.tip_control & (blocks.sweep == 0.0) & (blocks.seconds > 0.0)
    speed = np.where(fed, 60.0 * way / np.where(fed, blocks.seconds, 1.0), 0.0)
    names = job.program.operations
    feeds = [step.cutting.feed for step in job.steps] if job.operations else [float("nan")] * len(names)
    largest = (float(np.max(speed[blocks.operation == i], initial=0.0)) for i in range(len(names)))
    return dict(zip(names, zip(largest, feeds, strict=True), strict=True))


def _verdict(
    nothing: list[str], maps: list[SurfaceResult], dexels: DexelResult, findings: list[Finding]
) -> tuple[Verdict, str]:
    """Pass or fail by the findings; unchecked where ``nothing`` was judged or the witnesses do not agree on it."""
    if nothing:
        return "unchecked", "; ".join(nothing)
    for surface in maps:
        for gap in surface.gaps.values():
            if not gap.trusted:
                return "unchecked", (
                    f"the two roads differ by {gap.max_um:.3g} um on the {surface.grid.patch.name} flank (limit "
                    f"{LIMIT_UM:g}); {gap.disagree} samples are cut by only one of them"
                )
    if dexels.check_um > LIMIT_UM:
        return "unchecked", f"the tri-dexel differs from the rays by {dexels.check_um:.3g} um (limit {LIMIT_UM:g})"
    return ("fail" if any(f.fails for f in findings) else "pass"), Status.OK.name or "OK"


def _nothing_judged(
    job: GearJob, inspection: GearInspection, maps: dict[Side, SurfaceResult], dexels: DexelResult
) -> list[str]:
    """Flanks that no operation touches, and flanks of space 1 of which the last operation cuts no sample."""
    reasons = []
    for side, surface in maps.items():
        spaces = inspection.untouched[side]
        if spaces:
            numbers = ", ".join(str(space + 1) for space in spaces)
            where = f"space{'s' * (len(spaces) > 1)} {numbers}"
            reasons.append(f"no operation touches the {side} flank of {where}: nothing of it was judged")
        if 0 not in spaces:
            reasons += _not_confirmed(job, surface, f"the {side} flank of space 1")
    return reasons + no_witness(dexels)


def _not_confirmed(job: GearJob, surface: SurfaceResult, flank: str) -> list[str]:
    if LAST in surface.gaps:
        return untouched(flank, surface.deviations[WHOLE]) + not_compared(flank, [surface.gaps[LAST]])
    last = job.program.operations[job.program.blocks.operation.max()]
    return [f"the last operation ({last}) cuts no sample of {flank}: the two roads compared nothing"]
