"""Surfaces measured on grids: figures, tables of what each variant costs, maps, samples, deviation.png, meshes."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import date
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from gearsim.metrology.grid import COARSE, DENSE, GridInspection, GridMeasurement
from gearsim.metrology.job import Job
from gearsim.metrology.root import RootInspection
from gearsim.metrology.topography import Topography
from gearsim.output.charts import draw_grids
from gearsim.output.columns import Column
from gearsim.output.draw_tooth import tooth_arrays
from gearsim.output.driving_sides import driving_sides
from gearsim.output.files import MESHES, SAMPLES
from gearsim.output.flank_sheet import Sheet, draw_sheet
from gearsim.output.grid_columns import channels, sample_columns
from gearsim.output.heat import is_perfect
from gearsim.output.layers import patch_arrays, view_arrays
from gearsim.output.markdown import table, um
from gearsim.output.saving import Chart
from gearsim.output.summary import gap_figures, number, numbers, worst_at
from gearsim.result import Result

_FROM_TIP_TO_TIP = ("concave", "concave fillet", "bottom", "convex fillet", "convex")
_ROTATIONS = ("mid_rotation_um", "best_rotation_um")


def files(job: Job, asked: Sequence[Any]) -> list[str]:
    """Maps, samples and meshes; the inspection sheet and the whole tooth where all that they show is measured."""
    grids = [i for i in asked if isinstance(i, GridInspection)]
    sheets = [i for i in grids if i.name == COARSE and i.rotated and job.main in i.variants]
    measured = {i.surface for i in grids if i.name == DENSE and job.main in i.variants}
    for i in asked:
        measured |= set(i.surfaces) if isinstance(i, RootInspection) and i.variant == job.main else set()
    whole = measured.issuperset(_FROM_TIP_TO_TIP) and job.part.patch(_FROM_TIP_TO_TIP[0]).blank is not None
    named = {
        "inspection.png": bool(_limits(job, [i.surface for i in sheets])),
        "deviation.png": True,
        "deviation.exr": True,
        SAMPLES: True,
        MESHES: True,
        "tooth.png": whole,
    }
    return [name for name, given in named.items() if given]


def _limits(job: Job, surfaces: Sequence[str]) -> list[float]:
    """What is tolerated of those surfaces that have a tolerance [um]."""
    tolerances = [job.part.surfaces[surface].tolerance for surface in surfaces]
    return [t.excess_um for t in tolerances if t is not None and np.isfinite(t.excess_um)]


def figures(m: GridMeasurement) -> dict[str, Any]:
    """Deviations, where the worst lies, how far the roads are apart; an inspector's grid point by point."""
    points = m.grid.point[m.measurable]
    out: dict[str, Any] = {
        "samples": int(m.measurable.size),
        "missing": int(m.missing.sum()),
        "trimmed": int(m.trimmed.sum()),
        "deviation_um": m.deviation.summary_um(),
        "worst_at": worst_at(m.grid, m.deviation),
        "envelope_gap_um": gap_figures(points, m.gap),
    }
    return out if m.topography is None else {**out, "topography": _topography(m.topography)}


def _topography(t: Topography) -> dict[str, Any]:
    return {
        "as_cut_um": numbers(t.as_cut_um),
        "mid_zeroed_um": numbers(t.mid_zeroed_um),
        "best_rotated_um": numbers(t.best_rotated_um),
        "mid_rotation_um": number(t.mid_rotation_um),
        "mid_rotation_deg": number(t.rotation_deg(t.mid_rotation_um)),
        "best_rotation_um": number(t.best_rotation_um),
        "best_rotation_deg": number(t.rotation_deg(t.best_rotation_um)),
        "radius_mm": t.mid_radius_mm,
    }


def sections(result: Result, found: Sequence[GridMeasurement]) -> dict[str, str]:
    """What each variant costs; whether it can be trusted; the inspector's grid."""
    dense = [m for m in found if m.inspection == DENSE]
    return {"costs": _costs(dense), "trust": _roads(dense), "details": _inspection(result, found)}


