"""Studies: one question put to a job under one change after another; all changes are cut together.

The convergence series, the error budget, the comparison tools and `processes.run.study` are its users.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

from gearsim.metrology.inspection import Steps, together
from gearsim.simulation.operation import Variant

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

T = TypeVar("T")


@dataclass(frozen=True)
class Change:
    """One line of a study: what is changed and by how much, in words.

    ``variants`` stand in the places of the job's by these names; a name is that of variants that the job has as well.
    """

    name: str
    size: str
    variants: Mapping[str, Variant | str]


def study_steps(job: Job, changes: Sequence[Change], ask: Callable[[Job], Steps[T]]) -> Steps[list[T]]:
    """What ``ask`` finds of the job under each of the changes, in their order; its questions round by round.

    Raises InputError for a place or a variant that the job has not.
    """
    return together([ask(job.under(change.variants)) for change in changes])
