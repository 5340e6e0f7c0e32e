"""A cylindrical gear after cutting: the box around a space, what stands in it, and a transverse section of it all."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import ceil, sin
from typing import TYPE_CHECKING

import numpy as np

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import Rigid
from gearsim.metrology.dexel_check import DexelInspection, DexelMeasurement
from gearsim.metrology.findings import Finding
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.section import Section, section
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side
from gearsim.toolpaths.counts import check_count

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_AROUND = 1.0
_DEEPER_MM = 1e-3
_CLEAR_MM = 0.05


@dataclass(frozen=True)
class SectionMeasurement:
    """A transverse section of the whole part under a variant."""

    variant: str
    section: Section
    surface: str = ""
    inspection: str = "transverse section"


@dataclass(frozen=True)
class SectionInspection:
    """What a variant leaves of the part's stock along parallel rays in one plane."""

    variant: str
    rays: RayBundle
    name: str = "transverse section"

    def steps(self, job: Job) -> Steps[Reading]:
        assert job.part.stock is not None
        (removed,) = yield [Cut(self.rays, job.variant(self.variant))]
        return Reading((SectionMeasurement(self.variant, section(self.rays, job.part.stock, removed)),))


@dataclass(frozen=True)
class SpaceInspection:
    """The tri-dexel of space 0, and whether material stands in it between the rolls ``reached`` [rad] of both sides."""

    dexels: DexelInspection
    gear: CylindricalGear
    reached: dict[Side, tuple[float, float]]
    name: str = "tri-dexel"

    def steps(self, job: Job) -> Steps[Reading]:
        reading = yield from self.dexels.steps(job)
        return replace(reading, findings=(*reading.findings, *self._left(reading.measurements[0])))

    def _left(self, found: DexelMeasurement) -> list[Finding]:
        """Material between the flanks where both are generated, as the dexels along the axis find it."""
        gear, bundle = self.gear, found.bundles[2]
        x, y, _ = bundle.rays.origin.T
        radius, angle = np.hypot(x, y), np.arctan2(y, x)
        low, high = (gear.radius([of(ends) for ends in self.reached.values()]) for of in (min, max))
        between = np.flatnonzero((radius > low.max()) & (radius < high.min()))
        middle = gear.space_centre(0, np.array([0.0, -gear.facewidth]))
        off = np.abs(angle[between, None] - middle).max(axis=1)
        inside = between[off < gear.half_space(radius[between]) - _CLEAR_MM / radius[between]]
        left = np.zeros(len(radius))
        np.add.at(left, bundle.left.ray, bundle.left.hi - bundle.left.lo)
        worst = inside[np.argmax(left[inside])] if len(inside) else 0
        if not len(inside) or left[worst] < _DEEPER_MM:
            return []
        mine = np.flatnonzero(bundle.left.ray == worst)
        longest = mine[np.argmax(bundle.left.hi[mine] - bundle.left.lo[mine])]
        along = 0.5 * (bundle.left.lo[longest] + bundle.left.hi[longest])
        px, py, pz = bundle.rays.origin[worst] + along * bundle.rays.direction[worst]
        place = (float(px), float(py), float(pz))
        text = f"material stands in space 1, up to {left[worst]:.3f} mm along the axis"
        return [Finding("left_in_space", "space", None, place, None, None, True, text)]


def space_box(gear: CylindricalGear, pitch: float) -> DexelBox:
    """The box around space 0, some of its teeth on both sides."""
    inner, outer = sorted((gear.root_radius, gear.tip_radius))
    middle = np.linspace(0.0, -gear.facewidth, 9)
    sweep = float(np.abs(gear.space_centre(0, middle)).max()) + 0.75 * gear.pitch_angle
    side = outer * sin(min(sweep, 1.5))
    lower = np.array([0.9 * inner - _AROUND, -side, -gear.facewidth - _AROUND])
    return DexelBox(Rigid(np.eye(3), np.zeros(3)), lower, np.array([outer + _AROUND, side, _AROUND]), pitch)


def section_rays(gear: CylindricalGear, rim: float, pitch: float) -> RayBundle:
    """Rays along x through the whole gear at half its facewidth. Raises InputError where there would be too many."""
    radius = max(gear.tip_radius, gear.root_radius + rim * gear.is_internal) + _AROUND
    check_count(2.0 * radius, pitch, what="section_pitch_mm")
    count = ceil(2.0 * radius / pitch)
    y = radius * (2.0 * (np.arange(count) + 0.5) / count - 1.0)
    origin = np.stack([np.full(count, -radius), y, np.full(count, -0.5 * gear.facewidth)], axis=1)
    return RayBundle(origin, np.tile([1.0, 0.0, 0.0], (count, 1)), np.zeros(count), np.full(count, 2.0 * radius))
