"""A gear inspected after ISO 1328-1: its figures, parameters beside tolerances and print, sheet, traces, pitches."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import degrees
from typing import Any

from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from gearsim.metrology.gear_inspection import FlankMap, GearInspection, largest
from gearsim.metrology.gear_iso import GearMeasurement
from gearsim.metrology.gear_traces import GearTraces
from gearsim.metrology.grid import DENSE, GridInspection, GridMeasurement
from gearsim.metrology.job import Job
from gearsim.output.gear.pitch import draw_pitch
from gearsim.output.gear.sheet import inspection_sheet
from gearsim.output.gear.topography import draw_topography
from gearsim.output.gear.traces import draw_traces
from gearsim.output.gear.words import size
from gearsim.output.markdown import table
from gearsim.output.saving import Chart
from gearsim.output.summary import number
from gearsim.result import Result
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side

STATIONS = {"top": 0, "middle": 1, "bottom": 2, "root": 0, "pitch": 1, "tip": 2}
PARTS = ("slope", "form", "total")
_HEADS = [f"{name} {whose}" for name in ("f_H", "f_f", "F") for whose in ("measured", "ours")]


def files(job: Job, _: Any) -> list[str]:
    """The sheet and what it sums up; the topography, where both flanks are measured."""
    grids = [i for i in job.inspections if isinstance(i, GridInspection) and i.name == DENSE]
    flanks = {i.surface for i in grids if job.main in i.variants}
    topography = ["topography.png"] if flanks.issuperset(SIDES) else []
    return ["inspection.png", "profile.png", "helix.png", "pitch.png", *topography]


def figures(m: GearMeasurement) -> dict[str, Any]:
    """Gear data, parameters, pitches and evaluated traces [um, transverse]."""
    return {"gear": _gear(m.found.gear), **_inspection(m.found)}


def sections(result: Result, found: Sequence[GearMeasurement]) -> dict[str, str]:
    """The gear and its parameters; printed tables beside."""
    inspection = found[0].found
    report = figures(found[0])
    printed = result.scene.get("reference")
    return {
        "first": _head(report) + "\n" + _parameters(report),
        "beside": "" if printed is None else _beside(printed, inspection),
    }


def _head(report: dict[str, Any]) -> str:
    gear = report["gear"]
    angle = gear["helix_angle_deg"]
    hand = "spur" if not angle else f"{abs(angle):g}° {'right' if angle > 0.0 else 'left'}-hand"
    worst = [row["class_achieved"] for row in report["parameters"] if row["class_achieved"] is not None]
    reached = f" The worst parameter measured is of class {max(worst)}." if worst else ""
    return (
        f"{gear['kind'].capitalize()} {hand} gear, z = {gear['teeth']}, normal module "
        f"{gear['normal_module_mm']:.6g} mm, normal pressure angle {gear['normal_pressure_angle_deg']:.6g}°, face "
        f"width {gear['face_width_mm']:g} mm, profile shift {gear['profile_shift']:g}. Class {report['class']} of "
        f"{report['standard']} is asked for.{reached}\n\n"
        "Traces, pitches and the error budget are **transverse** as ISO 1328-1 takes them, maps are along the "
        "normal. Slopes are positive where material grows from "
        "the root to the tip, or from the top face to the bottom. Flutes, deflection, heat and servo axes are not "
        "modelled: what is measured is what the program itself makes.\n"
    )


def _parameters(report: dict[str, Any]) -> str:
    inspection = report
    rows = []
    for row in inspection["parameters"]:
        achieved = row["class_achieved"]
        rows.append(
            [
                row["parameter"], *(size(row[f"{side}_um"]) for side in SIDES), f"{row['tolerance_um']:g} µm",
                f"{row['incomplete']} missing" if row["incomplete"] else "beyond 11" if achieved is None else achieved,
                "" if row["within"] else "**beyond**" if not row["incomplete"] else "",
            ]
        )  # fmt: skip
    spaces, count = len(inspection["spaces"]), abs(report["gear"]["teeth"])
    probed = "all spaces" if spaces == count else f"{spaces} of {count} spaces; pitch takes them all"
    head = [
        f"{inspection['standard']}", *(f"{s} flanks" for s in SIDES), f"tolerance, class {inspection['class']}",
        "class achieved", "",
    ]  # fmt: skip
    runout = f"Runout F_r (a ball in every space): {size(inspection['runout_um'])}."
    return (
        f"## Parameters\n\nLargest of {probed}, three traces on each flank.\n\n" + table(head, rows) + f"\n{runout}\n"
    )


def _beside(printed: dict[str, Any], inspection: GearInspection) -> str:
    """The scene's printed figures with ours of the same side, kind and station."""
    note = f" {printed['note']}" if printed.get("note") else ""
    rows = []
    for one in printed.get("tables", ()):
        for i, station in enumerate(one["stations"]):
            values = [(one[f"{part}_um"][i], _ours(inspection, one, station, part)) for part in PARTS]
            cells = [size(v) for pair in values for v in pair]
            rows.append([one["name"], f"{one['kind']}, {one['side']}", station, *cells])
    tables = ""
    if rows:
        tables = table(["Table", "trace", "station", *_HEADS], rows) + (
            "\nOurs: the largest of all spaces at the station nearest to the printed one (0.1, 0.5 and 0.9 of the "
            "range from top to bottom, or from root to tip).\n"
        )
    return f"## Beside measured gears\n\n{printed['source']}.{note}\n\n{tables}"


