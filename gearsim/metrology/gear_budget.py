"""A gear's error budget: one cause of deviations alone on every line."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

from gearsim.metrology.gear_iso import GearMeasurement, GearProbing
from gearsim.metrology.inspection import Reading, Steps, together
from gearsim.metrology.study import Change, study_steps
from gearsim.surfaces.cylindrical_gear import SIDES

if TYPE_CHECKING:
    from gearsim.metrology.job import Job


@dataclass(frozen=True)
class BudgetLine:
    """One cause of deviations alone: ``cause`` and its ``size`` in words, and what it costs [um, transverse].

    ``parameters`` by the names of ISO 1328-1, the worse side (None: not measured); ``largest_um`` and ``mean_um`` of
    all trace samples; ``runout_um`` F_r (None: not all spaces were cut).
    """

    cause: str
    size: str
    parameters: dict[str, float | None]
    largest_um: float
    mean_um: float
    runout_um: float | None


@dataclass(frozen=True)
class BudgetMeasurement:
    """The lines of an error budget."""

    variant: str
    lines: tuple[BudgetLine, ...]
    surface: str = ""
    inspection: str = "error budget"


@dataclass(frozen=True)
class BudgetInspection:
    """Changes of the ``probing``'s variant, one cause alone each: those seen in space 0, then those of all spaces."""

    probing: GearProbing
    causes: tuple[Change, ...]
    everywhere: tuple[Change, ...]
    name: str = "error budget"

    def steps(self, job: Job) -> Steps[Reading]:
        spaces = {(0,): self.causes, tuple(range(self.probing.probed.gear.count)): self.everywhere}
        studies = [
            study_steps(job, changes, replace(self.probing, spaces=probed).steps) for probed, changes in spaces.items()
        ]
        readings = chain.from_iterable((yield from together(studies)))
        lines = tuple(_line(c, r) for c, r in zip((*self.causes, *self.everywhere), readings, strict=True))
        return Reading((BudgetMeasurement(self.probing.variant, lines),))


def _line(cause: Change, reading: Reading) -> BudgetLine:
    (measured,) = reading.measurements
    assert isinstance(measured, GearMeasurement)
    found = measured.found
    normal = [np.concatenate([t[side].from_design_um.ravel() for t in (found.profile, found.helix)]) for side in SIDES]
    every = np.concatenate(normal)
    whole = len(found.profile["left"].teeth) == found.gear.count
    return BudgetLine(
        cause.name,
        cause.size,
        {row.parameter: _worst(list(row.value_um.values())) for row in found.rows()},
        largest_um=float(np.nanmax(np.abs(every))),
        mean_um=float(np.nanmean(every)),
        runout_um=found.runout.total if whole else None,
    )


def _worst(values: list[float]) -> float | None:
    known = [v for v in values if np.isfinite(v)]
    return max(known, key=abs) if known else None
