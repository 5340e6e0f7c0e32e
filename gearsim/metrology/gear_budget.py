"""A gear's error budget: one cause of deviations alone on every line."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from gearsim.metrology.gear_iso import GearMeasurement
from gearsim.metrology.inspection import Reading, Steps
from gearsim.metrology.study import Change, Line, study_steps
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
    """Causes, each probed by a GearProbing of its own, beside the ``variant`` that is the job's program."""

    variant: str
    causes: tuple[Change, ...]
    name: str = "error budget"

    def steps(self, job: Job) -> Steps[Reading]:
        lines = yield from study_steps(job, self.causes)
        return Reading((BudgetMeasurement(self.variant, tuple(map(_line, lines))),))


def _line(line: Line) -> BudgetLine:
    (measured,) = line.reading.measurements
    assert isinstance(measured, GearMeasurement)
    found = measured.found
    normal = [np.concatenate([t[side].from_design_um.ravel() for t in (found.profile, found.helix)]) for side in SIDES]
    every = np.concatenate(normal)
    whole = len(found.profile["left"].teeth) == found.gear.count
    return BudgetLine(
        line.name,
        line.size,
        {row.parameter: _worst(list(row.value_um.values())) for row in found.rows()},
        largest_um=float(np.nanmax(np.abs(every))),
        mean_um=float(np.nanmean(every)),
        runout_um=found.runout.total if whole else None,
    )


def _worst(values: list[float]) -> float | None:
    known = [v for v in values if np.isfinite(v)]
    return max(known, key=abs) if known else None
