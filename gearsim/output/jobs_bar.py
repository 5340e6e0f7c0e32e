"""How far a study is: a bar on a terminal's error stream, elsewhere a line now and then."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from time import monotonic
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn

_EVERY_S = 30.0  # a line, where there is no terminal


class JobsBar:
    """Jobs done, jobs a second and time left; use as a context."""

    def __init__(self) -> None:
        self._console = Console(stderr=True)
        columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn())
        self._bar = Progress(*columns, console=self._console, transient=True, disable=not self._console.is_terminal)
        self._task = self._bar.add_task("looking what is kept", total=None)
        self._jobs = self._kept = self._done = self._errors = 0
        self._waiting = ""
        self._began = self._told = monotonic()

    def __enter__(self) -> JobsBar:
        self._bar.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bar.stop()

    def begin(self, jobs: int, kept: int) -> None:
        """A study of so many jobs begins, of which some are kept from before."""
        self._jobs, self._kept, self._done = jobs, kept, 0
        self._began = self._told = monotonic()
        self._show()

    def advance(self, jobs: int, verdicts: Mapping[str, int]) -> None:
        """More jobs are done and kept, with such verdicts."""
        self._done += jobs
        self._errors += verdicts.get("error", 0)
        self._show()

    def tell(self, text: str) -> None:
        """What is waited for; empty: nothing is."""
        if text != self._waiting:
            self._waiting = text
            self._show()

    def _show(self) -> None:
        line = told(self._jobs, self._kept, self._done, self._errors, monotonic() - self._began)
        line += f"; {self._waiting}" * bool(self._waiting)
        self._bar.update(self._task, description=line, total=self._jobs, completed=self._kept + self._done)
        if not self._console.is_terminal and monotonic() - self._told > _EVERY_S:
            self._told = monotonic()
            print(f"gearsim: {line}", file=sys.stderr, flush=True)


def told(jobs: int, kept: int, done: int, errors: int, seconds: float) -> str:
    """A line: jobs done of all, those with an error, and after the first ones how fast, and how long it takes yet."""
    line = f"{kept + done:,} of {jobs:,} jobs"
    if errors:
        line += f", {errors:,} with an error"
    if done and seconds > 0.0:
        rate = done / seconds
        line += f", {rate:.3g} jobs/s, {_long((jobs - kept - done) / rate)} left"
    return line


def _long(seconds: float) -> str:
    whole = round(seconds)
    hours, minutes = whole // 3600, whole // 60 % 60
    return f"{hours} h {minutes:02} min" if hours else f"{minutes} min {whole % 60:02} s" if minutes else f"{whole} s"
