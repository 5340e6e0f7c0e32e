"""Benchmark suite `goals`: the figures that gearsim has set itself, each measured against its floor."""

from __future__ import annotations

import os
from collections.abc import Callable
from time import perf_counter, process_time
from typing import Any

from gearsim.bench.timing import REPEATS, Cuts, Times, timed_cuts
from gearsim.bench.workloads import (
    BALL_MM,
    BLOCK_SEGMENTS,
    PITCH,
    Case,
    block_case,
    flank_cases,
    flank_job,
    normals,
    pass_over_dexels,
)
from gearsim.cutters.profile import Profile
from gearsim.envelope import machined_along, prepare_envelope
from gearsim.metrology.deviation import measure
from gearsim.motion.sources import MotionSource
from gearsim.simulation.removal import cut, prepare

TOLERANCE, FINE = 1e-6, 1e-9
SAMPLES = (65, 513)
ENVELOPE_SAMPLES = (21, 257)
ENVELOPE_GOALS = {"continuous": 39.8, "CL data": 26.3}  # 25 times what NumPy did: 1,590 and 1,050 samples/s
BLOCK_SHARE = {"small": 0.04, "large": 1.0}
BLOCK_REPEATS = {"small": 2, "large": 1}
_COLUMNS = ("figure", "measured", "spread", "goal", "met")


def goals(device: str, size: str) -> dict[str, Any]:
    """Goals of speed, each with what this machine does now and whether that is enough."""
    prepare(device)
    prepare_envelope(device)
    rows = [*_candidate_rows(device), _dexel_row(device), _block_row(device, size), _deviation_row(device)]
    rows += _envelope_rows(device)
    return {"columns": list(_COLUMNS), "rows": rows, "notes": _notes(device)}


def figure(name: str, value: float, spread: float, goal: float, at_most: bool = False, **more: Any) -> dict[str, Any]:
    """A row: a figure that must reach its goal, or ``at_most`` stay under it."""
    met = value <= goal if at_most else value >= goal
    text = f"{'at most ' if at_most else ''}{goal:g}"
    return {"figure": name, "measured": value, "spread": spread, "goal": text, "met": "yes" if met else "no", **more}


def _of_one_thread(device: str, cuts: Cuts) -> Times:
    """CPU time of the whole call, which other work on the machine disturbs least; on CUDA the launches' wall time."""
    return cuts.cpu if device == "cpu" else cuts.wall


def _candidate_rows(device: str) -> list[dict[str, Any]]:
    rows = []
    for case in flank_cases():
        coarse, fine = timed_cuts(device, case, 1, (TOLERANCE, FINE))
        one, one_fine = _of_one_thread(device, coarse), _of_one_thread(device, fine)
        millions = 1e-6 * coarse.last.candidates
        rows.append(_figure_of(f"M candidates/s at 1e-6 mm, one thread: {case.name}", millions, one, 8.0))
        threads = os.cpu_count() or 1
        if device == "cpu" and threads > 1:
            (several,) = timed_cuts(device, case, threads, (TOLERANCE,))
            goal = 15.0 if threads == 2 else 7.5 * threads
            rows.append(
                _figure_of(f"M candidates/s at 1e-6 mm, {threads} threads: {case.name}", millions, several.wall, goal)
            )
        ratios = Times(tuple(f / c for c, f in zip(one.all, one_fine.all, strict=True)))
        rows.append(figure(f"time to 1e-9 mm over 1e-6 mm: {case.name}", ratios.median, ratios.spread, 1.2, True))
    return rows


def _figure_of(name: str, amount: float, times: Times, goal: float, **more: Any) -> dict[str, Any]:
    return figure(name, amount / times.median, times.spread, goal, seconds=times.all, **more)


def _dexel_row(device: str) -> dict[str, Any]:
    case = pass_over_dexels()
    (cuts,) = timed_cuts(device, case, 1, (TOLERANCE,))
    per_ray = cuts.last.candidates / len(case.rays)
    name = f"k tri-dexel rays/s at {per_ray:.1f} candidates a ray, one thread"
    return _figure_of(name, 1e-3 * len(case.rays), _of_one_thread(device, cuts), 250.0)


def _block_row(device: str, size: str) -> dict[str, Any]:
    share, moves = BLOCK_SHARE[size], round(BLOCK_SHARE[size] * BLOCK_SEGMENTS)
    case = block_case(share, over=0.0 if share == 1.0 else 0.5 * BALL_MM)
    (cuts,) = timed_cuts(device, case, 1, (TOLERANCE,), BLOCK_REPEATS[size])
    name = f"k segments/s, {moves:,} ramps in 5 axes, {_share(share)} at {PITCH:g} mm, one thread"
    times, counts = _of_one_thread(device, cuts), {"rays": len(case.rays), "candidates": cuts.last.candidates}
    return _figure_of(name, 1e-3 * moves, times, 10.0, **counts)


def _share(share: float) -> str:
    return "100 x 60 x 20 mm block" if share == 1.0 else f"1/{1.0 / share:g} of the 100 x 60 x 20 mm block"


def _deviation_row(device: str) -> dict[str, Any]:
    """From samples and normals to deviations, the flank's own continuous pass."""
    job = flank_job()
    case = Case("", normals(*SAMPLES), job.theory, job.cutter)

    def work() -> None:
        done = cut(case.rays, case.table, case.cutter, device=device, tolerance=TOLERANCE, threads=1)
        measure(case.rays, done.require_trust().removed)

    times = _timed(work, process_time if device == "cpu" else perf_counter)
    return _figure_of("M deviation samples/s, one core", 1e-6 * len(case.rays), times, 0.5)


def _envelope_rows(device: str) -> list[dict[str, Any]]:
    """Samples along which the envelope road finds the machined surface, seeds, classes and trims included."""
    rays, rows = normals(*ENVELOPE_SAMPLES), []
    for name, operation in (("continuous", flank_job().theory_pass), ("CL data", flank_job().cl_pass)):
        motions = operation.motions()

        def work(motions: list[MotionSource] = motions, cutter: Profile = operation.cutter) -> None:
            machined_along(rays, motions, cutter, device)

        work()
        times = _timed(work, process_time if device == "cpu" else perf_counter)
        rows.append(
            _figure_of(f"k envelope samples/s, one core: {name}", 1e-3 * len(rays), times, ENVELOPE_GOALS[name])
        )
    return rows


def _timed(work: Callable[[], None], clock: Callable[[], float]) -> Times:
    seconds = []
    for _ in range(REPEATS):
        started = clock()
        work()
        seconds.append(clock() - started)
    return Times(tuple(seconds))


def _notes(device: str) -> list[str]:
    clock = "CPU time of the whole call" if device == "cpu" else "wall time of the launches"
    return [
        f"One thread: median {clock}; several threads: median wall time of the launches. spread: (slowest - "
        "fastest)/median of the times. Candidates: ray-segment pairs in the bounding volumes. The two tolerances are "
        "cut in turn; their ratio is the median of the rounds' ratios.",
        "Block: 6 mm ball end mill, ten levels of zigzag lines 1 mm apart, tip rising and sinking, axis turning within "
        "15 degrees, as many segments to the area as 500,000 to the whole block (all of them with --size large). The "
        "path over a part of the block goes beyond it by the ball's radius, as if the block went on; segments are "
        "counted within.",
    ]
