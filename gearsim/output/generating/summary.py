"""report.json of a run that generates surfaces."""

from __future__ import annotations

from typing import Any

from gearsim.metrology.surface import SurfaceResult
from gearsim.output.summary import convergence_figures, dexel_figures, gap_figures, provenance_figures, worst_at
from gearsim.result import GeneratingResult


def summary(result: GeneratingResult) -> dict[str, Any]:
    """Everything report.json holds."""
    conventions = {
        "motions": "the first one generates the surfaces; the others are measured against them",
        "missing": "the closed form has no point there",
        "trimmed": "the generating motion itself cuts deeper there with another pose",
        "grids": "rows root (tip of the tool) to tip (its shank), columns along the motion or toe to heel",
    }
    out = {
        **provenance_figures(result, conventions),
        "motions": result.texts,
        "machine_notes": list(result.notes),
        "flanks": {name: _surface(surface) for name, surface in result.surfaces.items()},
    }
    if result.dexels is not None:
        out["tri_dexel"] = dexel_figures(result.dexels)
    return out


def _surface(surface: SurfaceResult) -> dict[str, Any]:
    points = surface.grid.point[surface.measurable]
    return {
        "samples": int(surface.measurable.size),
        "missing": int(surface.missing.sum()),
        "trimmed": int(surface.trimmed.sum()),
        "motions": {
            name: {
                "deviation_um": deviation.summary_um(),
                "worst_at": worst_at(surface.grid, deviation),
                "envelope_gap_um": gap_figures(points, surface.gaps[name]),
            }
            for name, deviation in surface.deviations.items()
        },
        "convergence": {name: convergence_figures(c) for name, c in surface.convergence.items()},
    }
