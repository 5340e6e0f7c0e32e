"""report.json of a cylindrical gear: values in um as ISO 1328-1 takes them (transverse), units in every key."""

from __future__ import annotations

from dataclasses import asdict
from math import degrees
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.gear_inspection import largest
from gearsim.metrology.gear_traces import GearTraces
from gearsim.metrology.surface import SurfaceResult
from gearsim.output.summary import dexel_figures, gap_figures, number, provenance_figures, worst_at
from gearsim.result import GearResult
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear

STATIONS = {"top": 0, "middle": 1, "bottom": 2, "root": 0, "pitch": 1, "tip": 2}
PARTS = ("slope", "form", "total")


def summary(result: GearResult) -> dict[str, Any]:
    """Everything report.json holds."""
    conventions = {
        "transverse": "traces, parameters and budget are transverse (ISO 1328-1); maps are along the normal",
        "slopes": "positive where material grows from root to tip, or from the top face to the bottom",
        "spaces": "counted from 1; space 1 on +x at the top face z = 0",
        "program": "the whole program; last operation: the blocks alone that made the flank",
        "grids": "rows root to tip, columns top to bottom face",
    }
    return {
        **provenance_figures(result, conventions),
        "gear": _gear(result.gear),
        "reached": {side: _reached(result.gear, *result.reached[side]) for side in SIDES},
        "inspection": _inspection(result),
        "flanks": {side: _map(surface) for side, surface in result.maps.items()},
        "roughness": {name: _roughness(trace) for name, trace in result.roughness.items()},
        "budget": [_plain(asdict(line)) for line in result.budget],
        "beside": _beside(result),
        "program": {
            "lines": result.program.count("\n"),
            "blocks": result.counts["blocks"],
            "operations": [_operation(result, name) for name in result.cutting_s],
            "cutting_s": number(sum(result.cutting_s.values())),
            "notes": list(result.notes),
        },
        "section": {"z_mm": result.section.z, "rays": len(result.section.y)},
        "tri_dexel": dexel_figures(result.dexels),
    }


def _operation(result: GearResult, name: str) -> dict[str, Any]:
    largest_speed, feed = result.speeds[name]
    return {
        "name": name,
        "cutting_s": number(result.cutting_s[name]),
        "largest_speed_mm_per_min": number(largest_speed),
        "feed_mm_per_min": number(feed),
    }


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


def _reached(gear: CylindricalGear, root: float, tip: float) -> dict[str, float]:
    return {
        "root_roll_deg": degrees(root),
        "tip_roll_deg": degrees(tip),
        "root_radius_mm": float(gear.radius(root)),
        "tip_radius_mm": float(gear.radius(tip)),
    }


def _inspection(result: GearResult) -> dict[str, Any]:
    found = result.inspection
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


def _map(surface: SurfaceResult) -> dict[str, Any]:
    points = surface.grid.point.reshape(-1, 3)
    return {
        "samples": int(surface.grid.phi.size),
        "motions": {
            name: {
                "deviation_um": deviation.summary_um(),
                "worst_at": worst_at(surface.grid, deviation),
                "envelope_gap_um": gap_figures(points, surface.gaps.get(name)),
            }
            for name, deviation in surface.deviations.items()
        },
    }


def _roughness(trace: Any) -> dict[str, Any]:
    names = {"ra": "ra_um", "rq": "rq_um", "rz": "rz_um", "ten_point": "ten_point_um"}
    return {
        **{f"{name}_um": number(getattr(trace, key)) for name, key in names.items()},
        "cutoff_mm": trace.cutoff_mm,
        "evaluated_mm": [number(trace.first), number(trace.last)],
        "status": trace.status,
    }


def _beside(result: GearResult) -> dict[str, Any] | None:
    """The scene's printed figures with ours of the same side, kind and station; None where it has none."""
    printed = result.scene.get("reference")
    if printed is None:
        return None
    return {
        **{key: printed.get(key) for key in ("source", "note", "hours", "roughness_um")},
        "tables": [
            {
                **{key: table[key] for key in ("name", "kind", "side")},
                "stations": [_station(result, table, i) for i in range(len(table["stations"]))],
            }
            for table in printed["tables"]
        ],
    }


def _station(result: GearResult, table: dict[str, Any], i: int) -> dict[str, Any]:
    """One printed column, and the largest of all spaces at our station nearest to it."""
    traces = getattr(result.inspection, table["kind"])[table["side"]]
    name, found = table["stations"][i], traces.evaluated()
    k = STATIONS.get(name)
    out: dict[str, Any] = {"station": name}
    for part in PARTS:
        values = getattr(found, f"{part}_um")
        ours = np.nan if k is None or k >= values.shape[1] else largest(values[:, k])
        out |= {f"printed_{part}_um": table[f"{part}_um"][i], f"ours_{part}_um": number(ours)}
    return out


def _list(values: NDArray) -> list[float | None]:
    return [number(v) for v in values]


def _plain(line: dict[str, Any]) -> dict[str, Any]:
    """A budget line with null for what is nan."""
    parameters = {k: None if v is None else number(v) for k, v in line.pop("parameters").items()}
    numbers = {k: number(v) if isinstance(v, float) else v for k, v in line.items()}
    return {**numbers, "parameters_um": parameters}
