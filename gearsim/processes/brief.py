"""Jobs of which only some figures are wanted, as studies do: the fewest questions that give them, by one road."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, replace
from math import inf

from gearsim.metrology.gear_iso import GearProbing
from gearsim.metrology.grid import DENSE, GridInspection
from gearsim.metrology.inspection import Inspection
from gearsim.metrology.job import Job


@dataclass(frozen=True)
class Brief:
    """What is wanted of a job: ``maps`` of its judged surfaces under the whole program, a gear's ``iso`` traces."""

    maps: bool = True
    iso: bool = False


@dataclass(frozen=True)
class Planned:
    """A job. Where a deviation [mm] that it measures is not ``within`` this, the job that ``whole`` makes tells it."""

    job: Job
    within: float = inf
    whole: Callable[[], Job] | None = None


def shortened(job: Job, brief: Brief) -> Job:
    """The job with the inspections that are wanted alone, asked by the removal road alone; nothing can pass by it."""
    asked = tuple(kept(job.inspections, job.main, brief))
    names = {name for i in asked for name in _variants(i)}
    return replace(
        job, inspections=asked, variants=tuple(v for v in job.variants if v.name in names), scene={}, files={}
    )


def mapped(inspection: Inspection, main: str) -> str:
    """The variant under which an inspection makes the map of its surface; empty where it makes none."""
    if not isinstance(inspection, GridInspection) or inspection.name != DENSE:
        return ""
    return main if main in inspection.variants else next(iter(inspection.judged), "")


def kept(inspections: Iterable[Inspection], main: str, brief: Brief) -> Iterator[Inspection]:
    """Those of a job's inspections that are wanted; ``main`` is its whole program."""
    for inspection in inspections:
        if brief.maps and isinstance(inspection, GridInspection) and (variant := mapped(inspection, main)):
            yield one_road(inspection, variant)
        elif brief.iso and isinstance(inspection, GearProbing):
            yield inspection


def one_road(grid: GridInspection, variant: str) -> GridInspection:
    """A surface's grid under a ``variant`` and those that are judged, by the removal road alone."""
    asked = tuple(dict.fromkeys((variant, *grid.judged)))
    judged = grid.judged or (variant,)
    return replace(grid, variants=asked, witnessed=(), judged=judged, strangers="", series=(), last="")


def _variants(inspection: Inspection) -> set[str]:
    if isinstance(inspection, GearProbing):
        return {inspection.variant}
    assert isinstance(inspection, GridInspection)
    return {*inspection.variants, inspection.generating} - {""}
