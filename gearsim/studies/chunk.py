"""A chunk of a study's jobs: planned beside each other, cut in one launch, each read by itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import deepcopy
from time import perf_counter
from typing import Any, NamedTuple

import numpy as np

from gearsim.errors import GearsimError
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.gear_iso import GearMeasurement
from gearsim.metrology.grid import GridMeasurement
from gearsim.metrology.inspection import Reading
from gearsim.metrology.job import Job
from gearsim.metrology.verdict import NOT_COMPARED, verdict
from gearsim.processes.brief import Brief, Planned, mapped
from gearsim.processes.many import plan_many
from gearsim.processes.run import plan
from gearsim.scene import Scene
from gearsim.scene.keys import put
from gearsim.scene.loading import scene_of
from gearsim.simulation.removal import prepare
from gearsim.studies.performing import Done, performed
from gearsim.studies.records import Outcome, Study, SurfaceMap

_ONE_ROAD = "the envelope road was left out"
_NOTHING = "nothing was measured: this scene has nothing that study.measure asks for; cross-checked jobs are judged"


def run_chunk(
    study: Study, jobs: Sequence[int], device: str = "cpu", cores: int | None = None
) -> tuple[list[Outcome], dict[str, float]]:
    """What comes of some of a study's jobs, in their order, and the seconds that planning and measuring took.

    A job that cannot be done is an outcome that says why. ``cores``: CPU threads that cut (default: all).
    """
    return measure_chunk(study, jobs, plan_chunk(study, jobs), device, cores)


class PlannedChunk(NamedTuple):
    """A chunk's jobs, or why there is none, and the seconds that planning them took."""

    jobs: list[Planned | GearsimError]
    seconds: float


def plan_chunk(study: Study, jobs: Sequence[int]) -> PlannedChunk:
    """Plan some of a study's jobs; nothing is cut."""
    started = perf_counter()
    both, scenes = study.cross_checked, [_scene(study, job) for job in jobs]
    planned = _planned(study, scenes, [bool(both[job]) for job in jobs])
    return PlannedChunk(planned, perf_counter() - started)


def measure_chunk(
    study: Study, jobs: Sequence[int], planned: PlannedChunk, device: str = "cpu", cores: int | None = None
) -> tuple[list[Outcome], dict[str, float]]:  # fmt: skip
    """What comes of jobs that are planned; as ``run_chunk``."""
    started, both = perf_counter(), study.cross_checked
    prepare(device)
    found = performed(planned.jobs, device, cores)
    outcomes = [_outcome(study, job, done, bool(both[job])) for job, done in zip(jobs, found, strict=True)]
    return outcomes, {"plan_s": planned.seconds, "cut_s": perf_counter() - started}


def tables_of(study: Study, job: int) -> dict[str, Any]:
    """A job's scene as nested plain tables: the study's, with the job's values at their keys."""
    tables = deepcopy(dict(study.tables))
    for key, value in study.values_of(job).items():
        put(tables, key, value)
    return tables


def _scene(study: Study, job: int) -> Scene | GearsimError:
    try:
        return scene_of(tables_of(study, job), study.name)
    except GearsimError as error:
        return error


def _planned(
    study: Study, scenes: Sequence[Scene | GearsimError], both: Sequence[bool]
) -> list[Planned | GearsimError]:
    """Jobs of scenes: whole ones where both roads are asked, what the study asks for of the others."""
    brief = Brief("maps" in study.asked.measure, "iso" in study.asked.measure)
    few = {i: s for i, s in enumerate(scenes) if isinstance(s, Scene) and not both[i]}
    short = dict(zip(few, plan_many(list(few.values()), study.folder, brief), strict=True))
    out: list[Planned | GearsimError] = []
    for i, scene in enumerate(scenes):
        if isinstance(scene, GearsimError):
            out.append(scene)
        else:
            out.append(short[i] if i in short else _whole(scene, study))
    return out


def _whole(scene: Scene, study: Study) -> Planned | GearsimError:
    try:
        return Planned(plan(scene, study.folder))
    except GearsimError as error:
        return error


def _outcome(study: Study, job: int, done: Done | GearsimError, both: bool) -> Outcome:
    if isinstance(done, GearsimError):
        return Outcome(job, "error", error=_placeless(str(done), study))
    (planned, found), figures = done, dict[str, Any]()
    maps = _maps(planned, found)
    for surface, m in maps.items():
        figures |= {f"{surface}.{name}": value for name, value in _summary(m.deviation).items()}
    for reading in found:
        for gear in (m for m in reading.measurements if isinstance(m, GearMeasurement)):
            figures |= _iso(gear)
    judged, status = verdict(planned.part, found)
    if not both:
        doubts = [d for r in found for d in r.doubts if not d.startswith(NOT_COMPARED)]
        unmeasured = [] if found else [_NOTHING]
        judged, status = "unchecked", "; ".join([_ONE_ROAD, *unmeasured, *dict.fromkeys(doubts)])
    failing = any(f.fails for reading in found for f in reading.findings)
    figures["within_tolerance"] = not failing if found else None
    wanted = maps if "maps" in study.asked.measure else {}
    return Outcome(job, judged, status, "", both, figures, {s: _map(m) for s, m in wanted.items()})


def _placeless(text: str, study: Study) -> str:
    """A message with the scene's files as the scene names them: data sets tell no place on one machine."""
    return text.replace(f"{study.folder}/", "")


def _maps(job: Job, readings: Sequence[Reading]) -> dict[str, GridMeasurement]:
    """The measurement that maps each surface."""
    out: dict[str, GridMeasurement] = {}
    for inspection, reading in zip(job.inspections, readings, strict=True):
        if variant := mapped(inspection, job.main):
            grids = (m for m in reading.measurements if isinstance(m, GridMeasurement))
            out |= {m.surface: m for m in grids if m.variant == variant}
    return out


def _map(m: GridMeasurement) -> SurfaceMap:
    grid = m.grid
    deviation = 1e3 * m.deviation.value
    return SurfaceMap(
        deviation, m.deviation.crossing.astype(np.uint8), grid.height, grid.length, grid.point, grid.normal
    )


def _summary(deviation: Deviation) -> dict[str, Any]:
    """The figures' names carry their unit where they have one."""
    plain = deviation.summary_um()
    return {name if name in ("samples", "uncut", "through") else f"{name}_um": v for name, v in plain.items()}


def _iso(m: GearMeasurement) -> Mapping[str, Any]:
    out: dict[str, Any] = {}
    for row in m.found.rows():
        out |= {f"iso.{row.parameter}.{side}_um": value for side, value in row.value_um.items()}
        out |= {f"iso.{row.parameter}.class": row.achieved}
    return out
