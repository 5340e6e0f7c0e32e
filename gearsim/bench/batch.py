"""Benchmark suite `batch`: jobs of studies beside runs of the same scenes, in one process and by Dask's workers."""

from __future__ import annotations

import resource
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter, process_time
from typing import Any

from gearsim.processes.run import run
from gearsim.scene.loading import check_scene
from gearsim.studies.chunk import tables_of
from gearsim.studies.progress import Silent
from gearsim.studies.reading import read_study
from gearsim.studies.records import Study
from gearsim.studies.run import study

_COLUMNS = ("case", "jobs", "CPU s a job", "wall s a job", "run CPU s", "ratio", "goal", "peak MB")
_MAPS = {
    "study": {
        "name": "maps", "scene": "spiral-bevel-flank", "method": "latin-hypercube", "samples": 1000, "seed": 1,
        "measure": ["maps"], "cross_checked": 0.0,
        "set": {"metrology": {"rows": 32, "columns": 64}},
    },
    "vary": [
        {"key": "cutter.taper_deg", "low": 14.9, "high": 15.1},
        {"key": "cutter.bottom_radius_mm", "low": 0.97, "high": 1.03},
        {"key": "toolpath.run_mm", "low": 7.0, "high": 9.0},
        {"key": "toolpath.points", "values": list(range(40, 91))},
    ],
}  # fmt: skip
_FEW = {"small": {"maps": 96, "gears": 24}, "large": {"maps": 1000, "gears": 1000}}
_GOALS = {"maps": 150, "gears": 100}


def batch(device: str, size: str) -> dict[str, Any]:
    """A study of maps and a study of gears on machines with errors, each beside a run of its scene; two workers."""
    counts = _FEW[size]
    rows = []
    for name, source in (("maps", _MAPS), ("gears", "machine-errors")):
        whole = read_study(source, overrides=(f"study.samples={counts[name]}",))
        asked = replace(whole, asked=replace(whole.asked, cross_checked=0.0))
        rows.append(_beside_a_run(name, asked, device))
    one, two = _workers(read_study(_MAPS, overrides=(f"study.samples={2 * counts['maps']}",)))
    row = dict.fromkeys(_COLUMNS, None) | {"case": "two Dask workers of one core over one process", "goal": 0.9}
    rows.append(row | {"jobs": 2 * counts["maps"], "wall s a job": two, "ratio": one / two})
    return {"columns": list(_COLUMNS), "rows": rows, "notes": list(_NOTES)}


_NOTES = (
    "maps: 32 x 64 deviations of both flanks of spiral-bevel-flank, cutter and path another in each job, by the "
    "removal road alone, the data set written, no summary.html. gears: helical-external on machines of twelve errors, "
    "maps and ISO traces of one space. Beside each, gearsim.run of the study's first job in this process, warm, "
    "nothing written: all that a run measures. ratio: of CPU time, the run's over a job's.",
    "two Dask workers: wall time of one process of all cores over that of two workers of one core each, from when the "
    "first chunk is done to the end: the workers' start is left out.",
)


def _beside_a_run(case: str, jobs: Study, device: str) -> dict[str, Any]:
    """A study beside a run of its first job, in turns: run, study, run; the run's less CPU time of the two."""
    of_run = [_cpu(lambda: _run(jobs, device))[0]]
    with TemporaryDirectory() as folder:
        study(replace(jobs, parameters=_first(jobs, 1)), Path(folder) / "warm", device=device, summary=False)
        cpu, wall = _cpu(lambda: study(jobs, Path(folder) / "study", device=device, summary=False))
    of_run.append(_cpu(lambda: _run(jobs, device))[0])
    a_job, a_run = cpu / len(jobs), min(of_run)
    return {
        "case": case,
        "jobs": len(jobs),
        "CPU s a job": a_job,
        "wall s a job": wall / len(jobs),
        "run CPU s": a_run,
        "ratio": a_run / a_job,
        "goal": _GOALS[case],
        "peak MB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }


def _run(jobs: Study, device: str) -> None:
    run(check_scene(tables_of(jobs, 0), jobs.name), device=device, folder=jobs.folder)


def _first(jobs: Study, count: int) -> tuple[Any, ...]:
    return tuple(replace(p, values=p.values[:count]) for p in jobs.parameters)


def _cpu(work: Callable[[], object]) -> tuple[float, float]:
    """CPU and wall seconds of some work in this process."""
    cpu, wall = process_time(), perf_counter()
    work()
    return process_time() - cpu, perf_counter() - wall


def _workers(jobs: Study) -> tuple[float, float]:
    """Wall seconds a job in one process of all cores, and in two workers of one core each."""
    found = []
    for workers in (None, 2):
        with TemporaryDirectory() as folder:
            clock = _Clock()
            study(jobs, Path(folder), workers=workers, progress=clock, summary=False)
            found.append((perf_counter() - clock.started) / (len(jobs) - jobs.chunk))
    return found[0], found[1]


class _Clock(Silent):
    """Starts when the first chunk is done: from there on all workers are at work."""

    started = 0.0

    def advance(self, jobs: int, verdicts: Mapping[str, int]) -> None:
        self.started = self.started or perf_counter()
