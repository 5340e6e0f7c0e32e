"""A whole gear as cut: section.png, and the arrays of gear.png."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.metrology.dexel_check import DexelInspection, DexelMeasurement
from gearsim.metrology.gear_section import SectionMeasurement, SpaceInspection
from gearsim.metrology.grid import DENSE, GridInspection, GridMeasurement
from gearsim.metrology.job import Job
from gearsim.metrology.samples import SampleGrid
from gearsim.output.gear.section import draw_section
from gearsim.output.layers import outline
from gearsim.output.saving import Chart
from gearsim.result import Result
from gearsim.simulation.intervals import IntervalSet
from gearsim.simulation.section import Section
from gearsim.surfaces.reached_flank import ReachedFlank

_ROWS = 300
_SMOOTH = 0.8  # cells
_SLIVER = 1e-5  # mm of material: what tools that just meet leave between them


def files(job: Job, _: Any) -> list[str]:
    """The section, where the part is a gear; the gear, where its space is measured, too."""
    if _flank(job) is None:
        return []
    grids = [i for i in job.inspections if isinstance(i, GridInspection)]
    left = any(i.surface == "left" and job.main in i.variants for i in grids)
    space = any(isinstance(i, SpaceInspection | DexelInspection) for i in job.inspections)
    return ["section.png", "gear.png"] if left and space else ["section.png"]


def figures(m: SectionMeasurement) -> dict[str, Any]:
    return {"z_mm": m.section.z, "rays": len(m.section.y)}


def charts(result: Result, found: Sequence[SectionMeasurement]) -> list[Chart]:
    flank = _flank(result.job)
    if flank is None:
        return []
    draw = partial(draw_section, found[0].section, flank.gear, result.name)
    return [Chart("section.png", "Transverse section of the whole gear as cut, and one space", draw)]


def layers(result: Result, found: Sequence[SectionMeasurement]) -> dict[str, NDArray]:
    """The gear's section, its space 0 and the tool in it."""
    flank, dexels = _flank(result.job), result.measurements.get(("", result.job.main, "tri-dexel"))
    left = result.measurements.get(("left", result.job.main, DENSE))
    if flank is None or not isinstance(dexels, DexelMeasurement) or not isinstance(left, GridMeasurement):
        return {}
    gear, cutter = flank.gear, result.job.variant(result.job.main).operations[-1].cutter
    arrays = {
        "gear:sign": np.array(gear.sign),
        "gear:facewidth": np.array(gear.facewidth),
        "gear:twist": np.array(gear.twist),
        "gear:radius": np.array(gear.reference_radius),
        "gear:profile": outline(cutter),
    }
    return arrays | _body(dexels, gear.facewidth) | _section(found[0].section) | _tool(flank, left.grid, cutter)


def _flank(job: Job) -> ReachedFlank | None:
    """Space 0's left flank, where the part is a gear."""
    surface = job.part.surfaces.get("left")
    return surface.patch if surface is not None and isinstance(surface.patch, ReachedFlank) else None


def _body(dexels: DexelMeasurement, facewidth: float) -> dict[str, NDArray]:
    """The material in the tri-dexel's box as a field on its cells: its size the distance to the surface, positive
    inside, exact for planes (the three bundles give a plane's intercepts). It goes on beyond both faces of the gear.
    """
    box = dexels.box
    inverse_square: Any = 0.0
    for axis, bundle in enumerate(dexels.bundles):
        apart = 4.0 * float(np.max(bundle.rays.end))
        inside, near = _along(bundle.left, box.centres(axis) - box.lower[axis], apart, axis == 2)
        others = [int(box.counts[k]) for k in range(3) if k != axis]
        inside, near = (np.moveaxis(a.reshape(*others, -1), -1, axis) for a in (inside, near))
        inverse_square = inverse_square + 1.0 / np.maximum(near, 1e-9) ** 2
    field = np.where(inside, 1.0, -1.0) / np.sqrt(inverse_square)
    height = box.centres(2)
    between = (height > -facewidth) & (height < 0.0)
    field = np.pad(field[:, :, between], ((1, 1), (1, 1), (2, 2)), mode="edge")
    border = np.ones(field.shape, dtype=bool)
    border[1:-1, 1:-1, 1:-1] = False
    field[border] = -np.abs(field[border])
    step = (box.upper - box.lower) / box.counts
    first = [box.centres(0)[0], box.centres(1)[0], height[between][0]]
    return {"body:field": field, "body:origin": first - step * [1.0, 1.0, 2.0], "body:step": step}


def _along(left: IntervalSet, place: NDArray, apart: float, endless: bool) -> tuple[NDArray, NDArray]:
    """Whether there is material at places [mm] of every ray, and how far the nearest end of it is (rays, places).

    ``apart``: some times any ray's length; ``endless``: the stock's own ends do not count.
    """
    rays = len(left.first) - 1
    beyond = 0.25 * apart * endless
    thick = left.hi - left.lo > _SLIVER
    low = np.where(left.lo_segment < 0, left.lo - beyond, left.lo)[thick]
    high = np.where(left.hi_segment < 0, left.hi + beyond, left.hi)[thick]
    ends = (np.stack([low, high], axis=1) + apart * left.ray[thick][:, None]).ravel()
    ends = np.concatenate([[-2.0 * apart, -2.0 * apart], ends, [2.0 * apart * (rays + 1)] * 2])
    at = apart * np.arange(rays)[:, None] + place
    above = np.searchsorted(ends, at)
    near = np.minimum(at - ends[above - 1], ends[above] - at)
    return above % 2 == 1, near


def _section(section: Section) -> dict[str, NDArray]:
    """The share of material in square cells of the section (y, x), a few of its rays a row, smoothed by a cell."""
    from scipy.ndimage import gaussian_filter

    together = max(1, len(section.y) // _ROWS)
    rows = len(section.y) // together
    size = together * float(np.diff(section.y).mean())
    edges = section.start + size * np.arange(np.ceil(-2.0 * section.start / size) + 1)
    x = section.start + np.stack([section.left.lo, section.left.hi], axis=1)
    overlap = np.minimum(x[:, 1:], edges[1:]) - np.maximum(x[:, :1], edges[:-1])
    share = np.zeros((rows + 1, len(edges) - 1))
    np.add.at(share, np.minimum(section.left.ray // together, rows), np.clip(overlap, 0.0, None))
    return {
        "section:share": gaussian_filter(share[:rows] / (size * together), _SMOOTH),
        "section:y": section.y[: rows * together].reshape(rows, together).mean(axis=1),
        "section:x": 0.5 * (edges[:-1] + edges[1:]),
        "section:z": np.array(section.z),
    }


def _tool(flank: ReachedFlank, grid: SampleGrid, cutter: Profile) -> dict[str, NDArray]:
    """The tool where it generates the middle of space 0's left flank."""
    gear = flank.gear
    roll, z = float(np.median(grid.u)), -0.5 * gear.facewidth
    jet, axis = flank.jet(roll, z), flank.axis(roll, z)
    down = (-gear.facewidth - z) / axis[2]  # the tip at the bottom face
    radius = float(np.max(outline(cutter)[:, 0]))
    return {"gear:tip": jet.r + radius * jet.normal + down * axis, "gear:axis": axis}
