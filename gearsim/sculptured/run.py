"""Running a job of local gouging: prediction, cut, attribution, tool sizes, worked examples."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearsim.errors import Status
from gearsim.gouging.attribution import Cause
from gearsim.gouging.fitting import contacts_of, largest_for_all, size_map
from gearsim.gouging.lines import face_lines, longest_line
from gearsim.gouging.looked import look
from gearsim.gouging.prediction import predict
from gearsim.gouging.worked_sections import worked_rows
from gearsim.metrology.deviation import Crossing
from gearsim.metrology.findings import Finding
from gearsim.metrology.machine import MachineFor
from gearsim.metrology.roads import LIMIT_UM
from gearsim.metrology.samples import SampleGrid
from gearsim.metrology.verdict import untouched
from gearsim.result import GougeExampleResult, PlotPoint, SculpturedResult, SizeChoice, ToolCut, Verdict, versions
from gearsim.scene import SculpturedScene, scene_table
from gearsim.scene.sculptured import WorkedTable
from gearsim.sculptured.check import where_met
from gearsim.sculptured.cutting import cut_with
from gearsim.sculptured.job import SculpturedJob
from gearsim.surfaces.face import Face

_FRAME = "part frame of the control net: the tool axis is +z"


def measure(job: SculpturedJob, machine_for: MachineFor, device: str) -> SculpturedResult | GougeExampleResult:
    """Everything the report holds; ``machine_for`` gives a measuring machine for a tool."""
    if not isinstance(job.scene, SculpturedScene):
        return _examples(job, device)
    assert job.surface is not None
    grid = job.grid()
    cuts = {name: cut_with(job, tool, grid, machine_for) for name, tool in job.tools.items()}
    findings = [f for name, cut in cuts.items() for f in _findings(job.scene, grid, name, cut)]
    verdict, status = _verdict(cuts, findings)
    done = [cut.machine for cut in cuts.values()]
    return SculpturedResult(
        **_common(job, device, findings, verdict, status),
        counts={
            **{key: int(sum(d[key] for d in done)) for key in ("rays", "pairs", "candidates")},
            "segments": job.segment_count(),
        },
        timings_s={"kernel": sum(d["kernel"] for d in done)},
        surface=job.surface,
        grid=grid,
        cuts=cuts,
        sizes=_sizes(job.scene, job, device),
        plotted=_plotted(job.scene, job),
        worked=_worked(job.scene.reference),
    )


def _examples(job: SculpturedJob, device: str) -> GougeExampleResult:
    rows = _worked(job.scene.reference)
    verdict, status = _examples_verdict(rows)
    return GougeExampleResult(
        **_common(job, device, [], verdict, status),
        counts={"rays": 0, "pairs": 0, "candidates": 0, "segments": 0},
        timings_s={"kernel": 0.0},
        sections=job.scene.reference.sections if job.scene.reference else (),
        worked=rows,
    )


def _common(job: SculpturedJob, device: str, findings: list[Finding], verdict: Verdict, status: str) -> dict[str, Any]:
    return {
        "scene": scene_table(job.scene), "device": device, "findings": tuple(findings), "verdict": verdict,
        "status": status, "versions": versions(), "frame": _FRAME,
    }  # fmt: skip


def _worked(table: WorkedTable | None) -> tuple[Any, ...]:
    return tuple(worked_rows(table.sections, table.names)) if table else ()


def _sizes(scene: SculpturedScene, job: SculpturedJob, device: str) -> SizeChoice:
    """As `gearsim gouge` has it: the largest mill at every point, and Khan's mill for all beside the true optimum."""
    assert job.surface is not None
    mills, margin, axis = scene.catalogue.build(), scene.catalogue.margin, np.array([0.0, 0.0, 1.0])
    face, grid = Face(job.surface.name, job.surface), max(scene.metrology.rows, scene.metrology.columns)
    lines = face_lines(face, longest_line(face) / max(grid - 1, 1), grid, margin)
    seen = look(face, lines, job.tools["chosen"].cutter, axis, device)
    contacts = contacts_of([seen], where_met([face], [lines], margin), axis)
    both, choice, shape = largest_for_all(contacts, mills), size_map(seen, mills), seen.grid.shape
    place = tuple(float(x) for x in contacts.place(both.best.limiting)) if both else (np.nan,) * 3
    return SizeChoice(seen.grid, choice.shank.reshape(shape), choice.corner.reshape(shape), mills, both, place)


