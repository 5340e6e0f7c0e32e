"""Benchmark suite `scaling`: how time and memory grow with rays, segments and jobs, and what fits a memory."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from statistics import median
from time import perf_counter, process_time
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gearsim.bench.memory import (
    BOX_BYTES,
    DEVICE_ROW_BYTES,
    TOLERANCE,
    growth,
    peak_of,
    ray_bytes,
    segment_bytes,
    tile_bytes,
)
from gearsim.bench.timing import Cuts, timed_cuts
from gearsim.bench.workloads import Case, about_dexels, block_case, flank_job, inspections, normals
from gearsim.simulation.removal import TILE_BYTES, Job, cut, cut_jobs, prepare

RAYS = {"small": (100, 1_000, 10_000, 100_000), "large": (1_000, 10_000, 100_000, 1_000_000)}
SEGMENTS = {"small": (10, 100, 1_000, 10_000), "large": (100, 1_000, 10_000, 100_000)}
JOBS = {"small": (1, 10, 100, 1_000), "large": (10, 100, 1_000, 10_000)}
BLOCK_SHARE = {"small": 0.02, "large": 0.2}
BLOCK_PITCH = {"small": 0.5, "large": 2.0}
BIG_RAYS = 10_000_000
GIGABYTES = (24, 80)
_COLUMNS = ("growth with", "from", "to", "s at most", "exponent", "last decade", "B each", "B each, counted",
            *(f"{head} {gb} GB" for gb in GIGABYTES for head in ("fits", "hours for")))  # fmt: skip


@dataclass(frozen=True)
class Law:
    """Time = ``factor`` size ** ``exponent``, fitted to ``sizes`` and ``seconds``; ``last``: between the last two."""

    sizes: tuple[float, ...]
    seconds: tuple[float, ...]
    exponent: float
    factor: float
    last: float

    def predict(self, size: float) -> float:
        """Seconds at a larger size: from the last one measured, with the last decade's exponent."""
        return float(self.seconds[-1] * (size / self.sizes[-1]) ** self.last)


def fitted(sizes: ArrayLike, seconds: ArrayLike) -> Law:
    """The power law nearest to all points by least squares of logarithms."""
    x, y = np.log(np.asarray(sizes, dtype=float)), np.log(np.asarray(seconds, dtype=float))
    exponent, offset = np.polyfit(x, y, 1)
    last = (y[-1] - y[-2]) / (x[-1] - x[-2])
    return Law(tuple(np.exp(x)), tuple(np.exp(y)), float(exponent), float(np.exp(offset)), float(last))


def scaling(device: str, size: str) -> dict[str, Any]:
    """Time and memory against rays, segments and jobs, with exponents; the largest jobs that 24 and 80 GB hold."""
    prepare(device)
    per_ray, base = growth("rays", size)
    per_segment, _ = growth("segments", size)
    normals_law, cuts = _law(device, cases := _normals(size), "rays")
    rows = [_row("rays, normals", normals_law, per_ray, ray_bytes(cases[-1], cuts.last), base)]
    dexels_law, cuts = _law(device, cases := _dexels(size), "rays")
    rows.append(_row("rays, tri-dexel", dexels_law, per_ray, ray_bytes(cases[-1], cuts.last), base))
    law, _ = _law(device, cases := _segments(size), "segments")
    rows.append(_row("segments, tri-dexel", law, per_segment, segment_bytes(cases[-1]), base))
    rows += _job_rows(device, size)
    report: dict[str, Any] = {"columns": list(_COLUMNS), "rows": rows, "notes": _notes(cases[-1])}
    if size == "large":
        report["big"] = big = _big_run(dexels_law, rows[1]["B each"], base)
        report["notes"].append(_big_note(big))
    return report


def _big_run(law: Law, per_ray: float, base: float) -> dict[str, float]:
    """Ten million tri-dexel rays through the README's program on all cores of the CPU, against the law of one."""
    big = peak_of("program", BIG_RAYS, TILE_BYTES)
    return {
        **big._asdict(),
        "predicted_s": law.predict(big.rays),
        "predicted_peak": base + tile_bytes() + per_ray * big.rays,
    }


def _normals(size: str) -> list[Case]:
    job = flank_job()
    shapes = [(max(2, round((n / 8.0) ** 0.5)), n) for n in RAYS[size]]
    return [Case("", normals(rows, round(n / rows)), job.program, job.cutter) for rows, n in shapes]


def _dexels(size: str) -> list[Case]:
    job = flank_job()
    return [Case("", about_dexels(n), job.program, job.cutter) for n in RAYS[size]]


