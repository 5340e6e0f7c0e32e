"""A stand-in of run_chunk whose jobs are quick, and do what the key ``simulation.interval_slots`` says."""

import os
import signal
import time

import numpy as np

from gearsim.studies.records import Outcome, SurfaceMap

COUNTED = "GEARSIM_TEST_COUNTED"  # the file to which every chunk's first job is written when it is computed
SECONDS = "GEARSIM_TEST_SECONDS"  # that a chunk takes
BAD, FATAL = 13, 66


def fake_chunk(study, jobs, device="cpu", cores=None):
    """Figures and a map from the jobs' values; a job of the value BAD is an error, one of FATAL ends its process."""
    jobs = list(jobs)
    if COUNTED in os.environ:
        with open(os.environ[COUNTED], "a") as file:
            file.write(f"{jobs[0]}\n")
    time.sleep(float(os.environ.get(SECONDS, "0")))
    return [_outcome(study, job) for job in jobs], {"cut_s": 0.0}


def _outcome(study, job):
    value = study.parameters[0].values[job]
    if value == FATAL:
        os.kill(os.getpid(), signal.SIGKILL)
    if value == BAD:
        return Outcome(job, "error", error="the tool does not fit")
    u = np.linspace(0.0, 1.0, 3)
    map_ = np.outer(u, u) * value
    point = np.zeros((3, 3, 3))
    surface = SurfaceMap(map_, np.zeros((3, 3), np.uint8), u, u, point, point + 1.0)
    return Outcome(job, "pass", figures={"convex.max_um": float(map_.max())}, maps={"convex": surface})


def fake_study(count=20, chunk=2, special=()):
    """A study's tables; ``special``: values of its first jobs."""
    values = [*special, *range(100, 100 + count - len(special))]
    return {
        "study": {
            "name": "fake", "scene": "spiral-bevel-flank", "method": "list", "chunk": chunk,
            "set": {"metrology": {"rows": 3, "columns": 3}},
        },
        "vary": [{"key": "simulation.interval_slots", "values": values}],
    }  # fmt: skip


def data(folder):
    """The bytes of a data set's rows and maps; all else in the folder tells of times, too."""
    kept = [folder / "jobs.parquet", *(f for f in (folder / "maps.zarr").rglob("*") if f.is_file())]
    assert len(kept) > 1
    return {file.relative_to(folder).as_posix(): file.read_bytes() for file in kept}
