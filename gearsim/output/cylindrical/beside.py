"""Printed measurements beside the simulated gear: deviations, roughness and cutting time."""

from __future__ import annotations

from typing import Any

from gearsim.output.cylindrical.words import duration, size
from gearsim.output.markdown import table

_PARTS = ("slope", "form", "total")


def beside(report: dict[str, Any]) -> str:
    """Everything printed beside ours, and our roughness, which is told without a reference, too."""
    printed = report["beside"]
    parts = []
    if printed is not None:
        note = f" {printed['note']}" if printed["note"] else ""
        parts += [f"## Beside measured gears\n\n{printed['source']}.{note}\n", _tables(printed), _hours(report)]
    return "\n".join(p for p in [*parts, _roughness(report)] if p)


def _tables(printed: dict[str, Any]) -> str:
    rows = []
    for one in printed["tables"]:
        for s in one["stations"]:
            values = [(s[f"printed_{part}_um"], s[f"ours_{part}_um"]) for part in _PARTS]
            cells = [size(v) for pair in values for v in pair]
            rows.append([one["name"], f"{one['kind']}, {one['side']}", s["station"], *cells])
    if not rows:
        return ""
    heads = [f"{name} {whose}" for name in ("f_H", "f_f", "F") for whose in ("measured", "ours")]
    return (
        table(["Table", "trace", "station", *heads], rows)
        + "\nOurs: the largest of all spaces at the station nearest to the printed one (0.1, 0.5 and 0.9 of the "
        "range from top to bottom, or from root to tip).\n"
    )


def _hours(report: dict[str, Any]) -> str:
    hours, program = report["beside"]["hours"], report["program"]
    if not hours:
        return ""
    each = ", ".join(f"{op['name'].lower()} {duration(op['cutting_s'])}" for op in program["operations"])
    return (
        f"Cutting time: {hours[0]:g} to {hours[1]:g} h printed; ours **{duration(program['cutting_s'])}** in feed "
        f"({each}), rapids and tool changes not counted.\n"
    )


def _roughness(report: dict[str, Any]) -> str:
    rows = [
        [name, *(size(trace[f"{key}_um"]) for key in ("ra", "rq", "rz", "ten_point"))]
        for name, trace in report["roughness"].items()
    ]
    printed = (report["beside"] or {}).get("roughness_um") or {}
    rows += [[f"{name} (measured)", size(ra), size(rq), "–", size(ten)] for name, (ra, rq, ten) in printed.items()]
    if not rows:
        return ""
    states = sorted({trace["status"] for trace in report["roughness"].values() if trace["status"]})
    cutoffs = sorted({trace["cutoff_mm"] for trace in report["roughness"].values()})
    filtered = f" (Gaussian filter, cutoff {cutoffs[0]:g} mm)" if cutoffs else ""
    return (
        "## Roughness\n\n**The path's contribution only; flutes are not modelled.** Ours on space 1, along the middle "
        f"helix and the middle profile{filtered}.\n\n"
        + table(["Trace", "Ra", "Rq", "Rz (ISO)", "Rz (ten points)"], rows)
        + "".join(f"\n*{state}*\n" for state in states)
    )
