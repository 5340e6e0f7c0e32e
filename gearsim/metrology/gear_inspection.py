"""An inspection of a cylindrical gear: its traces and pitches beside the tolerances of ISO 1328-1:2013."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.metrology.gear_pitch import PitchResult, Runout
from gearsim.metrology.gear_traces import GearTraces
from gearsim.metrology.iso1328 import PARAMETERS, GearSize, achieved_class, tolerances_um
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side


@dataclass(frozen=True)
class InspectionRow:
    """One parameter: the largest value of each side [um] (a slope with its sign; nan: not measured) and its class.

    ``tolerance_um`` is that of the class asked for; ``achieved`` the class that both sides keep (None: beyond 11, or
    not measured); ``incomplete`` how many traces or sides could not be evaluated.
    """

    parameter: str
    tolerance_um: float
    value_um: dict[Side, float]
    achieved: int | None
    incomplete: int

    @property
    def within(self) -> bool:
        """Whether everything was evaluated and nothing exceeds the tolerance."""
        return not self.incomplete and all(abs(v) <= self.tolerance_um for v in self.value_um.values())


@dataclass(frozen=True)
class FlankMap:
    """Deviations [um, normal] of one flank on a grid, ``deviation_um`` (r, c), nan where not measured.

    ``position`` (r,): roll lengths [mm] from root to tip; ``z`` (c,) [mm].
    """

    side: Side
    space: int
    position: NDArray[np.floating]
    z: NDArray[np.floating]
    deviation_um: NDArray[np.floating]


@dataclass(frozen=True)
class GearInspection:
    """What was measured of a gear, by side; ``gear_class``: the ISO class asked for.

    ``untouched``: the probed spaces whose flank of a side no cut reaches, from 0.
    """

    title: str
    gear: CylindricalGear
    gear_class: int
    profile: Mapping[Side, GearTraces]
    helix: Mapping[Side, GearTraces]
    pitch: Mapping[Side, PitchResult]
    runout: Runout
    untouched: Mapping[Side, tuple[int, ...]]

    @property
    def size(self) -> GearSize:
        """What the tolerances depend on. Raises InputError outside the standard's scope."""
        return gear_size(self.gear)

    @property
    def tolerances_um(self) -> dict[str, float]:
        return tolerances_um(self.size, self.gear_class)

    def rows(self) -> list[InspectionRow]:
        """All parameters of ISO 1328-1, in the order of ``PARAMETERS``."""
        values, missing = self._values()
        tolerances, size = self.tolerances_um, self.size
        rows = []
        for name in PARAMETERS:
            of_side = {side: largest(values[side][name]) for side in SIDES}
            worst = max(abs(v) for v in of_side.values())
            achieved = None if missing[name] else achieved_class(size, name, worst)
            rows.append(InspectionRow(name, tolerances[name], of_side, achieved, missing[name]))
        return rows

    def _values(self) -> tuple[dict[Side, dict[str, NDArray]], dict[str, int]]:
        """All values of each side by parameter, and how many are missing on both sides together."""
        values: dict[Side, dict[str, NDArray]] = {}
        for side in SIDES:
            pitch = self.pitch[side]
            values[side] = {"f_p": np.array([pitch.single]), "F_p": np.array([pitch.total])}
            for name, traces in (("alpha", self.profile[side]), ("beta", self.helix[side])):
                found = traces.evaluated()
                values[side] |= {f"f_H{name}": found.slope_um, f"f_f{name}": found.form_um, f"F_{name}": found.total_um}
        missing = {n: sum(int(np.isnan(values[side][n]).sum()) for side in SIDES) for n in PARAMETERS}
        return values, missing


def gear_size(gear: CylindricalGear) -> GearSize:
    """What a gear's tolerances depend on. Raises InputError outside the standard's scope."""
    return GearSize(gear.teeth, gear.module, 2.0 * gear.reference_radius, gear.facewidth, gear.helix_angle)


def largest(values: NDArray) -> float:
    """The value of the largest size, with its sign; nan where there is none."""
    known = values[np.isfinite(values)]
    return float(known[np.argmax(np.abs(known))]) if known.size else float("nan")
