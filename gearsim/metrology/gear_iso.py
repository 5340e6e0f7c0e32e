"""A cylindrical gear inspected after ISO 1328-1: the flanks of its spaces probed under one variant."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.deviation import Crossing, Deviation, measure
from gearsim.metrology.findings import Finding
from gearsim.metrology.gear_inspection import GearInspection
from gearsim.metrology.gear_pitch import pitch_deviations, runout
from gearsim.metrology.gear_probing import Probing, all_rays, probing
from gearsim.metrology.gear_traces import GearTraces
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.involute import InvoluteFlank

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

NAME = "ISO 1328-1"


@dataclass(frozen=True)
class GearMeasurement:
    """Traces, pitches and runout of a gear under a variant."""

    variant: str
    found: GearInspection
    surface: str = ""
    inspection: str = NAME


@dataclass(frozen=True)
class ProbedGear:
    """A gear, the rolls [rad] at root and tip between which each side is probed, and its designed deviations."""

    gear: CylindricalGear
    reached: Mapping[Side, tuple[float, float]]
    design: FlankModification | None = None

    def place(self, side: Side, height: float) -> tuple[float, float, float]:
        """A point [mm] at a height, 0 root to 1 tip, in the middle of a flank of space 0."""
        root, tip = self.reached[side]
        x, y, z = InvoluteFlank(self.gear, side).jet(root + height * (tip - root), -0.5 * self.gear.facewidth).r
        return float(x), float(y), float(z)


@dataclass(frozen=True)
class GearProbing:
    """Profile and helix traces of ``points`` each, and pitch points, in some ``spaces`` under one variant.

    ``gear_class``: the class of ISO 1328-1 asked for; pitches are held against it only where all spaces are probed.
    """

    variant: str
    probed: ProbedGear
    spaces: tuple[int, ...]
    points: int
    gear_class: int
    title: str
    name: str = NAME

    def steps(self, job: Job) -> Steps[Reading]:
        lines = {side: probing(self.probed.gear, side, self.probed.reached[side], self.points) for side in SIDES}
        bundles = [all_rays(lines[side], self.spaces) for side in SIDES]
        variant = job.variant(self.variant)
        removed = yield [Cut(rays, variant) for rays in bundles]
        deviations = {
            side: measure(rays, cut) for side, rays, cut in zip(SIDES, bundles, removed, strict=True)
        }  # fmt: skip
        found = self._read(lines, deviations)
        doubts = tuple(_untouched(side, found.untouched[side]) for side in SIDES if found.untouched[side])
        findings = tuple(self._beyond_class(found))
        return Reading((GearMeasurement(self.variant, found),), findings, doubts, (), tuple(self._remarks()))

    def _remarks(self) -> Iterator[str]:
        count, probed = self.probed.gear.count, len(self.spaces)
        if probed < count:
            yield f"{probed} of {count} spaces were probed, pitch was not judged"
        if probed > 1:
            yield f"both roads measured space 1, one road alone the other {probed - 1} that were probed"

    def _read(self, lines: Mapping[Side, Probing], deviations: Mapping[Side, Deviation]) -> GearInspection:
        spaces, gear = self.spaces, self.probed.gear
        profile: dict[Side, GearTraces] = {}
        helix: dict[Side, GearTraces] = {}
        points: dict[Side, NDArray] = {}
        untouched: dict[Side, tuple[int, ...]] = {}
        for side, probed in deviations.items():
            by_space = probed.reshaped((len(spaces), -1))
            missed = (by_space.crossing == Crossing.UNCUT).all(axis=1)
            untouched[side] = tuple(space for space, is_missed in zip(spaces, missed, strict=True) if is_missed)
            profile[side], helix[side], pitch = lines[side].traces(spaces, by_space.value, self.probed.design)
            points[side] = np.full(gear.count, np.nan)
            points[side][list(spaces)] = pitch
        radius = float(gear.radius(lines["left"].pitch_roll))
        pitches = {side: pitch_deviations(gear, side, points[side], radius) for side in SIDES}
        ball = runout(gear, points["left"], points["right"], radius)
        return GearInspection(self.title, gear, self.gear_class, profile, helix, pitches, ball, untouched)

    def _beyond_class(self, found: GearInspection) -> Iterator[Finding]:
        whole = len(self.spaces) == self.probed.gear.count
        for row in found.rows():
            if row.within or (row.parameter in ("f_p", "F_p") and not whole):
                continue
            worst = max((v for v in row.value_um.values() if np.isfinite(v)), key=abs, default=None)
            what = f"{row.incomplete} traces incomplete" if row.incomplete else f"{worst:.3g} um"
            text = f"{row.parameter} is beyond class {found.gear_class} ({row.tolerance_um:g} um): {what}"
            yield Finding("beyond_class", "left", worst, self.probed.place("left", 0.5), None, None, True, text)


def _untouched(side: Side, spaces: tuple[int, ...]) -> str:
    numbers = ", ".join(str(space + 1) for space in spaces)
    where = f"space{'s' * (len(spaces) > 1)} {numbers}"
    return f"no operation touches the {side} flank of {where}: nothing of it was judged"
