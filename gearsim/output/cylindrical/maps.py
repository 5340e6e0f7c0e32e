"""The dense maps of space 0's flanks, as charts, deviation.exr and samples.parquet want them."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.gear_inspection import FlankMap
from gearsim.metrology.surface import SurfaceResult
from gearsim.output.exr import grid_channels
from gearsim.output.table import grid_columns
from gearsim.result import GearResult
from gearsim.surfaces.cylindrical_gear import SIDES, Side


def shown(surface: SurfaceResult) -> Deviation:
    """Deviations under the whole program, which stand in the plain channels and pictures."""
    return next(iter(surface.deviations.values()))


def flank_maps(result: GearResult) -> dict[Side, FlankMap]:
    """Both flanks under the whole program, for the topography."""
    radius = result.gear.base_radius
    out: dict[Side, FlankMap] = {}
    for side in SIDES:
        grid, um = result.maps[side].grid, 1e3 * shown(result.maps[side]).value
        out[side] = FlankMap(side, 0, radius * grid.phi[:, 0], grid.v[0], um)
    return out


def map_channels(surface: SurfaceResult) -> dict[str, NDArray]:
    """Channels of one flank: the whole program's, and ``NAME.deviation.um`` for every motion."""
    channels = grid_channels(surface.grid, shown(surface), _gap(surface))
    return channels | {f"{_key(name)}.deviation.um": 1e3 * d.value for name, d in surface.deviations.items()}


def map_columns(surface: SurfaceResult) -> dict[str, NDArray[Any]]:
    """Every dense sample of one flank, one row each."""
    grid, n = surface.grid, surface.missing.size
    curvature = grid.patch.jet(grid.phi.ravel(), grid.v.ravel()).curvature()
    names = np.array([c.name.lower() for c in Crossing])
    out: dict[str, NDArray[Any]] = {
        "flank": np.full(n, grid.patch.name),
        "roll_angle_rad": grid.phi,
        **grid_columns(grid, curvature),
    }
    absent = Deviation(*(np.full(grid.shape, v) for v in (np.nan, Crossing.ABSENT, -1, False)))
    for name in ("program", "last operation"):
        found = surface.deviations.get(name, absent)
        out |= {f"{_key(name)}_um": 1e3 * found.value, f"{_key(name)}_crossing": names[found.crossing.ravel()]}
    out |= {"segment": shown(surface).segment, "envelope_gap_um": _gap(surface)}
    return {k: np.ravel(v) for k, v in out.items()}


def _key(name: str) -> str:
    return name.replace(" ", "_")


def _gap(surface: SurfaceResult) -> NDArray:
    """The two roads' gap [um] where the last operation was measured by both, else nan."""
    gaps = list(surface.gaps.values())
    return gaps[0].gap_um if gaps else np.full(surface.grid.shape, np.nan)
