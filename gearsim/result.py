"""What a run leaves behind: measurements, findings, one verdict, timings and provenance, ready to be written."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib.metadata import version
from platform import python_version
from typing import Any

import gearsim
from gearsim.metrology.findings import Finding
from gearsim.metrology.inspection import Reading
from gearsim.metrology.job import Job
from gearsim.metrology.verdict import Verdict, headline


@dataclass(frozen=True)
class Result:
    """A finished run of a job: what each of its inspections read, in their order.

    ``timings_s`` and ``counts`` have the keys of report.json.
    """

    job: Job
    device: str
    readings: tuple[Reading, ...]
    verdict: Verdict
    status: str
    counts: dict[str, int]
    timings_s: dict[str, float]
    versions: dict[str, str]

    @property
    def name(self) -> str:
        return self.job.name

    @property
    def scene(self) -> dict[str, Any]:
        """The scene as plain tables."""
        return self.job.scene

    @property
    def frame(self) -> str:
        """The frame of all coordinates, in words."""
        return self.job.part.frame

    @cached_property
    def measurements(self) -> dict[tuple[str, str, str], Any]:
        """What was measured, by surface, variant and inspection."""
        found = (m for reading in self.readings for m in reading.measurements)
        return {(m.surface, m.variant, m.inspection): m for m in found}

    @property
    def findings(self) -> tuple[Finding, ...]:
        """What an engineer must be told, inspection after inspection."""
        return tuple(f for reading in self.readings for f in reading.findings)

    @property
    def headline(self) -> str:
        """What the verdict says in words, with everything known to be wrong."""
        return headline(self.verdict, self.status, self.readings, self.counts["rays"] > 0)

    @property
    def exit_code(self) -> int:
        """0 within tolerance, 1 out of it, 3 where nothing was judged or compared, or the witnesses disagree."""
        return {"pass": 0, "fail": 1, "unchecked": 3}[self.verdict]


def versions() -> dict[str, str]:
    """Versions of what computed a result."""
    packages = ("warp-lang", "numpy", "scipy")
    return {"gearsim": gearsim.__version__, "python": python_version(), **{p: version(p) for p in packages}}