def _segments(size: str) -> list[Case]:
    whole = block_case(BLOCK_SHARE[size], BLOCK_PITCH[size])
    counts = [min(n, len(whole.table)) for n in SEGMENTS[size]]
    chosen = [np.linspace(0, len(whole.table) - 1, n).astype(int) for n in counts]
    return [whole._replace(table=whole.table.part(rows)) for rows in chosen]


def _law(device: str, cases: list[Case], what: str) -> tuple[Law, Cuts]:
    """Time of one thread (CPU time of the whole call; on CUDA the launch's wall time) against ``what``."""
    cuts = [timed_cuts(device, case, 1, (TOLERANCE,), 3)[0] for case in cases]
    sizes = [len(case.rays if what == "rays" else case.table) for case in cases]
    seconds = [(c.cpu if device == "cpu" else c.wall).median for c in cuts]
    return fitted(sizes, seconds), cuts[-1]


def _job_rows(device: str, size: str) -> list[dict[str, Any]]:
    """Small independent jobs, cut in joint launches and each by a launch of its own."""
    measured, base = growth("jobs", size)
    jobs = inspections(JOBS[size][-1])
    one = Case("", jobs[0].rays, jobs[0].table, jobs[0].cutter)
    done = cut(*jobs[0], device=device, tolerance=TOLERANCE)
    counted = len(one.rays) * ray_bytes(one, done) + len(one.table) * segment_bytes(one)

    def alone(some: Sequence[Job]) -> None:
        for job in some:
            cut(*job, device=device, tolerance=TOLERANCE, threads=1)

    def together(some: Sequence[Job]) -> None:
        cut_jobs(some, device=device, tolerance=TOLERANCE, threads=1)

    laws = [_job_law(device, work, jobs, JOBS[size]) for work in (together, alone)]
    names = ("jobs, joint launches", "jobs, a launch each")
    return [_row(name, law, measured, counted, base) for name, law in zip(names, laws, strict=True)]


def _job_law(device: str, work: Callable[[Sequence[Job]], None], jobs: list[Job], counts: tuple[int, ...]) -> Law:
    """Time of the whole call against the number of jobs; on CUDA wall time, for the launches wait for the host."""
    clock = process_time if device == "cpu" else perf_counter

    def seconds(some: Sequence[Job]) -> float:
        started = clock()
        work(some)
        return clock() - started

    return fitted(counts, [median(seconds(jobs[:n]) for _ in range(3)) for n in counts])


def _row(name: str, law: Law, measured: float, counted: float, base: float) -> dict[str, Any]:
    row = {
        "growth with": name,
        "from": round(law.sizes[0]),
        "to": round(law.sizes[-1]),
        "s at most": law.seconds[-1],
        "exponent": law.exponent,
        "last decade": law.last,
        "B each": measured,
        "B each, counted": counted,
        "law": asdict(law),
    }
    for gb in GIGABYTES:
        fits = (1e9 * gb - base - tile_bytes()) / max(measured, counted)
        row[f"fits {gb} GB"], row[f"hours for {gb} GB"] = round(fits), law.predict(fits) / 3600.0
    return row


def _notes(last: Case) -> list[str]:
    return [
        "Time: CPU time of the whole call on one thread (on CUDA the launch's wall time), medians of 3, to 1e-6 mm; "
        "exponent: least squares of logarithms over all four sizes; last decade: between the two largest. Rays go "
        "through the README's program (276 segments); segments, spread evenly over a block, through "
        f"{len(last.rays):,} rays; a job is 45 rays through 32 segments, the README's flank on an inspector's grid. "
        "hours: one thread, from the largest size measured with the last decade's exponent.",
        "B each: growth of the peak of processes that cut more and more, interval lists kept small; counted: bytes of "
        "the arrays of host and device. fits: what is left of the memory beside the process and a full tile "
        f"of interval lists ({1e-9 * tile_bytes():.2f} GB at most, whatever the number of rays), over the larger of "
        "the two. On CUDA rays pass through tiles, so this is the host's memory; the device's part of a segment is "
        f"{DEVICE_ROW_BYTES + BOX_BYTES} B and its share of the BVH.",
    ]


def _big_note(big: dict[str, float]) -> str:
    return (
        f"Run: {big['rays']:,} tri-dexel rays through {big['segments']:,} segments on all cores in "
        f"{big['seconds']:.0f} s, CPU time {big['cpu_s']:.0f} s (the law says {big['predicted_s']:.0f}), peak "
        f"{1e-9 * big['peak']:.2f} GB (the law says at most {1e-9 * big['predicted_peak']:.2f})."
    )
