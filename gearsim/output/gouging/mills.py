"""The largest mills of a catalogue on a surface: figures, the report's section, tool_size.png and tool_size.exr."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from rich.console import Console

from gearsim.gouging.choice import MillMeasurement, SizeChoice
from gearsim.output.columns import Column
from gearsim.output.gouging.mill_map import draw_sizes
from gearsim.output.gouging.words import size_notes, whole_figures, whole_section
from gearsim.output.grid_columns import place_channels
from gearsim.output.saving import Chart
from gearsim.output.summary import number
from gearsim.result import Result


def files(*_: Any) -> list[str]:
    return ["tool_size.png", "tool_size.exr"]


def figures(m: MillMeasurement) -> dict[str, Any]:
    return size_figures(m.sizes)


def size_figures(sizes: SizeChoice) -> dict[str, Any]:
    """The mill for the whole surface, by Khan's algorithm and truly, and how sizes spread."""
    fits = np.isfinite(sizes.shank)
    return {
        "points": int(fits.size),
        "no_mill_fits": int(np.count_nonzero(~fits)),
        "least_shank_mm": number(float(np.nanmin(sizes.shank))) if fits.any() else None,
        "greatest_shank_mm": number(float(np.nanmax(sizes.shank))) if fits.any() else None,
        **whole_figures(sizes.whole, sizes.place),
    }


def sections(_: Result, found: Sequence[MillMeasurement]) -> dict[str, str]:
    return {"details": size_section(figures(found[0]))}


def size_section(sizes: dict[str, Any]) -> str:
    """One mill for the whole surface, by Khan's algorithm and truly, and how sizes spread."""
    spread = (
        f"At single points R runs from {_mm(sizes['least_shank_mm'])} to {_mm(sizes['greatest_shank_mm'])}; at "
        f"{sizes['no_mill_fits']:,} of {sizes['points']:,} points none fits.\n"
    )
    return whole_section(sizes) + spread


def charts(result: Result, found: Sequence[MillMeasurement]) -> list[Chart]:
    sizes = found[0].sizes
    notes = size_notes(sizes.whole, sizes.place)
    draw = partial(draw_sizes, sizes, f"{result.name}: largest mill of the catalogue", notes, "tool_size.png")
    return [Chart("tool_size.png", "The largest mill of the catalogue that does not gouge, point by point", draw)]


def maps(_: Result, found: Sequence[MillMeasurement]) -> dict[str, dict[str, dict[str, Column]]]:
    return {"tool_size.exr": {m.surface: size_channels(m.sizes) for m in found}}


def screen(_: Result, found: Sequence[MillMeasurement], console: Console) -> None:
    for note in size_notes(found[0].sizes.whole, found[0].sizes.place):
        console.print(note)


def size_channels(sizes: SizeChoice) -> dict[str, Column]:
    """The largest mill at every point."""
    return {
        "shank.mm": Column(sizes.shank, "R, radius of the largest mill that does not gouge here"),
        "corner.mm": Column(sizes.corner, "r, corner radius of that mill"),
        **place_channels(sizes.grid),
    }


def _mm(x: float | None) -> str:
    return "–" if x is None else f"{x:g} mm"
