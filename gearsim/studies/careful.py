"""Jobs computed together; where a fault of the program stops them, one by one, so that its own job alone is lost."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from gearsim.errors import GearsimError
from gearsim.studies.records import Outcome, Study

Compute = Callable[[Study, Sequence[int], str, int | None], tuple[list[Outcome], dict[str, float]]]


def careful(
    compute: Compute, study: Study, jobs: Sequence[int], device: str = "cpu", cores: int | None = None
) -> tuple[list[Outcome], dict[str, float]]:
    """What ``compute`` makes of jobs; a job on which it raises is an outcome that says so.

    What is wrong with the machine (GearsimError: no such device; OSError) is raised.
    """
    try:
        return compute(study, jobs, device, cores)
    except (GearsimError, OSError):
        raise
    except Exception as error:
        if len(jobs) == 1:
            return [Outcome(jobs[0], "error", error=f"{type(error).__name__}: {error}")], {}
    outcomes, spent = list[Outcome](), dict[str, float]()
    for job in jobs:
        one, seconds = careful(compute, study, [job], device, cores)
        outcomes += one
        for name, s in seconds.items():
            spent[name] = spent.get(name, 0.0) + s
    return outcomes, spent
