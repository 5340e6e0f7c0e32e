"""A whole gear as cut: section.png, and the arrays of gear.png."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.metrology.gear_section import SectionMeasurement
from gearsim.metrology.grid import DENSE, GridInspection, GridMeasurement
from gearsim.metrology.job import Job
from gearsim.metrology.samples import SampleGrid
from gearsim.output.gear.section import draw_section
from gearsim.output.gear.strips import Strips, section_strips
from gearsim.output.layers import outline
from gearsim.output.saving import Chart
from gearsim.result import Result
from gearsim.simulation.section import Section
from gearsim.surfaces.cylindrical_gear import CylindricalGear
from gearsim.surfaces.reached_flank import ReachedFlank

_OFF, _OFF_NEAR = 0.02, 0.002  # mm of the section in the pictures: a small part of a pixel
_BESIDE = 0.85  # pitches either side of space 0
_BEHIND = 0.6  # of the teeth's height, behind their roots


def files(job: Job, _: Any) -> list[str]:
    """The section, where the part is a gear; the gear, where its space is measured, too."""
    if _flank(job) is None:
        return []
    grids = [i for i in job.inspections if isinstance(i, GridInspection)]
    left = any(i.surface == "left" and job.main in i.variants for i in grids)
    return ["section.png", "gear.png"] if left else ["section.png"]


def figures(m: SectionMeasurement) -> dict[str, Any]:
    return {"z_mm": m.section.z, "rays": len(m.section.y)}


def charts(result: Result, found: Sequence[SectionMeasurement]) -> list[Chart]:
    flank = _flank(result.job)
    if flank is None:
        return []
    draw = partial(draw_section, found[0].section, flank.gear, result.name)
    return [Chart("section.png", "Transverse section of the whole gear as cut, and one space", draw)]


def layers(result: Result, found: Sequence[SectionMeasurement]) -> dict[str, NDArray]:
    """The gear's section, that of space 0 with its neighbours, and the tool in it."""
    flank, left = _flank(result.job), result.measurements.get(("left", result.job.main, DENSE))
    if flank is None or not isinstance(left, GridMeasurement):
        return {}
    gear, cutter = flank.gear, result.job.variant(result.job.main).operations[-1].cutter
    tolerance = result.job.part.surfaces["left"].tolerance
    section = found[0].section
    return {
        "gear:sign": np.array(gear.sign),
        "gear:facewidth": np.array(gear.facewidth),
        "gear:twist": np.array(gear.twist),
        "gear:tolerance_um": np.array(np.inf if tolerance is None else tolerance.excess_um),
        "gear:profile": outline(cutter),
        "section:z": np.array(section.z),
        **_strips("section", section_strips(section, _OFF)),
        **_strips("space", _space(section, gear)),
        **_tool(flank, left.grid, cutter),
    }


def _strips(name: str, found: Strips) -> dict[str, NDArray]:
    return {f"{name}:quads": found.quads, f"{name}:edges": found.edges}


def _space(section: Section, gear: CylindricalGear) -> Strips:
    """Space 0 and its neighbours in a section whose rays run along it."""
    height = abs(gear.tip_radius - gear.root_radius)
    middle = gear.reference_radius * np.sin(float(gear.space_centre(0, section.z)))
    half = _BESIDE * gear.pitch_angle * gear.reference_radius
    behind = gear.root_radius - gear.sign * _BEHIND * height
    x = (behind, np.inf) if gear.sign > 0 else (0.0, behind)
    return section_strips(section, _OFF_NEAR, x, (middle - half, middle + half))


def _flank(job: Job) -> ReachedFlank | None:
    """Space 0's left flank, where the part is a gear."""
    surface = job.part.surfaces.get("left")
    return surface.patch if surface is not None and isinstance(surface.patch, ReachedFlank) else None


def _tool(flank: ReachedFlank, grid: SampleGrid, cutter: Profile) -> dict[str, NDArray]:
    """The tool where it generates the middle of space 0's left flank."""
    gear = flank.gear
    roll, z = float(np.median(grid.u)), -0.5 * gear.facewidth
    jet, axis = flank.jet(roll, z), flank.axis(roll, z)
    down = (-gear.facewidth - z) / axis[2]  # the tip at the bottom face
    radius = float(np.max(outline(cutter)[:, 0]))
    return {"gear:tip": jet.r + radius * jet.normal + down * axis, "gear:axis": axis}
