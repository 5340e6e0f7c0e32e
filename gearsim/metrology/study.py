"""Studies: the same inspections under one change after another, as one table; all changes are cut together."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearsim.metrology.inspection import Inspection, Reading, Steps, together

if TYPE_CHECKING:
    from gearsim.metrology.job import Job


@dataclass(frozen=True)
class Change:
    """One line of a study: what is changed and by how much, in words, and the inspection that sees what it does."""

    name: str
    size: str
    inspection: Inspection


@dataclass(frozen=True)
class Line:
    """One change of a study with what its inspection read."""

    name: str
    size: str
    reading: Reading


def study_steps(job: Job, changes: Sequence[Change]) -> Steps[list[Line]]:
    """The questions of all changes' inspections, round by round; returns the table's lines.

    Findings and doubts stay in the lines: what is changed on purpose judges nothing.
    """
    readings = yield from together([change.inspection.steps(job) for change in changes])
    return [Line(c.name, c.size, reading) for c, reading in zip(changes, readings, strict=True)]
