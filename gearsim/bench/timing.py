"""Times of repeated cuts: medians and spreads."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import median
from time import process_time
from typing import Any, NamedTuple

from gearsim.bench.workloads import Case
from gearsim.simulation.removal import Removal, cut

REPEATS = 5


class Times(NamedTuple):
    """Repeats of one measurement [s]."""

    all: tuple[float, ...]

    @property
    def median(self) -> float:
        return median(self.all)

    @property
    def spread(self) -> float:
        """(Slowest - fastest) / median."""
        return (max(self.all) - min(self.all)) / self.median


class Cuts(NamedTuple):
    """Repeats of one cut: wall time of the launches, CPU time of the whole call, what the last one returned."""

    wall: Times
    cpu: Times
    last: Removal


def timed_cuts(
    device: str, case: Case, threads: int, tolerances: Sequence[float] = (1e-9,), repeats: int = REPEATS
) -> list[Cuts]:
    """Cut a case to each of the tolerances [mm] in turn, ``repeats`` times over; raises NumericalError as ``cut`` does.

    Taking turns lets what else the machine does disturb all tolerances alike.
    """
    cut(case.rays.part(slice(0, 1)), case.table, case.cutter, device=device)  # loads the tool's kernel
    wall: list[list[float]] = [[] for _ in tolerances]
    cpu: list[list[float]] = [[] for _ in tolerances]
    last: list[Removal] = []
    for _ in range(repeats):
        last = []
        for k, tolerance in enumerate(tolerances):
            started = process_time()
            done = cut(case.rays, case.table, case.cutter, device=device, threads=threads, tolerance=tolerance)
            cpu[k].append(process_time() - started)
            wall[k].append(done.kernel_s)
            last.append(done.require_trust())
    return [Cuts(Times(tuple(w)), Times(tuple(c)), r) for w, c, r in zip(wall, cpu, last, strict=True)]


def timed_row(case: Case, threads: int, tolerance: float, cuts: Cuts) -> dict[str, Any]:
    """The columns that every table of cuts has; rates are of wall time."""
    s, last = cuts.wall.median, cuts.last
    return {
        "case": case.name,
        "mm": tolerance,
        "threads": threads,
        "rays": len(case.rays),
        "segments": len(case.table),
        "candidates": last.candidates,
        "pairs": last.pairs,
        "seconds": s,
        "spread": cuts.wall.spread,
        "CPU s": cuts.cpu.median,
        "all seconds": cuts.wall.all,
        "krays/s": 1e-3 * len(case.rays) / s,
        "Mcand/s": 1e-6 * last.candidates / s,
        "Mpairs/s": 1e-6 * last.pairs / s,
    }
