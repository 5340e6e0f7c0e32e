"""report.json: the run's figures as nested plain values, units in every key."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Deviation
from gearsim.metrology.roads import LIMIT_UM, RoadGap
from gearsim.metrology.samples import SampleGrid
from gearsim.output.exr import SIGN, UNITS
from gearsim.output.presenters import presenter, slug
from gearsim.result import Result
from gearsim.surfaces.part import Tolerance

SCHEMA_VERSION = 2
PLACES = 20
PART = "part"


def write_json(report: dict[str, Any], file: Path) -> None:
    """Write the report; numbers that do not exist are null, never NaN."""
    file.write_text(json.dumps(report, indent=1, allow_nan=False) + "\n", encoding="utf-8")


def summary(result: Result) -> dict[str, Any]:
    """Everything report.json holds; what was measured goes by surface (``part``: none), variant and inspection."""
    measured: dict[str, Any] = {}
    for (surface, variant, inspection), measurement in result.measurements.items():
        under = measured.setdefault(surface or PART, {}).setdefault(slug(variant), {})
        under[slug(inspection)] = presenter(measurement).figures(measurement)
    return {
        **provenance_figures(result),
        "surfaces": {name: _tolerance(s.tolerance) for name, s in result.job.part.surfaces.items()},
        "variants": {slug(v.name): v.text for v in result.job.variants},
        "program": slug(result.job.main),
        "measurements": measured,
        "notes": list(result.job.notes),
    }  # fmt: skip


def _tolerance(t: Tolerance | None) -> dict[str, float | None] | None:
    if t is None:
        return None
    return {"overcut_tolerance_um": number(t.overcut_um), "excess_tolerance_um": number(t.excess_um)}


def provenance_figures(result: Result) -> dict[str, Any]:
    """What every report.json begins with: scene, versions, verdict, conventions, counts, timings, findings."""
    return {
        "schema_version": SCHEMA_VERSION,
        "scene": result.scene,
        "versions": result.versions,
        "device": result.device,
        "status": result.status,
        "verdict": result.verdict,
        "headline": result.headline,
        "conventions": {"units": UNITS, "sign": SIGN, "frame": result.frame, **result.job.conventions},
        "counts": result.counts,
        "timings_s": {k: round(v, 4) for k, v in result.timings_s.items()},
        "findings": [asdict(f) for f in result.findings],
    }


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


def number(x: float) -> float | None:
    return float(x) if np.isfinite(x) else None


def numbers(grid: NDArray) -> list[list[float | None]]:
    return [[number(x) for x in row] for row in grid]
