"""Benchmarks: suites registered by name, each measured side by side in one run."""

from __future__ import annotations

import os
import platform
from collections.abc import Callable
from statistics import median
from time import perf_counter
from typing import Any, NamedTuple

import gearsim
from gearsim import flank_milling, generating
from gearsim.bench_envelope import envelope
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle
from gearsim.metrology.dexel_check import slot_box
from gearsim.metrology.samples import sample_grid
from gearsim.motion.segments import SegmentTable
from gearsim.scene import FlankMillingScene, GeneratedScene, load_scene
from gearsim.simulation.removal import cut, device_name, prepare

Suite = Callable[[str], dict[str, Any]]

_REPEATS = 5
_COLUMNS = ("case", "threads", "rays", "segments", "seconds", "spread", "krays/s", "Mcand/s",
            "Mpairs/s", "speed-up")  # fmt: skip


def removal(device: str) -> dict[str, Any]:
    """The removal road: rays along normals, a slot's tri-dexel, and a ring-shaped head's roll."""
    cases = [*_flank_milling_cases(), _head_case()]
    prepare(device)
    threads = sorted({1, os.cpu_count() or 1}) if device == "cpu" else [1]
    rows = []
    for case in cases:
        timed = [_timed_cut(device, case, threads=n) for n in threads]
        rows += [{**row, "speed-up": timed[0]["seconds"] / row["seconds"]} for row in timed]
    notes = [
        f"Median of {_REPEATS} runs, kernel time alone; spread: (slowest - fastest)/median. Mcand/s: million ray-"
        "segment pairs in the bounding volumes; Mpairs/s: those whose swept interval was computed, to 1e-9 mm. "
        "speed-up: against the case's first row. Scenes spiral-bevel-flank and, for the head, spiral-bevel-face-milled."
    ]
    return {"columns": list(_COLUMNS), "rows": rows, "notes": notes}


class _Case(NamedTuple):
    """Rays to cut by a motion of a tool."""

    name: str
    rays: RayBundle
    table: SegmentTable
    cutter: Profile


def _flank_milling_cases() -> list[_Case]:
    scene, folder = load_scene("spiral-bevel-flank")
    assert isinstance(scene, FlankMillingScene)
    job = flank_milling.plan(scene, folder)
    normals = sample_grid(job.tooth.flank("convex"), 65, 513).rays()
    dexels = slot_box(job.tooth.patches, job.tooth.blank, 0.15).rays(2)
    return [
        _Case("normals, continuous", normals, job.theory["convex"].table, job.cutter),
        _Case("normals, CL data", normals, job.program, job.cutter),
        _Case("tri-dexel, CL data", dexels, job.program, job.cutter),
    ]


def _head_case() -> _Case:
    scene, folder = load_scene("spiral-bevel-face-milled")
    assert isinstance(scene, GeneratedScene)
    job = generating.plan(scene, folder)
    (cut,) = job.cuts
    convex = next(patch for patch in cut.patches if patch.name == "convex")
    table = job.compiled(cut, cut.sources[cut.generating]).table
    return _Case("normals, head's roll", sample_grid(convex, 33, 129, 0.01).rays(), table, cut.cutter)


def _timed_cut(device: str, case: _Case, threads: int) -> dict[str, Any]:
    name, rays, table, cutter = case
    cut(rays.part(slice(0, 1)), table, cutter, device=device)  # loads the tool's kernel
    runs = [cut(rays, table, cutter, device=device, threads=threads).require_trust() for _ in range(_REPEATS)]
    seconds = sorted(r.kernel_s for r in runs)
    s, last = median(seconds), runs[-1]
    return {
        "case": name,
        "threads": threads,
        "rays": len(rays),
        "segments": len(table),
        "candidates": last.candidates,
        "pairs": last.pairs,
        "seconds": s,
        "spread": (seconds[-1] - seconds[0]) / s,
        "krays/s": 1e-3 * len(rays) / s,
        "Mcand/s": 1e-6 * last.candidates / s,
        "Mpairs/s": 1e-6 * last.pairs / s,
    }


SUITES: dict[str, Suite] = {"removal": removal, "envelope": envelope}


def run_suite(name: str, device: str) -> dict[str, Any]:
    """Run a suite and return its table with the machine it ran on."""
    if name not in SUITES:
        raise InputError(f"no benchmark suite {name!r}; there are {', '.join(SUITES)}")
    started = perf_counter()
    report = SUITES[name](device)
    machine = {
        "device": device_name(device),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "gearsim": gearsim.__version__,
    }
    return {"suite": name, "machine": machine, "total_s": perf_counter() - started, **report}
