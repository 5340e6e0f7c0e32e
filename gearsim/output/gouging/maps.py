"""deviation.exr, tool_size.exr and samples.parquet of a run of local gouging."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.attribution import Cause
from gearsim.metrology.deviation import Crossing
from gearsim.metrology.samples import SampleGrid
from gearsim.output.exr import grid_channels
from gearsim.output.table import grid_columns
from gearsim.result import SculpturedResult, SizeChoice, ToolCut


def cut_channels(grid: SampleGrid, cut: ToolCut) -> dict[str, NDArray]:
    """One tool's map: deviation, segment, what made the overcut and what was predicted."""
    return {
        **grid_channels(grid, cut.deviation, np.full(grid.shape, np.nan)),
        "cause.id": cut.made.cause,
        "contact.id": cut.made.contact,
        "least_difference.per_mm": _least(cut, grid),
    }


def size_channels(sizes: SizeChoice) -> dict[str, NDArray]:
    """The largest mill at every point."""
    channels: dict[str, NDArray] = {"shank.mm": sizes.shank, "corner.mm": sizes.corner}
    for name, vectors in (("P", sizes.grid.point), ("N", sizes.grid.normal)):
        channels |= {f"{name}.{axis}": vectors[..., k] for k, axis in enumerate("XYZ")}
    return channels


def cut_columns(result: SculpturedResult, name: str) -> dict[str, NDArray[Any]]:
    """Every sample under one tool, one row each."""
    cut, grid = result.cuts[name], result.grid
    u, v = grid.phi.ravel(), grid.v.ravel()
    out: dict[str, NDArray[Any]] = {
        "tool": np.full(u.size, name),
        "u": u,
        "v": v,
        **grid_columns(grid, result.surface.jet(u, v).curvature()),
        "deviation_um": 1e3 * cut.deviation.value,
        "crossing": np.array([c.name.lower() for c in Crossing])[cut.deviation.crossing.ravel()],
        "segment": cut.deviation.segment,
        "cause": np.array([c.name.lower() for c in Cause])[cut.made.cause.ravel()],
        "contact": cut.made.contact,
        "contact_apart_mm": cut.made.apart,
        "theta_deg": np.degrees(cut.samples.contacts.theta),
        "least_difference_per_mm": _least(cut, grid),
        "predicted_gouge": cut.samples.gouges,
    }
    return {k: np.ravel(x) for k, x in out.items()}


def _least(cut: ToolCut, grid: SampleGrid) -> NDArray:
    return np.where(cut.samples.touches, cut.samples.comparison.least, np.nan).reshape(grid.shape)
