"""deviation.exr and samples.parquet of a run that generates surfaces."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Crossing
from gearsim.metrology.surface import SurfaceResult
from gearsim.output.exr import grid_channels
from gearsim.output.table import grid_columns
from gearsim.result import GeneratingResult


def shown_motion(result: GeneratingResult) -> str:
    """The motion whose deviations stand in the plain channels: the last judged one, else the generating one."""
    judged = result.scene["metrology"]["judged"]
    return str(judged[-1]) if judged else next(iter(result.texts))


def surface_channels(result: GeneratingResult, surface: SurfaceResult) -> dict[str, NDArray]:
    """Channels of one surface: the shown motion's, and ``NAME.deviation_um`` for every motion."""
    shown = shown_motion(result)
    channels = grid_channels(surface.grid, surface.deviations[shown], _gap(surface, shown))
    return channels | {f"{name}.deviation_um": 1e3 * d.value for name, d in surface.deviations.items()}


def surface_columns(result: GeneratingResult, surface: SurfaceResult) -> dict[str, NDArray[Any]]:
    """Every dense sample of one surface, one row each."""
    grid, n = surface.grid, surface.missing.size
    curvature = grid.patch.jet(grid.phi.ravel(), grid.v.ravel()).curvature()
    out: dict[str, NDArray[Any]] = {
        "flank": np.full(n, grid.patch.name),
        "u": grid.phi,
        "arc_length_mm": grid.v,
        **grid_columns(grid, curvature),
        "missing": surface.missing,
        "trimmed": surface.trimmed,
    }
    names = np.array([c.name.lower() for c in Crossing])
    for name, deviation in surface.deviations.items():
        out |= {
            f"{name}_um": 1e3 * deviation.value,
            f"{name}_crossing": names[deviation.crossing.ravel()],
            f"{name}_envelope_gap_um": _gap(surface, name),
        }
    return {k: np.ravel(v) for k, v in out.items()}


def _gap(surface: SurfaceResult, motion: str) -> NDArray:
    gap = np.full(surface.missing.shape, np.nan)
    gap[surface.measurable] = surface.gaps[motion].gap_um
    return gap
