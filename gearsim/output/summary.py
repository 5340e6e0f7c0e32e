"""report.json: the run's figures as nested plain values, units in every key."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.bevel import Convergence, FlankResult
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.dexel_check import DexelResult
from gearsim.metrology.roads import LIMIT_UM, RoadGap
from gearsim.metrology.samples import SampleGrid
from gearsim.metrology.topography import Topography
from gearsim.output.exr import SIGN, UNITS
from gearsim.result import FlankMillingResult, Result

SCHEMA_VERSION = 1
PLACES = 20


def write_json(report: dict[str, Any], file: Path) -> None:
    """Write the report; numbers that do not exist are null, never NaN."""
    file.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def summary(result: FlankMillingResult) -> dict[str, Any]:
    """Everything report.json holds."""
    reference = result.scene.get("reference")
    conventions = {
        "own_pass": "the flank's own pass, planner's continuous motion",
        "own_pass_cl": "the flank's own pass as CL data",
        "all_passes": "the whole CL program, rapid moves included",
        "grids": "rows root to tip, columns toe to heel",
    }
    return {
        **provenance_figures(result, conventions),
        "flanks": {side: _flank(flank, reference) for side, flank in result.flanks.items()},
        "root": {name: {"deviation_um": p.deviation.summary_um()} for name, p in result.patches.items()},
        "tri_dexel": dexel_figures(result.dexels),
        "program_notes": list(result.notes),
    }


def dexel_figures(dexels: DexelResult) -> dict[str, Any]:
    """The tri-dexel: its size, what was removed, how its ends agree with the rays."""
    return {
        "pitch_mm": dexels.box.pitch,
        "rays": [len(b.rays) for b in dexels.bundles],
        "removed_volume_mm3": dexels.removed_volumes,
        "check_um": {"max": number(dexels.check_um), "points": dexels.checked},
    }


def provenance_figures(result: Result, conventions: dict[str, str]) -> dict[str, Any]:
    """What every report.json begins with: scene, versions, verdict, conventions, counts, timings, findings."""
    return {
        "schema_version": SCHEMA_VERSION,
        "scene": result.scene,
        "versions": result.versions,
        "device": result.device,
        "status": result.status,
        "verdict": result.verdict,
        "conventions": {"units": UNITS, "sign": SIGN, "frame": result.frame, **conventions},
        "counts": result.counts,
        "timings_s": {k: round(v, 4) for k, v in result.timings_s.items()},
        "findings": [asdict(f) for f in result.findings],
    }


def _flank(flank: FlankResult, reference: dict[str, Any] | None) -> dict[str, Any]:
    deviations: dict[str, Deviation | None] = {
        "own_pass": flank.own,
        "own_pass_cl": flank.own_cl,
        "all_passes": flank.all_passes,
        "other_passes": flank.others,
    }
    out: dict[str, Any] = {
        name: None if d is None else {"deviation_um": d.summary_um(), "worst_at": worst_at(flank.grid, d)}
        for name, d in deviations.items()
    }
    points = flank.grid.point.reshape(-1, 3)
    out |= {
        "envelope_gap_um": gap_figures(points, flank.gap),
        "envelope_gap_cl_um": gap_figures(points, flank.gap_cl),
        "inspection_gap_um": {"max": max(g.max_um for g in flank.inspection_gaps)},
        "convergence": convergence_figures(flank.convergence),
        "grid_um": _numbers(flank.topography["all_passes"].as_cut_um),
        "topography": {name: _topography(t) for name, t in flank.topography.items()},
        "profile_um": {k: number(v) for k, v in flank.profile_um.items()},
        "profile_inplane_um": {k: number(v) for k, v in flank.profile_inplane_um.items()},
    }
    if reference is not None:
        out["published_profile_um"] = dict(zip(flank.profile_um, published_um(reference, flank.side), strict=False))
    return out


def published_um(reference: dict[str, Any], side: str) -> list[float]:
    """Published deviations in our sign: positive is material left."""
    turn = -1.0 if reference["overcut_is_positive"] else 1.0
    return [turn * v for v in reference[f"{side}_um"]]


def worst_at(grid: SampleGrid, deviation: Deviation) -> dict[str, Any] | None:
    """Where the largest measured deviation lies."""
    if not deviation.measured.any():
        return None
    size = np.where(deviation.measured, np.abs(deviation.value), -1.0)
    i = np.unravel_index(int(np.argmax(size)), grid.shape)
    return {
        "deviation_um": 1e3 * float(deviation.value[i]),
        "row": int(i[0]),
        "column": int(i[1]),
        "place_mm": [float(x) for x in grid.point[i]],
    }


def gap_figures(points: NDArray, gap: RoadGap | None) -> dict[str, Any] | None:
    """The gap, and where and why samples are excluded (the first few places); ``points`` [mm], shape (n, 3)."""
    if gap is None:
        return None
    lost = np.flatnonzero(~gap.road.valid)
    return {
        "max": gap.max_um,
        "limit": LIMIT_UM,
        "valid": gap.valid,
        "excluded": gap.excluded,
        "excluded_reason": "no class of the machined surface reaches the measuring window" if len(lost) else None,
        "excluded_places_mm": [[float(x) for x in points[i]] for i in lost[:PLACES]],
        "disagree": gap.disagree,
        "class_share": gap.road.share(),
    }


def convergence_figures(convergence: Convergence | None) -> dict[str, Any] | None:
    if convergence is None:
        return None
    orders = convergence.orders
    return {
        "points": list(convergence.points),
        "worst_um": list(convergence.worst_um),
        "orders": [number(q) for q in orders],
        "order": number(float(np.median(orders))) if orders else None,
    }


def _topography(t: Topography) -> dict[str, Any]:
    return {
        "as_cut_um": _numbers(t.as_cut_um),
        "mid_zeroed_um": _numbers(t.mid_zeroed_um),
        "best_rotated_um": _numbers(t.best_rotated_um),
        "mid_rotation_um": number(t.mid_rotation_um),
        "mid_rotation_deg": number(t.rotation_deg(t.mid_rotation_um)),
        "best_rotation_um": number(t.best_rotation_um),
        "best_rotation_deg": number(t.rotation_deg(t.best_rotation_um)),
        "radius_mm": t.mid_radius_mm,
    }


def number(x: float) -> float | None:
    return float(x) if np.isfinite(x) else None


def _numbers(grid: NDArray) -> list[list[float | None]]:
    return [[number(x) for x in row] for row in grid]
