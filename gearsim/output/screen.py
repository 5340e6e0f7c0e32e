"""What the command line shows: a progress bar while working, the figures when done."""

from __future__ import annotations

import sys
from pathlib import Path
from types import TracebackType
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

from gearsim.metrology.deviation import Deviation
from gearsim.metrology.dexel_check import DexelResult
from gearsim.metrology.roads import RoadGap
from gearsim.output.cylindrical.words import size
from gearsim.output.gouging.screen import print_gouging
from gearsim.result import (
    FlankMillingResult,
    GearResult,
    GeneratingResult,
    GougeExampleResult,
    Result,
    SculpturedResult,
)
from gearsim.surfaces.cylindrical_gear import SIDES

_CONSOLE = Console(highlight=False, width=None if sys.stdout.isatty() else 110)
_WIDE = 200  # of a table with many columns, written to a file


class ScreenProgress:
    """A progress bar on the terminal's error stream; use as a context."""

    def __init__(self) -> None:
        columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
        console = Console(stderr=True)
        self._bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
        self._task: TaskID | None = None

    def __enter__(self) -> ScreenProgress:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def stage(self, name: str, total: int) -> None:
        """Begin a stage of ``total`` rays; 0: of unknown length."""
        if self._task is not None:
            self._bar.remove_task(self._task)
        self._task = self._bar.add_task(name, total=total or None)

    def advance(self, amount: int) -> None:
        """Tell of rays done."""
        if self._task is not None:
            self._bar.advance(self._task, amount)


def print_result(result: Result, out: Path, missing: list[str]) -> None:
    """The figures a user wants first."""
    if isinstance(result, GearResult):
        _print_parameters(result)
    if isinstance(result, SculpturedResult | GougeExampleResult):
        print_gouging(result, _CONSOLE)
    else:
        _print_deviations(result)
    for f in result.findings:
        place = ", ".join(f"{x:.2f}" for x in f.place_mm)
        flag = "[bold red]FAILS[/] " if f.fails else ""
        depth = "" if f.depth_um is None else f"{f.depth_um:.1f} um "
        _CONSOLE.print(f"{flag}{f.kind}: {f.text}: {depth}at ({place}) mm")
    if isinstance(result, FlankMillingResult):
        for note in result.notes:
            _CONSOLE.print(f"[bold yellow]note[/] CL file: {escape(note)}", soft_wrap=True)
    for reason in missing:
        _CONSOLE.print(f"[bold yellow]not drawn[/] {reason}")
    t, counts = result.timings_s, result.counts
    rate = counts["pairs"] / max(t["kernel"], 1e-9) / 1e6
    if counts["rays"]:
        _CONSOLE.print(
            f"{counts['rays']:,} rays x {counts['segments']} segments, {counts['pairs']:,} pairs in "
            f"{t['kernel']:.2f} s ({rate:.2f} M pairs/s) on {result.device}; {t['total']:.1f} s in all."
        )
    style = {"pass": "bold green", "fail": "bold red", "unchecked": "bold magenta"}[result.verdict]
    detail = "" if result.verdict != "unchecked" else f": {escape(result.status)}"
    _CONSOLE.print(f"verdict: [{style}]{result.verdict}[/]{detail}   report: {out / 'report.html'}", soft_wrap=True)


def _print_parameters(result: GearResult) -> None:
    """Parameters of ISO 1328-1 by side, beside their tolerances."""
    inspection = result.inspection
    table = Table(title=f"{result.name}: ISO 1328-1:2013, transverse, class {inspection.gear_class} asked for")
    table.add_column("parameter")
    for head in (*(f"{side} flanks" for side in SIDES), "tolerance", "class achieved"):
        table.add_column(head, justify="right")
    for row in inspection.rows():
        style = "" if row.within or row.incomplete else "bold red"
        achieved = row.achieved or (f"{row.incomplete} missing" if row.incomplete else "beyond 11")
        values = [size(row.value_um[side]) for side in SIDES]
        table.add_row(row.parameter, *values, f"{row.tolerance_um:g} µm", str(achieved), style=style)
    _CONSOLE.print(table)


def _print_deviations(result: Result) -> None:
    """Deviations by surface and motion, and how well the roads agree."""
    table = Table(title=f"{result.name}: deviation in um, + material left, - overcut")
    for head in ("flank and motion", "min", "max", "mean", "rms"):
        table.add_column(head, justify="left" if head.startswith("flank") else "right")
    rows, gaps, dexels = _figures(result)
    for name, deviation in rows.items():
        um = deviation.summary_um()
        table.add_row(name, *(_um(um[k]) for k in ("min", "max", "mean", "rms")))
    _CONSOLE.print(table)
    third = f"; {dexels.checked:,} tri-dexel ends to {1e3 * dexels.check_um:.2g} nm" if dexels else ""
    largest = 1e3 * max((g.max_um for g in gaps), default=0.0)
    _CONSOLE.print(
        f"Two roads agree to {largest:.2g} nm over {sum(g.valid for g in gaps):,} samples "
        f"({sum(g.excluded for g in gaps)} excluded){third}."
    )


def _figures(result: Result) -> tuple[dict[str, Deviation], list[RoadGap], DexelResult | None]:
    if isinstance(result, FlankMillingResult):
        named = {
            f"{side}: {name}": deviation
            for side, flank in result.flanks.items()
            for name, deviation in (
                ("own pass, continuous", flank.own),
                ("own pass, CL data", flank.own_cl),
                ("all passes", flank.all_passes),
            )
            if deviation is not None
        }
        gaps = [g for f in result.flanks.values() for g in (f.gap, f.gap_cl) if g is not None]
        return named, gaps, result.dexels
    assert isinstance(result, GeneratingResult | GearResult)
    surfaces = (result.maps if isinstance(result, GearResult) else result.surfaces).items()
    named = {f"{side}: {name}": d for side, s in surfaces for name, d in s.deviations.items()}
    return named, [g for _, s in surfaces for g in s.gaps.values()], result.dexels


def print_estimate(name: str, estimate: dict[str, float]) -> None:
    """What a run would do."""
    _CONSOLE.print(
        f"{name}: {estimate['rays']:,.0f} rays, {estimate['segments']:,.0f} segments, "
        f"about {estimate['memory_mb']:,.0f} MB and {estimate['seconds']:,.0f} s on two CPU cores; nothing was cut."
    )


def print_bench(report: dict[str, Any]) -> None:
    """A benchmark's table and machine."""
    table = Table(title=f"gearsim bench {report['suite']} on {report['machine']['device']}")
    for head in report["columns"]:
        text = all(isinstance(row[head], str) for row in report["rows"])
        table.add_column(head, justify="left" if text else "right")
    for row in report["rows"]:
        table.add_row(*(escape(_figure(row[head])) for head in report["columns"]))
    (_CONSOLE if _CONSOLE.is_terminal else Console(highlight=False, width=_WIDE)).print(table)
    for line in report["notes"]:
        _CONSOLE.print(line, markup=False)


def _figure(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:,.3g}" if abs(x) < 1000.0 else f"{x:,.0f}"
    return f"{x:,}" if isinstance(x, int) else str(x)


def _um(x: float | int | None) -> str:
    if x is None:
        return "-"
    return f"{x:.1f}" if abs(x) >= 100.0 else f"{x:.4f}" if abs(x) >= 5e-5 else "0"