def _costs(dense: Sequence[GridMeasurement]) -> str:
    lines = "".join(f"- **{name}**: {text}\n" for name, text in {m.variant: m.by.text for m in dense}.items())
    rows = []
    for m in dense:
        d = m.deviation.summary_um()
        values = [um(d[k]) for k in ("min", "max", "mean", "rms")]
        rows.append([f"{m.surface}: {m.variant}", *values, d["uncut"], d["through"]])
    head = ["Deviation from the intended surface [µm]", "min", "max", "mean", "RMS", "uncut", "cut through"]
    return f"## What each motion cuts\n\n{lines}\n" + table(head, rows)


def _roads(dense: Sequence[GridMeasurement]) -> str:
    rows = []
    for m in dense:
        if m.gap is not None:
            share = ", ".join(f"{k} {100 * v:.1f} %" for k, v in m.gap.road.share().items() if v)
            gap = f"{1e3 * m.gap.max_um:.2g}"
            rows.append([f"{m.surface}: {m.variant}", gap, m.gap.valid, m.gap.excluded, m.gap.disagree, share])
    alone = list(dict.fromkeys(m.surface for m in dense if m.gap is None))
    alone = [name for name in alone if all(m.gap is None for m in dense if m.surface == name)]
    one = f"By the kernel alone: {', '.join(alone)}.\n" if alone else ""
    if not rows:
        return one
    counted = "".join(
        f"- {m.surface}: {m.missing.size:,} samples, {int(m.missing.sum()):,} without a point of the closed form, "
        f"{int(m.trimmed.sum()):,} trimmed by the generating motion itself\n"
        for m in {m.surface: m for m in dense if not m.measurable.all()}.values()
    )
    return (
        "The machined surface is found by two roads: the closed-form envelope of the exact motion, trimmed; and a "
        "kernel that sweeps the cutter through rays and knows no envelope condition. They must agree to 1 nm.\n\n"
        + table(["Largest gap of the two roads", "nm", "samples", "excluded", "disagree", "classes"], rows)
        + (f"\n{one}" if one else "") + (f"\n{counted}" if counted else "")
    )  # fmt: skip


def _inspection(result: Result, found: Sequence[GridMeasurement]) -> str:
    mine = [m for m in found if m.inspection == COARSE and m.variant == result.job.main and m.topography]
    if not mine:
        return ""
    out = [f"## Inspector's grid under {result.job.main} [µm]\n\nRows root to tip, columns toe to heel.\n"]
    for m in mine:
        assert m.topography is not None
        t = _topography(m.topography)
        mid, best = (f"turned by {um(t[k])} µm at r = {t['radius_mm']:.2f} mm" for k in _ROTATIONS)
        kinds = {
            "as cut": "as_cut_um",
            f"mid-point zeroed ({mid})": "mid_zeroed_um",
            f"best rotated ({best})": "best_rotated_um",
        }
        for text, key in kinds.items():
            rows = [[f"row {i + 1}", *map(um, row)] for i, row in enumerate(t[key])]
            out.append(table([f"{m.surface}, {text}", *(str(i + 1) for i in range(len(t[key][0])))], rows))
    return "\n".join(out)


def screen(result: Result, found: Sequence[GridMeasurement], console: Console) -> None:
    """Deviations by surface and variant, and how well the roads agree."""
    dense = [m for m in found if m.inspection == DENSE]
    shown = Table(title=f"{result.name}: deviation in um, + material left, - overcut")
    for head in ("surface and motion", "min", "max", "mean", "rms"):
        shown.add_column(head, justify="left" if head.startswith("surface") else "right")
    for m in dense:
        d = m.deviation.summary_um()
        shown.add_row(f"{m.surface}: {m.variant}", *(_short(d[k]) for k in ("min", "max", "mean", "rms")))
    console.print(shown)
    gaps = [m.gap for m in dense if m.gap is not None]
    if gaps:
        largest = 1e3 * max(g.max_um for g in gaps)
        console.print(
            f"Two roads agree to {largest:.2g} nm over {sum(g.valid for g in gaps):,} samples "
            f"({sum(g.excluded for g in gaps)} excluded)."
        )


def _short(x: float | int | None) -> str:
    if x is None:
        return "-"
    return f"{x:.1f}" if abs(x) >= 100.0 else f"{x:.4f}" if abs(x) >= 5e-5 else "0"


