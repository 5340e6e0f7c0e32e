"""samples.parquet: every dense sample of every surface, one row each."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import envelope_points
from gearsim.envelope.candidates import Kind
from gearsim.geometry.jets import Curvature
from gearsim.metrology.bevel import FlankResult
from gearsim.metrology.deviation import Crossing
from gearsim.metrology.samples import SampleGrid
from gearsim.output.exr import SIGN, UNITS
from gearsim.result import FlankMillingResult, Result


def write_parquet(tables: list[dict[str, NDArray[Any]]], result: Result, file: Path) -> None:
    """Write samples, one table of flat columns a surface, with units, sign and scene in the file's metadata."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    table = pa.table({k: np.concatenate([c[k] for c in tables]) for k in tables[0]})
    notes = {"scene": result.name, "units": UNITS, "sign": SIGN}
    notes |= {"frame": result.frame, "version": result.versions["gearsim"]}
    pq.write_table(table.replace_schema_metadata({f"gearsim.{k}": v for k, v in notes.items()}), file)


def grid_columns(grid: SampleGrid, curvature: Curvature) -> dict[str, NDArray[Any]]:
    """Where the samples lie, and the intended surface's principal curvatures there."""
    row, column = np.indices(grid.shape)
    out: dict[str, NDArray[Any]] = {
        "row": row,
        "column": column,
        "length_share": np.broadcast_to(grid.length, grid.shape),
        "height_share": np.broadcast_to(grid.height[:, None], grid.shape),
    }
    for name, vectors in (("{}_mm", grid.point), ("n{}", grid.normal)):
        out |= {name.format(axis): vectors[..., k] for k, axis in enumerate("xyz")}
    return out | {"intended_k1_per_mm": curvature.k1, "intended_k2_per_mm": curvature.k2}


def flank_columns(result: FlankMillingResult, flank: FlankResult) -> dict[str, NDArray[Any]]:
    """Every dense sample of one flank, one row each."""
    grid, n, patch = flank.grid, flank.grid.phi.size, result.tooth.flank(flank.side)
    curvature = patch.jet(grid.phi.ravel(), grid.v.ravel()).curvature()
    road = flank.gap_cl.road
    k1, k2 = _machined_curvature(result, flank)
    out: dict[str, NDArray[Any]] = {
        "flank": np.full(n, flank.side),
        **dict(zip(patch.parameters, (grid.phi, grid.v), strict=True)),
        **grid_columns(grid, curvature),
    }
    if flank.own is not None:
        out["own_pass_um"] = 1e3 * flank.own.value
    out |= {
        "own_pass_cl_um": 1e3 * flank.own_cl.value,
        "all_passes_um": 1e3 * flank.all_passes.value,
        "crossing": np.array([c.name.lower() for c in Crossing])[flank.all_passes.crossing.ravel()],
        "segment": flank.all_passes.segment,
        "envelope_cl_um": 1e3 * road.deviation,
        "envelope_class": np.array(["none", *(k.name.lower() for k in Kind)])[road.kind],
        "envelope_gap_cl_um": flank.gap_cl.gap_um,
        "machined_k1_per_mm": k1,
        "machined_k2_per_mm": k2,
    }
    return {k: v.ravel() for k, v in out.items()}


def _machined_curvature(result: FlankMillingResult, flank: FlankResult) -> tuple[NDArray, NDArray]:
    """Principal curvatures [1/mm] of the envelope under the finest motion there is, nan off that class.

    CL data have straight tip lines, so their pieces are nearly straight along the face whatever the tooth.
    """
    if flank.gap is not None:
        road, sources = flank.gap.road, [result.theory[flank.side]]
    else:
        road, sources = flank.gap_cl.road, result.own_sources[flank.side]
    k1, k2 = np.full(road.kind.shape, np.nan), np.full(road.kind.shape, np.nan)
    for path, source in enumerate(sources):
        on = (road.kind == Kind.ENVELOPE) & (road.path == path)
        where = (c[on] for c in (road.piece, road.t, road.element, road.s, road.branch))
        curvature = envelope_points(source, result.cutter, *where).curvature()
        k1[on], k2[on] = curvature.k1, curvature.k2
    return k1, k2
