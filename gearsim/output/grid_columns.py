"""Columns of samples.parquet and channels of deviation.exr that tell of surfaces measured on grids."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import envelope_points
from gearsim.envelope.crossings import Kind
from gearsim.metrology.grid import GridMeasurement
from gearsim.metrology.roads import RoadGap
from gearsim.metrology.samples import SampleGrid
from gearsim.output.columns import (
    CLASSES,
    CROSSINGS,
    YES_NO,
    Column,
    key_of_words,
    known,
    row_lines,
    row_names,
    segment_key,
    words,
)
from gearsim.output.presenters import slug


def sample_columns(variants: Sequence[GridMeasurement]) -> dict[str, Column]:
    """Every sample of one surface under all its variants, row by row of its grid."""
    any_one = variants[0]
    out = _place_columns(any_one.surface, any_one.grid) | {
        "missing": Column(any_one.missing, "the intended surface has no point here"),
        "trimmed": Column(any_one.trimmed, "the motion that generates the surface cuts deeper here with another pose"),
    }
    for m in variants:
        out |= _variant_columns(m)
    return out


def _place_columns(surface: str, grid: SampleGrid) -> dict[str, Column]:
    """Where the samples lie on the intended surface, and how it bends there."""
    row, column = np.indices(grid.shape)
    curvature = grid.patch.jet(grid.u.ravel(), grid.v.ravel()).curvature()
    along, up = np.broadcast_arrays(grid.length[None, :], grid.height[:, None])
    out = {
        "surface": Column(np.full(grid.shape, surface), "name of the surface"),
        "row": Column(row, "row of the grid, 0 at the root or lowest end"),
        "column": Column(column, "column of the grid, 0 at the toe or first end"),
        "u": Column(grid.u, "first parameter of the intended surface"),
        "v": Column(grid.v, "second parameter of the intended surface"),
        "length_share": Column(along, "place along the surface as a share of its length"),
        "height_share": Column(up, "place up the surface as a share of its height"),
    }
    for k, axis in enumerate("xyz"):
        out[f"{axis}_mm"] = Column(grid.point[..., k], f"{axis} of the intended point")
    for k, axis in enumerate("xyz"):
        out[f"n{axis}"] = Column(grid.normal[..., k], f"{axis} of the unit normal out of the material")
    for k, which, values in ((1, "greater", curvature.k1), (2, "smaller", curvature.k2)):
        text = f"{which} principal curvature of the intended surface; negative where the material bulges"
        out[f"intended_k{k}_per_mm"] = Column(values, text)
    return out


def _variant_columns(m: GridMeasurement) -> dict[str, Column]:
    name, crossing = slug(m.variant), words(CROSSINGS, m.deviation.crossing)
    met = f"what the ray along the normal met under {m.variant}"
    out = {
        f"{name}_um": _deviation(m),
        f"{name}_crossing": Column(crossing, met, key_of_words(CROSSINGS)),
        f"{name}_segment": _segment(m),
        **_program_columns(m, name),
    }
    return out if m.gap is None else out | _road_columns(m, m.gap, name)


def _deviation(m: GridMeasurement) -> Column:
    return Column(1e3 * m.deviation.value, f"deviation under {m.variant}; positive: material left")


def _segment(m: GridMeasurement) -> Column:
    made = f"row of the motion, from 0, that made the surface under {m.variant}"
    return Column(known(m.deviation.segment), made, segment_key(m.by))


def _program_columns(m: GridMeasurement, name: str) -> dict[str, Column]:
    """What of a program made each sample; nothing where no program is known."""
    lines = row_lines(m.by)
    if not lines.any():
        return {}
    none = m.deviation.segment < 0
    row = np.where(none, 0, m.deviation.segment)
    made = np.ma.masked_array(row_names(m.by)[row], none)
    line = np.ma.masked_array(lines[row], none | (lines[row] == 0))
    told = "of the program, G-code, CL data or axis values, whose move made the surface"
    return {
        f"{name}_operation": Column(made, f"operation, and its heading or motion, {told} under {m.variant}"),
        f"{name}_line": Column(line, f"line, from 1, {told} under {m.variant}"),
    }


def _gap(m: GridMeasurement) -> Column:
    return Column(m.gap_um, f"how far the two roads are apart under {m.variant}")


def _road_columns(m: GridMeasurement, gap: RoadGap, name: str) -> dict[str, Column]:
    """What the envelope road says of a measurement's samples, and the machined surface's principal curvatures."""
    road, measurable = gap.road, m.measurable

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
    kinds = words(CLASSES, on_grid(road.kind, 0))
    by, of = f"by the envelope road under {m.variant}", f"of the machined surface under {m.variant}, where it is smooth"
    return {
        f"{name}_gap_um": _gap(m),
        f"{name}_envelope_um": Column(on_grid(1e3 * road.deviation, np.nan), f"deviation {by}"),
        f"{name}_class": Column(kinds, f"what the machined surface is {by}", key_of_words(CLASSES)),
        f"{name}_k1_per_mm": Column(on_grid(k1, np.nan), f"greater principal curvature {of}"),
        f"{name}_k2_per_mm": Column(on_grid(k2, np.nan), f"smaller principal curvature {of}"),
    }


def channels(main: GridMeasurement, variants: Sequence[GridMeasurement]) -> dict[str, Column]:
    """The maps of a surface: under the whole program, its deviation first; under its parts; where the samples lie."""
    out = {
        "deviation.um": _deviation(main),
        "segment.id": _segment(main),
        "valid": Column(main.deviation.measured, "whether a deviation was measured", YES_NO),
    }
    for m in variants:
        if m is not main:
            out[f"{slug(m.variant)}.deviation.um"] = _deviation(m)
        if m.gap is not None:
            out[f"{slug(m.variant)}.gap.um"] = _gap(m)
    return out | place_channels(main.grid)


def place_channels(grid: SampleGrid) -> dict[str, Column]:
    """Where the samples of a map lie: point, normal, shares of the surface and its own parameters."""
    out: dict[str, Column] = {}
    for name, what, vectors in (
        ("P", "intended point [mm]", grid.point),
        ("N", "unit normal out of the material", grid.normal),
    ):
        out |= {f"{name}.{axis}": Column(vectors[..., k], f"{axis} of the {what}") for k, axis in enumerate("XYZ")}
    along, up = np.broadcast_arrays(grid.length[None, :], grid.height[:, None])
    return out | {
        "share.length": Column(along, "place along the surface as a share of its length, by columns"),
        "share.height": Column(up, "place up the surface as a share of its height, by rows"),
        "parameter.u": Column(grid.u, "first parameter of the intended surface"),
        "parameter.v": Column(grid.v, "second parameter of the intended surface"),
    }
