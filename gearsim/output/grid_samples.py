"""Every dense sample of a surface as columns of samples.parquet."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import envelope_points
from gearsim.envelope.crossings import Kind
from gearsim.metrology.deviation import Crossing
from gearsim.metrology.grid import GridMeasurement
from gearsim.output.presenters import slug

_CROSSINGS = np.array([c.name.lower() for c in Crossing])
_CLASSES = np.array(["none", *(k.name.lower() for k in Kind)])


def sample_columns(variants: list[GridMeasurement]) -> dict[str, NDArray[Any]]:
    """Columns of samples.parquet for one surface, measured under some variants; one row a sample."""
    any_one = variants[0]
    grid = any_one.grid
    row, column = np.indices(grid.shape)
    curvature = grid.patch.jet(grid.phi.ravel(), grid.v.ravel()).curvature()
    out: dict[str, NDArray[Any]] = {
        "surface": np.full(grid.phi.size, any_one.surface), "row": row, "column": column, "u": grid.phi, "v": grid.v,
        "length_share": np.broadcast_to(grid.length, grid.shape),
        "height_share": np.broadcast_to(grid.height[:, None], grid.shape),
    }  # fmt: skip
    for name, vectors in (("{}_mm", grid.point), ("n{}", grid.normal)):
        out |= {name.format(axis): vectors[..., k] for k, axis in enumerate("xyz")}
    out |= {"intended_k1_per_mm": curvature.k1, "intended_k2_per_mm": curvature.k2}
    out |= {"missing": any_one.missing, "trimmed": any_one.trimmed}
    for m in variants:
        name = slug(m.variant)
        out |= {
            f"{name}_um": 1e3 * m.deviation.value,
            f"{name}_crossing": _CROSSINGS[m.deviation.crossing],
            f"{name}_segment": m.deviation.segment,
        }
        if m.gap is not None:
            out |= _road_columns(m, name)
    return {name: np.ravel(values) for name, values in out.items()}


def _road_columns(m: GridMeasurement, name: str) -> dict[str, NDArray[Any]]:
    """What the envelope road says of a measurement's samples, and the machined surface's principal curvatures."""
    assert m.gap is not None
    road, measurable = m.gap.road, m.measurable

    def on_grid(values: NDArray, rest: Any) -> NDArray:
        out = np.full(m.grid.shape, rest, dtype=values.dtype)
        out[measurable] = values
        return out

    k1, k2 = np.full(road.kind.shape, np.nan), np.full(road.kind.shape, np.nan)
    for path, source in enumerate(m.by.motions()):
        on = (road.kind == Kind.ENVELOPE) & (road.path == path)
        where = (c[on] for c in (road.piece, road.t, road.element, road.s, road.branch))
        curvature = envelope_points(source, m.by.cutter, *where).curvature()
        k1[on], k2[on] = curvature.k1, curvature.k2
    return {
        f"{name}_gap_um": m.gap_um,
        f"{name}_envelope_um": on_grid(1e3 * road.deviation, np.nan),
        f"{name}_class": on_grid(_CLASSES[road.kind], "none"),
        f"{name}_k1_per_mm": on_grid(k1, np.nan),
        f"{name}_k2_per_mm": on_grid(k2, np.nan),
    }
