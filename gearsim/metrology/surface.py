"""Measuring a surface given in closed form under the motion that generates it and under others."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope import TRIM_TOLERANCE, machined_along
from gearsim.envelope.trim import path_distance
from gearsim.geometry.rays import RayBundle
from gearsim.metrology.bevel import Convergence, FlankMotion
from gearsim.metrology.deviation import Crossing, Deviation
from gearsim.metrology.machine import MeasuringMachine
from gearsim.metrology.roads import RoadGap, road_gap
from gearsim.metrology.samples import SampleGrid


@dataclass(frozen=True)
class SurfaceResult:
    """One surface on its dense grid; what lies in dictionaries goes by the motions' names.

    ``missing``: no such point (the envelope does not exist there); ``trimmed``: the generating motion itself
    cuts deeper there with another pose. Both of shape (rows, columns); such samples are not measured.
    """

    grid: SampleGrid
    missing: NDArray[np.bool_]
    trimmed: NDArray[np.bool_]
    deviations: dict[str, Deviation]
    gaps: dict[str, RoadGap]
    convergence: dict[str, Convergence]

    @property
    def measurable(self) -> NDArray:
        """Samples that lie on the machined surface of the generating motion, shape (rows, columns)."""
        return ~(self.missing | self.trimmed)


def measure_surface(
    machine: MeasuringMachine, grid: SampleGrid, generating: FlankMotion, motions: Mapping[str, FlankMotion]
) -> SurfaceResult:
    """Measure one surface under every motion by both roads; ``generating`` says which samples are trimmed."""
    missing = ~np.isfinite(grid.point[..., 0])
    trimmed = np.zeros(grid.shape, dtype=bool)
    trimmed[~missing] = least_distance(machine.cutter, generating, grid.point[~missing]) < -TRIM_TOLERANCE
    result = SurfaceResult(grid, missing, trimmed, {}, {}, {})
    rays = surface_rays(result)
    for name, motion in motions.items():
        measured = machine.measure([rays], motion.table)[0]
        result.deviations[name] = _spread(measured, result.measurable)
        road = machined_along(rays, motion.sources, machine.cutter)
        machine.progress(len(rays))
        result.gaps[name] = road_gap(road, measured)
    return result


def surface_rays(surface: SurfaceResult) -> RayBundle:
    """Rays along the normals of the measurable samples."""
    return surface.grid.rays().part(surface.measurable.ravel())


def least_distance(cutter: Profile, motion: FlankMotion, points: NDArray) -> NDArray:
    """Least signed distance [mm] of points, shape (n, 3), to the cutter over a motion."""
    return np.min([path_distance(source, cutter, points) for source in motion.sources], axis=0)


def _spread(part: Deviation, where: NDArray) -> Deviation:
    """Deviations of the chosen samples on the whole grid; the others are ABSENT."""

    def spread(values: NDArray, rest: float) -> NDArray:
        out = np.full(where.shape, rest, dtype=values.dtype)
        out[where] = values
        return out

    return Deviation(
        spread(part.value, np.nan), spread(part.crossing, Crossing.ABSENT), spread(part.segment, -1),
        spread(part.multiple, False),
    )  # fmt: skip
