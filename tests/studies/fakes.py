"""A stand-in of run_chunk whose jobs are quick, and do what the key ``simulation.interval_slots`` says."""

import os
import time
from pathlib import Path

import numpy as np

from gearsim.studies.records import Outcome, SurfaceMap

FAKE = "tests.studies.fakes:fake_chunk"
SECONDS = 0.1  # that a chunk takes whose study is counted
BAD, RAISES = 13, 66


def fake_chunk(study, jobs, device="cpu", cores=None):
    """Figures and a map from the jobs' values; a job of the value BAD is an error, one of RAISES is a fault.

    The study's summary names the file in which chunks are counted.
    """
    jobs = list(jobs)
    if study.summary:
        with Path(study.summary).open("a") as file:
            file.write(f"{jobs[0]} {os.getpid()}\n")
        time.sleep(SECONDS)
    return [_outcome(study, job) for job in jobs], {"cut_s": 0.0}


def _outcome(study, job):
    value = study.parameters[0].values[job]
    if value == RAISES:
        raise RuntimeError("nobody has thought of this")
    if value == BAD:
        return Outcome(job, "error", error="the tool does not fit")
    u = np.linspace(0.0, 1.0, 3)
    map_ = np.outer(u, u) * value
    point = np.zeros((3, 3, 3))
    surface = SurfaceMap(map_, np.zeros((3, 3), np.uint8), u, u, point, point + 1.0)
    return Outcome(job, "pass", figures={"convex.max_um": float(map_.max())}, maps={"convex": surface})


def fake_study(count=20, chunk=2, special=(), counted=None):
    """A study's tables; ``special``: values of its first jobs.

    ``counted``: a file in which every chunk that is begun has a line, its first job and its process.
    """
    values = [*special, *range(100, 100 + count - len(special))]
    return {
        "study": {
            "name": "fake", "scene": "spiral-bevel-flank", "method": "list", "chunk": chunk,
            "summary": str(counted or ""),
            "set": {"metrology": {"rows": 3, "columns": 3}},
        },
        "vary": [{"key": "simulation.interval_slots", "values": values}],
    }  # fmt: skip


def data(folder):
    """The bytes of a data set's rows and maps; all else in the folder tells of times, too."""
    kept = [folder / "jobs.parquet", *(f for f in (folder / "maps.zarr").rglob("*") if f.is_file())]
    assert len(kept) > 1
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in kept}
