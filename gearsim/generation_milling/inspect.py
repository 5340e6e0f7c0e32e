"""Inspecting a gear that a program cut: traces, pitch, runout and roughness."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.generation_milling.cutting import ProgramCut
from gearsim.generation_milling.job import GearJob
from gearsim.generation_milling.probing import all_rays
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.metrology.deviation import Crossing, Deviation, measure
from gearsim.metrology.gear_inspection import GearInspection
from gearsim.metrology.gear_pitch import pitch_deviations, runout
from gearsim.metrology.gear_traces import GearTraces
from gearsim.metrology.roughness import Roughness, measure_roughness
from gearsim.metrology.samples import window_rays
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side
from gearsim.surfaces.involute import InvoluteFlank

_ROUGH_POINTS = 1001


def inspect(job: GearJob, cut: ProgramCut, title: str) -> GearInspection:
    """Probe the flanks of the job's spaces on both sides."""
    spaces, gear = job.spaces, job.gear
    profile: dict[Side, GearTraces] = {}
    helix: dict[Side, GearTraces] = {}
    points: dict[Side, NDArray] = {}
    bundles = [all_rays(job.probing[side], spaces) for side in SIDES]
    untouched: dict[Side, tuple[int, ...]] = {}
    for side, probed in zip(SIDES, _deviations(cut, bundles), strict=True):
        by_space = probed.reshaped((len(spaces), -1))
        missed = (by_space.crossing == Crossing.UNCUT).all(axis=1)
        untouched[side] = tuple(space for space, is_missed in zip(spaces, missed, strict=True) if is_missed)
        found = job.probing[side].traces(spaces, by_space.value, job.finishing.modification)
        profile[side], helix[side], pitch = found
        points[side] = np.full(gear.count, np.nan)
        points[side][list(spaces)] = pitch
    radius = float(gear.radius(job.probing["left"].pitch_roll))
    pitches = {side: pitch_deviations(gear, side, points[side], radius) for side in SIDES}
    ball = runout(gear, points["left"], points["right"], radius)
    return GearInspection(title, gear, job.scene.metrology.iso_class, profile, helix, pitches, ball, untouched)


def roughness(job: GearJob, cut: ProgramCut) -> dict[str, Roughness]:
    """Roughness of space 0's flanks along the middle helix and the middle profile: the path's part of it alone."""
    lines = {}
    for side in SIDES:
        for name, u, v, way, degree in _rough_lines(job.gear, side, job.reached[side]):
            lines[f"{side} flank, {name}"] = (InvoluteFlank(job.gear, side), u, v, way, degree)
    bundles = [window_rays(f, u, v, f.jet(u, v).normal) for f, u, v, _, _ in lines.values()]
    heights = _deviations(cut, bundles)
    return {
        name: measure_roughness(way, 1e3 * probed.value, degree)
        for (name, (_, _, _, way, degree)), probed in zip(lines.items(), heights, strict=True)
    }


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


def _deviations(cut: ProgramCut, bundles: list[RayBundle]) -> list[Deviation]:
    """Deviations along the rays of several bundles."""
    rays = join_rays(bundles)
    return measure(rays, cut.removed(rays)).split([len(b) for b in bundles])