def _ours(inspection: GearInspection, printed: dict[str, Any], station: str, part: str) -> float | None:
    """The largest of all spaces at our station nearest to a printed one."""
    traces: GearTraces = getattr(inspection, printed["kind"])[printed["side"]]
    values, k = getattr(traces.evaluated(), f"{part}_um"), STATIONS.get(station)
    return None if k is None or k >= values.shape[1] else number(largest(values[:, k]))


def charts(result: Result, found: Sequence[GearMeasurement]) -> list[Chart]:
    """Sheet, traces, pitch, and the topography of space 1."""
    inspection, name = found[0].found, result.name
    gear, tolerances = inspection.gear, inspection.tolerances_um
    pitch = partial(draw_pitch, inspection.pitch, inspection.runout, tolerances, f"{name}: pitch")
    offered = [Chart("inspection.png", "Inspection sheet", partial(inspection_sheet, inspection))]
    for kind in ("profile", "helix"):
        traces = partial(draw_traces, getattr(inspection, kind), gear, tolerances, f"{name}: {kind}", f"{kind}.png")
        offered.append(Chart(f"{kind}.png", f"{kind.capitalize()} traces", traces))
    offered.append(Chart("pitch.png", "Pitch", pitch))
    maps = _flank_maps(result, gear)
    if maps:
        caption = "Topography of both flanks of space 1, along the normal, under the whole program"
        topography = partial(draw_topography, maps, gear, f"{name}: flank topography")
        offered.append(Chart("topography.png", caption, topography))
    return offered


def _flank_maps(result: Result, gear: CylindricalGear) -> dict[Side, FlankMap]:
    """Both flanks of space 0 under the whole program."""
    out: dict[Side, FlankMap] = {}
    for side in SIDES:
        m = result.measurements.get((side, result.job.main, DENSE))
        if not isinstance(m, GridMeasurement):
            return {}
        grid = m.grid
        out[side] = FlankMap(side, 0, gear.base_radius * grid.u[:, 0], grid.v[0], 1e3 * m.deviation.value)
    return out


def screen(result: Result, found: Sequence[GearMeasurement], console: Console) -> None:
    """Parameters of ISO 1328-1 by side, beside their tolerances."""
    inspection = found[0].found
    shown = Table(title=f"{result.name}: ISO 1328-1:2013, transverse, class {inspection.gear_class} asked for")
    shown.add_column("parameter")
    for head in (*(f"{side} flanks" for side in SIDES), "tolerance", "class achieved"):
        shown.add_column(head, justify="right")
    for row in inspection.rows():
        style = "" if row.within or row.incomplete else "bold red"
        achieved = row.achieved or (f"{row.incomplete} missing" if row.incomplete else "beyond 11")
        values = [size(row.value_um[side]) for side in SIDES]
        shown.add_row(row.parameter, *values, f"{row.tolerance_um:g} µm", str(achieved), style=style)
    console.print(shown)


def _gear(gear: CylindricalGear) -> dict[str, Any]:
    return {
        "teeth": gear.teeth,
        "kind": "internal" if gear.is_internal else "external",
        "normal_module_mm": gear.module,
        "transverse_module_mm": gear.transverse_module,
        "normal_pressure_angle_deg": degrees(gear.pressure_angle),
        "transverse_pressure_angle_deg": degrees(gear.transverse_pressure_angle),
        "helix_angle_deg": degrees(gear.helix_angle),
        "face_width_mm": gear.facewidth,
        "profile_shift": gear.profile_shift,
        **{f"{name}_radius_mm": getattr(gear, f"{name}_radius") for name in ("tip", "root", "reference", "base")},
    }


def _inspection(found: GearInspection) -> dict[str, Any]:
    return {
        "standard": "ISO 1328-1:2013, transverse",
        "class": found.gear_class,
        "spaces": [k + 1 for k in next(iter(found.profile.values())).teeth],
        "parameters": [
            {
                "parameter": row.parameter,
                "tolerance_um": row.tolerance_um,
                **{f"{side}_um": number(row.value_um[side]) for side in SIDES},
                "class_achieved": row.achieved,
                "incomplete": row.incomplete,
                "within": row.within,
            }
            for row in found.rows()
        ],
        "runout_um": number(found.runout.total),
        "pitch": {
            side: {"single_um": _list(p.single_um), "cumulative_um": _list(p.cumulative_um)}
            for side, p in found.pitch.items()
        },
        "profile": {side: _traces(t) for side, t in found.profile.items()},
        "helix": {side: _traces(t) for side, t in found.helix.items()},
    }


def _traces(traces: GearTraces) -> dict[str, Any]:
    """f_H, f_f, F by space and station, with the range evaluated: roll lengths, or z."""
    found, span = traces.evaluated(), traces.span
    return {
        "stations_mm": list(traces.stations),
        "evaluated_mm": [span.first, span.last],
        **{f"{part}_um": [_list(row) for row in getattr(found, f"{part}_um")] for part in PARTS},
    }


def _list(values: NDArray) -> list[float | None]:
    return [number(v) for v in values]
