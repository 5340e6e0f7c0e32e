"""Benchmark suite `removal`: rays through motions, with their distance from the device's ceilings."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from gearsim.bench.ceiling import ceiling
from gearsim.bench.counting import key, poses_evaluated
from gearsim.bench.roofline import COLUMNS, roofline
from gearsim.bench.timing import REPEATS, Cuts, timed_cuts, timed_row
from gearsim.bench.workloads import Case, base_cases, block_case, flank_job, normals
from gearsim.simulation.removal import prepare

TOLERANCES = (1e-6, 1e-9)
_HEADS = ("case", "mm", "threads", "rays", "segments", "seconds", "spread", "krays/s", "Mcand/s", "Mpairs/s",
          "speed-up", *COLUMNS)  # fmt: skip
_RAY_SHAPES = {
    "small": ((2, 5), (5, 20), (10, 100), (25, 400)),
    "large": ((5, 20), (10, 100), (25, 400), (50, 2000)),
}
_SEGMENTS = (10, 100, 1000, 10_000)
_BLOCK_SHARE = {"small": 0.02, "large": 0.08}
_BLOCK_PITCH = 1.0


def removal(device: str, size: str) -> dict[str, Any]:
    """The removal road: normals, a tri-dexel and a ring-shaped head; rays and segments over three decades."""
    prepare(device)
    poses = poses_evaluated(device, TOLERANCES)
    rows = []
    for case in base_cases():
        rows += _rows(device, case, 3 if size == "small" else REPEATS, poses)
    for case in [*ray_decades(size), *segment_decades(size)]:
        rows += _rows(device, case, 3, {})
    return {"columns": list(_HEADS), "rows": rows, "ceiling": ceiling(device)._asdict(), "notes": _notes(device)}


def ray_decades(size: str) -> list[Case]:
    """Three decades of rays along one flank's normals through the README's program."""
    job = flank_job()
    return [Case("more rays, normals", normals(*shape), job.program, job.cutter) for shape in _RAY_SHAPES[size]]


def segment_decades(size: str) -> list[Case]:
    """Three decades of segments, spread evenly over a block, through one tri-dexel."""
    whole = block_case(_BLOCK_SHARE[size], _BLOCK_PITCH)
    cases = []
    for n in _SEGMENTS:
        chosen = np.linspace(0, len(whole.table) - 1, min(n, len(whole.table))).astype(int)
        cases.append(whole._replace(name="more segments, tri-dexel", table=whole.table.part(chosen)))
    return cases


def _rows(device: str, case: Case, repeats: int, poses: dict[str, int]) -> list[dict[str, Any]]:
    """A case to every tolerance on one and on all threads."""
    threads = sorted({1, os.cpu_count() or 1}) if device == "cpu" else [1]
    timed: list[list[Cuts]] = [timed_cuts(device, case, n, TOLERANCES, repeats) for n in threads]
    rows = []
    for k, tolerance in enumerate(TOLERANCES):
        for n, cuts in zip(threads, timed, strict=True):
            row = timed_row(case, n, tolerance, cuts[k])
            row["speed-up"] = timed[0][k].wall.median / row["seconds"]
            counted = poses.get(key(case.name, tolerance))
            blank = dict.fromkeys(COLUMNS, "-")
            rows.append({**row, **(blank if counted is None else roofline(device, case, row, counted))})
    return rows


def _notes(device: str) -> list[str]:
    top = ceiling(device)
    return [
        "seconds: median wall time of the launches; spread: (slowest - fastest)/median; mm: tolerance of an "
        "interval's end. Mcand/s: million ray-segment pairs in the bounding volumes; Mpairs/s: those whose swept "
        "interval was computed. speed-up: against one thread. Scenes spiral-bevel-flank and, for the head, "
        "spiral-bevel-face-milled; the block is 100 x 60 x 20 mm scaled down. Up to 2,048 rays are one slice "
        "of work: more threads cannot help.",
        "poses/pair: evaluations of a pair, counted by the kernels; flop/pair: times the operations counted in the "
        "source (gearsim/bench/roofline.py); bytes/pair: loaded by the "
        "kernel, mostly from caches. of flops, of copy: share of this run's ceilings, "
        f"{1e-9 * top.flops:.3g} Gflop/s of float64 multiply-adds side by side and {1e-9 * top.bytes:.3g} GB/s of "
        "copying, each of one thread (on CUDA: of the device).",
    ]
