"""What is drawn of a job itself: its toolpaths, envelopes, axes and blanks, whatever was measured."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.grid import DENSE, GridInspection
from gearsim.metrology.job import Job
from gearsim.motion.axes import AxisMotion
from gearsim.output.charts import draw_axes
from gearsim.output.layers import grazing_curves, outline, path_arrays
from gearsim.output.saving import Chart
from gearsim.result import Result
from gearsim.simulation.operation import Variant


def files(job: Job, _: Sequence[Any]) -> list[str]:
    """Pictures of the job's motions and blanks."""
    named = {
        "axes.png": bool(_axes(job)),
        "envelope.png": any(i.generating for i in _grids(job)),
        "toolpaths.png": bool(_passes(job)),
        "envelopes.png": bool(_passes(job)),
        "blanks.png": job.part.stock is not None and job.part.mate is not None,
    }
    return [name for name, given in named.items() if given]


def layers(result: Result, _: Sequence[Any]) -> dict[str, NDArray]:
    """Of every witnessed surface the motion that finishes it, and the blanks in mesh."""
    arrays = _generating(result)
    for surface, variant in _passes(result.job).items():
        arrays |= path_arrays(variant, surface)
    part = result.job.part
    if part.stock is not None and part.mate is not None:
        arrays |= {"part:polygon": part.stock.polygon, "mate:polygon": part.mate.polygon}
    return arrays


def _grids(job: Job) -> list[GridInspection]:
    return [i for i in job.inspections if isinstance(i, GridInspection) and i.name == DENSE]


def _passes(job: Job) -> dict[str, Variant]:
    """The variant that finishes a gear's surface in a pass of its own, by surfaces."""
    mine = [i for i in _grids(job) if i.witnessed and not i.generating and job.part.patch(i.surface).blank is not None]
    by = {i.surface: job.variant(i.witnessed[0], i.surface) for i in mine}
    return {surface: variant for surface, variant in by.items() if not variant.cutter.is_ring}


def _generating(result: Result) -> dict[str, NDArray]:
    """Surfaces with their grazing curves, and the tool that generates them along its motion."""
    grids = [i for i in _grids(result.job) if i.generating]
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
    motions = _axes(result.job)
    return (
        [Chart("axes.png", "Axis values along the motion", partial(draw_axes, result.name, motions))] if motions else []
    )


def _axes(job: Job) -> dict[str, AxisMotion]:
    """Machines' motions by variants, less those of convergence series."""
    return {
        v.name: source
        for v in job.variants
        for o in v.operations
        for source in o.sources
        if isinstance(source, AxisMotion) and " N = " not in v.name
    }
