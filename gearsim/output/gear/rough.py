"""Roughness of flanks: figures, the table beside measured ones, roughness.png."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from gearsim.metrology.gear_roughness import RoughnessMeasurement
from gearsim.output.gear.roughness import draw_roughness
from gearsim.output.gear.words import size
from gearsim.output.markdown import table
from gearsim.output.saving import Chart
from gearsim.output.summary import number
from gearsim.result import Result

_NAMES = {"ra": "ra_um", "rq": "rq_um", "rz": "rz_um", "ten_point": "ten_point_um"}


def files(*_: Any) -> list[str]:
    return ["roughness.png"]


def figures(m: RoughnessMeasurement) -> dict[str, Any]:
    return {name: _trace(trace) for name, trace in m.traces.items()}


def _trace(trace: Any) -> dict[str, Any]:
    return {
        **{f"{name}_um": number(getattr(trace, key)) for name, key in _NAMES.items()},
        "cutoff_mm": trace.cutoff_mm,
        "evaluated_mm": [number(trace.first), number(trace.last)],
        "status": trace.status,
    }


def sections(result: Result, found: Sequence[RoughnessMeasurement]) -> dict[str, str]:
    traces = figures(found[0])
    rows = [
        [name, *(size(trace[f"{key}_um"]) for key in ("ra", "rq", "rz", "ten_point"))] for name, trace in traces.items()
    ]
    printed = (result.scene.get("reference") or {}).get("roughness_um") or {}
    rows += [[f"{name} (measured)", size(ra), size(rq), "–", size(ten)] for name, (ra, rq, ten) in printed.items()]
    states = sorted({trace["status"] for trace in traces.values() if trace["status"]})
    cutoffs = sorted({trace["cutoff_mm"] for trace in traces.values()})
    filtered = f" (Gaussian filter, cutoff {cutoffs[0]:g} mm)" if cutoffs else ""
    text = (
        "## Roughness\n\n**The path's contribution only; flutes are not modelled.** Ours on space 1, along the middle "
        f"helix and the middle profile{filtered}.\n\n"
        + table(["Trace", "Ra", "Rq", "Rz (ISO)", "Rz (ten points)"], rows)
        + "".join(f"\n*{state}*\n" for state in states)
    )
    return {"beside": text}


def charts(result: Result, found: Sequence[RoughnessMeasurement]) -> list[Chart]:
    draw = partial(draw_roughness, found[0].traces, f"{result.name}: roughness of the path alone")
    return [Chart("roughness.png", "Roughness of the path alone", draw)]
