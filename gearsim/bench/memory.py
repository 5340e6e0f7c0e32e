"""Memory of a cut: bytes of its arrays, counted, and the growth of a process that cuts, measured.

Runs in processes of their own (``python -m gearsim.bench.memory``), whose peak no earlier work has raised.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import fields
from time import perf_counter, process_time
from typing import Any, NamedTuple

from gearsim.bench.children import memory_of
from gearsim.bench.workloads import (
    Case,
    about_dexels,
    block_case,
    block_rays,
    flank_job,
    inspections,
    pass_over_dexels,
)
from gearsim.simulation import removal
from gearsim.simulation.removal import SLOT_BYTES, Job, Removal, cut, cut_jobs, tile_rays

SLOTS = 16
TOLERANCE = 1e-6
SMALL_TILE = 1 << 24
BOX_BYTES = 2 * 3 * 4
DEVICE_ROW_BYTES = 2 * 6 * 24 + 3 * 8
COUNTS = {
    "rays": {"small": (50_000, 500_000), "large": (200_000, 2_000_000)},
    "segments": {"small": (5_000, 50_000), "large": (20_000, 200_000)},
    "jobs": {"small": (1_000, 10_000), "large": (10_000, 50_000)},
}


class Peak(NamedTuple):
    """What a process that cut ``rays`` by ``segments`` in ``jobs`` took: bytes at its peak, wall and CPU time [s]."""

    jobs: int
    rays: int
    segments: int
    peak: int
    seconds: float
    cpu_s: float


def arrays_bytes(data: Any) -> int:
    """Bytes of a dataclass's arrays."""
    return sum(getattr(data, f.name).nbytes for f in fields(data))


def ray_bytes(case: Case, done: Removal) -> float:
    """Counted bytes a ray beyond a tile's: the ray, its status, its intervals in the tile's result and in the whole."""
    kept = arrays_bytes(done.removed) + done.ray_status.nbytes
    return (arrays_bytes(case.rays) + 2 * kept) / len(case.rays)


def segment_bytes(case: Case) -> float:
    """Counted bytes a segment: the table and its parts before they are joined, boxes here and there, device copy."""
    return (2 * arrays_bytes(case.table)) / len(case.table) + 2 * BOX_BYTES + DEVICE_ROW_BYTES


def tile_bytes() -> float:
    """Counted bytes of a tile that is full: its interval lists and the device's copy of its rays."""
    return tile_rays(SLOTS) * (SLOTS * SLOT_BYTES + 4 + 64 + 12)


def peak_of(kind: str, count: int, tile: int = SMALL_TILE) -> Peak:
    """Cut ``count`` ``rays``, ``segments``, ``jobs`` or rays through the ``program`` in a process of its own."""
    command = [sys.executable, "-m", "gearsim.bench.memory", kind, str(count), str(tile)]
    with tempfile.TemporaryDirectory() as nowhere:
        done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=nowhere)
    return Peak(**json.loads(done.stdout.splitlines()[-1]))


def growth(kind: str, size: str) -> tuple[float, float]:
    """Measured bytes a ray, segment or job, and what the process takes beside them [bytes]; tiles are kept small."""
    few, many = (peak_of(kind, n) for n in COUNTS[kind][size])
    first, last = getattr(few, kind), getattr(many, kind)
    slope = (many.peak - few.peak) / (last - first)
    return slope, few.peak - slope * first


def _jobs(kind: str, count: int) -> list[Job]:
    if kind == "jobs":
        return inspections(count)
    case = _case(kind, count)
    return [Job(case.rays, case.table, case.cutter)]


def _case(kind: str, count: int) -> Case:
    if kind == "rays":
        return pass_over_dexels()._replace(rays=about_dexels(count))
    if kind == "program":
        job = flank_job()
        return Case("", about_dexels(count), job.program, job.cutter)
    whole = block_case(count / 500_000.0)
    return whole._replace(rays=block_rays(1e-3, 1.0), table=whole.table.part(slice(0, count)))


def _cut(kind: str, count: int, tile: int) -> Peak:
    vars(removal)["TILE_BYTES"] = tile
    jobs = _jobs(kind, count)
    cut(jobs[0].rays.part(slice(0, 1)), jobs[0].table, jobs[0].cutter)  # loads the kernel
    started, cpu = perf_counter(), process_time()
    cut_jobs(jobs, slots=SLOTS, tolerance=TOLERANCE)
    seconds, cpu_s = perf_counter() - started, process_time() - cpu
    rays, segments = (sum(len(part) for part in parts) for parts in ([j.rays for j in jobs], [j.table for j in jobs]))
    return Peak(len(jobs), rays, segments, _peak_bytes(), seconds, cpu_s)


def _peak_bytes() -> int:
    """This process's own peak."""
    return memory_of(os.getpid())[1] or resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024


if __name__ == "__main__":
    print(json.dumps(_cut(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))._asdict()))
