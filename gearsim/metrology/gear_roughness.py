"""Roughness of a gear's flanks along the middle helix and the middle profile: the path's part of it alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import measure
from gearsim.metrology.gear_iso import ProbedGear
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.metrology.roughness import Roughness, measure_roughness
from gearsim.metrology.samples import window_rays
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side
from gearsim.surfaces.involute import InvoluteFlank

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_ROUGH_POINTS = 1001


@dataclass(frozen=True)
class RoughnessMeasurement:
    """Roughness of space 0's flanks under a variant, by trace."""

    variant: str
    traces: dict[str, Roughness]
    surface: str = ""
    inspection: str = "roughness"


@dataclass(frozen=True)
class RoughnessInspection:
    """Space 0's flanks along the middle helix and the middle profile under a variant."""

    variant: str
    probed: ProbedGear
    name: str = "roughness"

    def steps(self, job: Job) -> Steps[Reading]:
        lines = {}
        for side in SIDES:
            for name, u, v, way, degree in _rough_lines(self.probed.gear, side, self.probed.reached[side]):
                flank = InvoluteFlank(self.probed.gear, side)
                lines[f"{side} flank, {name}"] = (window_rays(flank, u, v, flank.jet(u, v).normal), way, degree)
        variant = job.variant(self.variant)
        removed = yield [Cut(rays, variant) for rays, _, _ in lines.values()]
        traces = {
            name: measure_roughness(way, 1e3 * measure(rays, cut).value, degree)
            for (name, (rays, way, degree)), cut in zip(lines.items(), removed, strict=True)
        }
        return Reading((RoughnessMeasurement(self.variant, traces),))


def _rough_lines(
    gear: CylindricalGear, side: Side, reached: tuple[float, float]
) -> list[tuple[str, NDArray, NDArray, NDArray, int]]:
    """Name, rolls, heights, path length [mm] and degree of the form (the thesis's) of both lines."""
    even = np.linspace(0.02, 0.98, _ROUGH_POINTS)
    low, high = sorted(reached)
    z = -gear.facewidth * even
    along_helix = -z * np.hypot(1.0, gear.twist * gear.reference_radius)
    middle = np.full(_ROUGH_POINTS, 0.5 * (low + high))
    arc = np.linspace((low + 0.02 * (high - low)) ** 2, (high - 0.02 * (high - low)) ** 2, _ROUGH_POINTS)
    along_profile = 0.5 * gear.base_radius * arc
    half = np.full(_ROUGH_POINTS, -0.5 * gear.facewidth)
    return [
        ("helix", middle, z, along_helix, 1),
        ("profile", np.sqrt(arc), half, along_profile, 2),
    ]
