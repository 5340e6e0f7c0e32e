"""A study: one scene under many values of some of its keys; and what comes of each of its jobs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Value = float | int | str | bool
_UNITS = {
    "_um_m_k": "um/(m K)", "_um_min": "um/min", "_mm_min": "mm/min", "_um_m": "um/m", "_urad_m": "urad/m",
    "_urad_rad": "urad/rad", "_mm": "mm", "_um": "um", "_urad": "urad", "_arcsec": "arcsec", "_deg": "deg",
    "_rpm": "1/min", "_minutes": "min", "_k": "K",
}  # fmt: skip


@dataclass(frozen=True)
class Parameter:
    """A scene's key, dotted (``cutter.taper_deg``; ``errors.pivot_um.2``: a place in a list), and each job's value.

    ``lower`` and ``upper`` bound what was drawn; nan where it is listed or unbounded.
    """

    key: str
    values: tuple[Value, ...]
    lower: float = float("nan")
    upper: float = float("nan")

    @property
    def unit(self) -> str:
        """The unit that the key's ending names; "1" where it names none."""
        name = next((part for part in reversed(self.key.split(".")) if not part.isdigit()), "")
        return next((unit for end, unit in _UNITS.items() if name.endswith(end)), "1")


@dataclass(frozen=True)
class Asked:
    """What is measured of each job.

    ``measure``: ``maps`` (every judged surface on its dense grid under the whole program), ``iso`` (a cylindrical
    gear's traces after ISO 1328-1). ``cross_checked``: the share of the jobs, drawn by the study's seed, of which
    everything is measured that ``gearsim run`` measures, by both roads, and whose verdict is that of the run; of the
    others the envelope road is left out, and their verdict is ``unchecked``.
    """

    measure: tuple[str, ...] = ("maps",)
    cross_checked: float = 1.0


@dataclass(frozen=True)
class Study:
    """A scene, as nested plain ``tables``, whose files lie in ``folder``, under all its parameters' values.

    ``source`` is the study as nested plain tables, as it was given; ``method`` how values were found
    (``grid``, ``list``, ``latin-hypercube``, ``sobol``, ``monte-carlo``) by which ``seed``. ``chunk``: so many
    jobs are computed and kept together. ``notes``: what a user should know of it.
    """

    name: str
    summary: str
    tables: Mapping[str, Any]
    folder: Path
    parameters: tuple[Parameter, ...]
    method: str
    seed: int
    asked: Asked = Asked()
    chunk: int = 32
    source: Mapping[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()

    def __len__(self) -> int:
        """Jobs."""
        return len(self.parameters[0].values) if self.parameters else 1

    @property
    def chunks(self) -> int:
        return -(-len(self) // self.chunk)

    def jobs_of(self, chunk: int) -> range:
        """The numbers of a chunk's jobs, from 0."""
        return range(chunk * self.chunk, min((chunk + 1) * self.chunk, len(self)))

    def values_of(self, job: int) -> dict[str, Value]:
        """A job's parameters by their keys."""
        return {p.key: p.values[job] for p in self.parameters}

    @cached_property
    def cross_checked(self) -> NDArray[np.bool_]:
        """In which jobs both roads are asked, shape (jobs,): the stated share of them, at least one if it is not 0."""
        share, n = self.asked.cross_checked, len(self)
        chosen = np.zeros(n, dtype=bool)
        count = min(n, max(1, round(share * n))) if share > 0.0 else 0
        chosen[np.random.default_rng([self.seed, 1]).permutation(n)[:count]] = True
        chosen.setflags(write=False)
        return chosen


@dataclass(frozen=True)
class SurfaceMap:
    """A surface's deviations [um] in one job, shape (rows, columns), nan where not measured; ``crossing`` says why.

    ``crossing``: codes of ``metrology.deviation.Crossing``. ``u``, ``v``: places of rows and columns, as shares of the
    surface from its first edge to its last. ``point`` [mm] (rows, columns, 3) and ``normal``: the intended surface's.
    """

    deviation_um: NDArray[np.floating]
    crossing: NDArray[np.uint8]
    u: NDArray[np.floating]
    v: NDArray[np.floating]
    point: NDArray[np.floating]
    normal: NDArray[np.floating]


@dataclass(frozen=True)
class Outcome:
    """What came of a job: figures by dotted name (``convex.min_um``, ``iso.F_alpha.right_um``), maps by surface.

    A job that could not be done has the verdict ``error`` and says why in ``error``; it has neither figures nor maps.
    ``status`` is the run's ("OK", or what forbids trust).
    """

    job: int
    verdict: Literal["pass", "fail", "unchecked", "error"]
    status: str = "OK"
    error: str = ""
    cross_checked: bool = False
    figures: Mapping[str, float | int | str | bool | None] = field(default_factory=dict)
    maps: Mapping[str, SurfaceMap] = field(default_factory=dict)


def counted(outcomes: Sequence[Outcome]) -> dict[str, int]:
    """How many outcomes have each verdict, those that occur."""
    found: dict[str, int] = {}
    for outcome in outcomes:
        found[outcome.verdict] = found.get(outcome.verdict, 0) + 1
    return found
