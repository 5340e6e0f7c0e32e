"""What the command line shows: a progress bar while working, the figures when done."""

from __future__ import annotations

import sys
from collections.abc import Collection, Sequence
from pathlib import Path
from types import TracebackType
from typing import Any

from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, Progress, SpinnerColumn, TaskID, TextColumn, TimeElapsedColumn
from rich.table import Table

from gearsim.output.presenters import collected
from gearsim.result import Result

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


def print_result(result: Result, written: Path, missing: list[str]) -> None:
    """The figures a user wants first; ``written`` is where to read on: the report, or the folder."""
    collected(result, "screen", _CONSOLE)
    for f in result.findings:
        place = ", ".join(f"{x:.2f}" for x in f.place_mm)
        flag = "[bold red]FAILS[/] " if f.fails else ""
        depth = "" if f.depth_um is None else f"{f.depth_um:.1f} um "
        _CONSOLE.print(f"{flag}{f.kind}: {f.text}: {depth}at ({place}) mm")
    for note in result.job.notes:
        _CONSOLE.print(f"[bold yellow]note[/] {escape(note)}", soft_wrap=True)
    for reason in missing:
        _CONSOLE.print(f"[bold yellow]not drawn[/] {escape(reason)}")
    t, counts = result.timings_s, result.counts
    rate = counts["pairs"] / max(t["kernel"], 1e-9) / 1e6
    if counts["rays"]:
        _CONSOLE.print(
            f"{counts['rays']:,} rays x {counts['segments']:,} segments, {counts['pairs']:,} pairs in "
            f"{t['kernel']:.2f} s ({rate:.2f} M pairs/s) on {result.device}; {t['total']:.1f} s in all."
        )
    style = {"pass": "bold green", "fail": "bold red", "unchecked": "bold magenta"}[result.verdict]
    what = "files" if written.is_dir() else "report"
    _CONSOLE.print(
        f"verdict: [{style}]{result.verdict}[/]: {escape(result.headline)}   {what}: {written}", soft_wrap=True
    )


def print_line(text: str) -> None:
    """What a command has done, in a line."""
    _CONSOLE.print(text, markup=False, soft_wrap=True)


def print_estimate(name: str, estimate: dict[str, float]) -> None:
    """What a run would do."""
    _CONSOLE.print(
        f"{name}: {estimate['rays']:,.0f} rays and those that follow from what they find, "
        f"{estimate['segments']:,.0f} segments, about {estimate['memory_mb']:,.0f} MB and "
        f"{estimate['seconds']:,.0f} s on two CPU cores; nothing was cut."
    )


def print_bench(report: dict[str, Any]) -> None:
    """A benchmark's table and machine."""
    heads, rows = report["columns"], report["rows"]
    words = {head for head in heads if all(isinstance(row[head], str) for row in rows)}
    title = f"gearsim bench {report['suite']} on {report['machine']['device']}"
    print_rows(title, heads, [[_figure(row[head]) for head in heads] for row in rows], words)
    for line in report["notes"]:
        _CONSOLE.print(line, markup=False)


def print_rows(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]], words: Collection[str] = ()) -> None:
    """A table as wide as it needs where no terminal limits it; columns of ``words`` stand to the left."""
    table = Table(title=title)
    for head in heads:
        table.add_column(head, justify="left" if head in words else "right", overflow="fold")
    for row in rows:
        table.add_row(*map(escape, row))
    (_CONSOLE if _CONSOLE.is_terminal else Console(highlight=False, width=_WIDE)).print(table)


def _figure(x: Any) -> str:
    if isinstance(x, float):
        return f"{x:,.3g}" if abs(x) < 1000.0 else f"{x:,.0f}"
    return "" if x is None else f"{x:,}" if isinstance(x, int) else str(x)
