"""What is drawn of a job itself: its toolpaths, envelopes, axes and blanks, whatever was measured."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.grid import DENSE, GridInspection
from gearsim.motion.axes import AxisMotion
from gearsim.output.charts import draw_axes
from gearsim.output.layers import grazing_curves, outline, path_arrays
from gearsim.output.saving import Chart
from gearsim.result import Result


def layers(result: Result, _: Sequence[Any]) -> dict[str, NDArray]:
    """Of every witnessed surface the motion that finishes it, and the blanks in mesh."""
    arrays = _generating(result)
    for inspection in result.job.inspections:
        if isinstance(inspection, GridInspection) and inspection.name == DENSE and inspection.witnessed:
            variant = result.job.variant(inspection.witnessed[0], inspection.surface)
            if not inspection.generating and not variant.cutter.is_ring:
                arrays |= path_arrays(variant, inspection.surface)
    part = result.job.part
    if part.stock is not None and part.mate is not None:
        arrays |= {"part:polygon": part.stock.polygon, "mate:polygon": part.mate.polygon}
    return arrays


def _generating(result: Result) -> dict[str, NDArray]:
    """Surfaces with their grazing curves, and the tool that generates them along its motion."""
    grids = [i for i in result.job.inspections if isinstance(i, GridInspection) and i.generating and i.name == DENSE]
    if not grids:
        return {}
    arrays = {f"grazing:{i.surface}": grazing_curves(i.grid(result.job)) for i in grids}
    variant = result.job.variant(grids[0].generating, grids[0].surface)
    source = variant.motions()[0]
    piece = np.array([0, (source.pieces - 1) // 2, source.pieces - 1])
    pose = source.pose(piece, np.array([0.0, 0.5 if source.pieces % 2 else 1.0, 1.0]), 0)
    return arrays | {"tool:profile": outline(variant.cutter), "tool:tip": pose.tip.value, "tool:axis": pose.axis.value}


def charts(result: Result, _: Sequence[Any]) -> list[Chart]:
    """axes.png: the axis values of every machine's motion over its blocks; nothing where there is none."""
    motions = {
        v.name: source
        for v in result.job.variants
        for o in v.operations
        for source in o.sources
        if isinstance(source, AxisMotion) and " N = " not in v.name
    }
    return [Chart("axes.png", "Axis values along the motion", partial(draw_axes, motions))] if motions else []