def _plotted(scene: SculpturedScene, job: SculpturedJob) -> PlotPoint:
    """The contact whose curvatures are drawn, with all tools."""
    assert job.surface is not None
    u, v = job.surface.locate([scene.plot.u], [scene.plot.v])
    tools = {name: predict(job.surface, tool.cutter, u, v) for name, tool in job.tools.items()}
    return PlotPoint(float(u[0]), float(v[0]), job.surface.jet(u, v).r[0], tools)


def _findings(scene: SculpturedScene, grid: SampleGrid, name: str, cut: ToolCut) -> list[Finding]:
    """The deepest overcut of each cause; the chosen tool's fail."""
    found = []
    words = {
        Cause.LOCAL: "gouges locally, where its curvature is predicted to be less than the part's",
        Cause.TIE: "overcuts where the curvatures tie",
        Cause.GLOBAL: "hits another part of the surface: the contact itself is clear (global gouging)",
        Cause.UNPREDICTED: "overcuts where nothing is predicted to gouge",
        Cause.UNKNOWN: "cuts through the measuring window: raise metrology.window_mm",
    }
    for cause, text in words.items():
        mine = cut.made.cause == cause
        if not mine.any():
            continue
        depth = np.where(cut.deviation.crossing == Crossing.THROUGH, -grid.inward, cut.deviation.value)
        worst = np.unravel_index(int(np.argmin(np.where(mine, depth, np.inf))), grid.shape)
        x, y, z = (float(c) for c in grid.point[worst])
        kind = f"{cause.name.lower()}_gouging" if cause <= Cause.GLOBAL else "overcut"
        found.append(
            Finding(kind, name, 1e3 * float(depth[worst]), (x, y, z), None, None, name == "chosen",
                    f"the {name} tool {text} ({int(mine.sum())} samples)")
        )  # fmt: skip
    return found


def _verdict(cuts: dict[str, ToolCut], findings: list[Finding]) -> tuple[Verdict, str]:
    """Fail where the chosen tool overcuts; unchecked where it cuts nothing, or prediction, cut and search disagree."""
    if reasons := _nothing_judged(cuts["chosen"]):
        return "unchecked", "; ".join(reasons)
    for name, cut in cuts.items():
        if cut.check_um > LIMIT_UM:
            return "unchecked", f"{name}: machined points lie {cut.check_um:.3g} um off the tool (limit {LIMIT_UM:g})"
        unknown, unpredicted = cut.made.count(Cause.UNKNOWN), cut.made.count(Cause.UNPREDICTED)
        if unknown:
            return "unchecked", f"{name}: {unknown} samples are cut through the window; raise metrology.window_mm"
        if unpredicted or cut.rings.disagree.any():
            return "unchecked", (
                f"{name}: prediction and cut disagree at {int(cut.rings.disagree.sum())} contacts cut alone; "
                f"{unpredicted} samples are overcut where nothing is predicted to gouge"
            )
    return ("fail" if any(f.fails for f in findings) else "pass"), Status.OK.name or "OK"


def _nothing_judged(chosen: ToolCut) -> list[str]:
    """Why the cut of the judged tool says nothing: it meets no sample, or no contact was compared with its cut."""
    reasons = untouched("the surface with the chosen tool", chosen.deviation)
    if not len(chosen.rings.contact):
        reasons.append("no contact of the chosen tool was cut alone: prediction and cut were compared nowhere")
    return reasons


def _examples_verdict(rows: tuple[Any, ...]) -> tuple[Verdict, str]:
    if not rows:
        return "unchecked", "reference.sections and reference.names choose no worked example: nothing was compared"
    return "pass", Status.OK.name or "OK"
