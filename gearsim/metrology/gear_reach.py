"""What of a gear's involute a cutter can generate, and roots that it deepens: told before anything is cut."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import degrees
from typing import TYPE_CHECKING

from gearsim.metrology.findings import Finding
from gearsim.metrology.gear_iso import ProbedGear
from gearsim.metrology.inspection import Reading, Steps
from gearsim.surfaces.cylindrical_gear import SIDES, Side
from gearsim.surfaces.tool_access import tool_reach

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_DEEPER_MM = 1e-3


@dataclass(frozen=True)
class ReachMeasurement:
    """A gear with what of each side is generated over the whole facewidth; nothing was cut for it."""

    variant: str
    probed: ProbedGear
    surface: str = ""
    inspection: str = "reach"


@dataclass(frozen=True)
class ReachInspection:
    """What a cylindrical cutter of a ``diameter`` [mm] generates under a variant."""

    variant: str
    probed: ProbedGear
    diameter: float
    name: str = "reach"

    def steps(self, _: Job) -> Steps[Reading]:
        yield []
        findings = tuple(f for side in SIDES for f in self._of(side))
        return Reading((ReachMeasurement(self.variant, self.probed),), findings)

    def _of(self, side: Side) -> Iterator[Finding]:
        """The part of the involute that the tool cannot generate, and roots it deepens."""
        gear, (root, tip) = self.probed.gear, self.probed.reached[side]
        place = self.probed.place(side, 0.0)
        if abs(root - gear.root_roll) > 1e-9 or abs(tip - gear.tip_roll) > 1e-9:
            radii = f"R {gear.radius(root):.3f} to {gear.radius(tip):.3f} mm"
            text = (
                f"the tool of {self.diameter:g} mm generates the {side} flank over the whole facewidth from roll "
                f"{degrees(root):.3f} to {degrees(tip):.3f} deg ({radii}); the involute goes from "
                f"{degrees(gear.root_roll):.3f} to {degrees(gear.tip_roll):.3f} deg"
            )
            yield Finding("not_reached", side, None, place, None, None, False, text)
        deepest = float(tool_reach(gear, root, 0.5 * self.diameter))
        deeper = gear.sign * (gear.root_radius - deepest)
        if deeper > _DEEPER_MM:
            text = f"finishing the {side} flank to its root end deepens the root circle by {deeper:.3f} mm"
            yield Finding("root_deepened", side, None, place, None, None, False, text)
