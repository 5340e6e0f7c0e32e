"""Worked examples of which only numbers are printed, beside ours: nothing is cut for them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearsim.gouging.khan.worked import WorkedRow
from gearsim.gouging.khan.worked_sections import worked_rows
from gearsim.metrology.inspection import Reading, Steps

if TYPE_CHECKING:
    from gearsim.metrology.job import Job


@dataclass(frozen=True)
class WorkedMeasurement:
    """Printed numbers beside ours, of the given ``sections``; ``drawn``: their curvatures are drawn, too."""

    sections: tuple[str, ...]
    rows: tuple[WorkedRow, ...]
    drawn: bool
    surface: str = ""
    variant: str = "printed"
    inspection: str = "worked examples"


@dataclass(frozen=True)
class WorkedInspection:
    """The worked examples of some ``sections`` whose names begin with one of ``names`` (none given: all).

    ``alone``: they are all that the job is about; it is judged by there being any.
    """

    sections: tuple[str, ...]
    names: tuple[str, ...]
    alone: bool
    name: str = "worked examples"

    def steps(self, _: Job) -> Steps[Reading]:
        yield []
        rows = tuple(worked_rows(self.sections, self.names))
        found = WorkedMeasurement(self.sections, rows, self.alone)
        differ = sum(not row.agrees for row in rows)
        remarks = (f"{differ} of {len(rows)} printed results do not reproduce",) if differ else ()
        if not self.alone:
            return Reading((found,) if rows else (), remarks=remarks)
        doubts = () if rows else ("reference.sections and reference.names choose no worked example",)
        return Reading((found,), doubts=doubts, judged=("worked examples",) if rows else (), remarks=remarks)