def charts(result: Result, found: Sequence[GridMeasurement]) -> list[Chart]:
    """inspection.png, and deviation.png: a map of every surface under every variant where anything is to be seen."""
    dense = [m for m in found if m.inspection == DENSE]
    sheet = _sheet(result, found)
    if all(map(is_perfect, dense)):
        return sheet
    caption = "Deviation maps of every surface under every motion"
    return [*sheet, Chart("deviation.png", caption, partial(draw_grids, result, dense))]


def _sheet(result: Result, found: Sequence[GridMeasurement]) -> list[Chart]:
    """inspection.png: the flanks that were measured on an inspector's grid, under the whole program."""
    main, halves = result.job.main, []
    for m in found:
        if m.inspection == COARSE and m.variant == main and m.topography is not None:
            halves += [Sheet(m, dense) for dense in _of(found, m.surface) if dense.variant == main]
    limits = _limits(result.job, [h.coarse.surface for h in halves])
    if not halves or not limits:
        return []
    caption = "Inspection sheet: the inspector's grid and the dense map under the whole program"
    title, lines = f"{result.name}: inspection of the flanks", _lines(result)
    return [Chart("inspection.png", caption, partial(draw_sheet, title, lines, halves, min(limits), "inspection.png"))]


def _lines(result: Result) -> list[str]:
    """What the sheet says of the job: date, program, tools, machine, verdict."""
    operations = {o.name: o.cutter.name for v in result.job.variants if v.name == result.job.main for o in v.operations}
    tools = ", ".join(f"{name}: {cutter}" for name, cutter in operations.items())
    machine = (result.scene.get("program") or {}).get("machine") or result.scene.get("machine") or {}
    kind = f"; machine {machine['kind']}" if isinstance(machine.get("kind"), str) else ""
    return [
        f"{date.today().isoformat()}, gearsim {result.versions['gearsim']}, simulated; verdict: {result.verdict}",
        f"under {result.job.main}: {tools}{kind}; {result.frame}",
        *driving_sides(result.scene),
    ]


def layers(result: Result, found: Sequence[GridMeasurement]) -> dict[str, NDArray]:
    """The machined surfaces as they are after the whole program."""
    arrays: dict[str, NDArray] = {}
    for m in _main(result, found):
        arrays |= patch_arrays(m.grid, m.deviation)
    return arrays | _tooth(result, _main(result, found))


def _tooth(result: Result, main: Sequence[GridMeasurement]) -> dict[str, NDArray]:
    """A bevel gear's slot among its neighbours, where all its surfaces were measured from tip to tip."""
    blank = main[0].grid.patch.blank if main else None
    by_name = {m.surface: m for m in main}
    names = [name for name in _FROM_TIP_TO_TIP if name in by_name]
    if blank is None or len(names) < len(_FROM_TIP_TO_TIP):
        return {}
    limits = _limits(result.job, names)
    known = np.concatenate([m.deviation.value[np.isfinite(m.deviation.value)] for m in main])
    limit = min(limits) if limits else max(1e3 * float(np.abs(known).max(initial=0.0)), 1e-3)
    what = "colours span the tolerance" if limits else "colours span the deviations"
    view = view_arrays(blank, by_name["bottom"].grid)
    return view | tooth_arrays(names, blank.teeth, limit, f"{what}, {limit:.3g} um either way")


def maps(result: Result, found: Sequence[GridMeasurement]) -> dict[str, dict[str, dict[str, Column]]]:
    """deviation.exr: one part a surface, the whole program in the plain channels."""
    return {"deviation.exr": {m.surface: channels(m, _of(found, m.surface)) for m in _main(result, found)}}


def rows(result: Result, found: Sequence[GridMeasurement]) -> list[dict[str, Column]]:
    """Every dense sample of every surface under all its variants, one row each."""
    return [sample_columns(_of(found, m.surface)) for m in _main(result, found)]


def _main(result: Result, found: Sequence[GridMeasurement]) -> list[GridMeasurement]:
    return [m for m in found if m.inspection == DENSE and m.variant == result.job.main]


def _of(found: Sequence[GridMeasurement], surface: str) -> list[GridMeasurement]:
    return [m for m in found if m.inspection == DENSE and m.surface == surface]
