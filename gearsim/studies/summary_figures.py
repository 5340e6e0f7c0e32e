"""The figures of a study's jobs as its summary tells them: which there are, what they are called, what is beyond."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.output.heat import NOISE_UM
from gearsim.studies.records import Study
from gearsim.studies.summary_frame import Frame

KINDS = {"min_um": "min", "max_um": "max", "rms_um": "RMS"}
_UNMEASURED = (".uncut", ".through")

Columns = Mapping[str, NDArray[Any]]


@dataclass(frozen=True)
class Told:
    """A study, its table by column (jobs,), nan where there is none, and what its figures are held against."""

    study: Study
    columns: Columns
    frame: Frame

    def __getitem__(self, name: str) -> NDArray[Any]:
        return self.columns[name]

    @property
    def verdicts(self) -> NDArray[Any]:
        return self.columns["verdict"].astype(str)

    @property
    def surfaces(self) -> list[str]:
        """Those that were mapped."""
        return [name.removesuffix(".rms_um") for name in self.columns if name.endswith(".rms_um")]

    @property
    def figures(self) -> list[str]:
        """Least, greatest and RMS deviation of each surface, and the parameters of ISO 1328-1 by side, all in um."""
        of_surfaces = [f"{s}.{kind}" for s in self.surfaces for kind in KINDS]
        return [f for f in [*of_surfaces, *self.iso] if f in self.columns and np.isfinite(self[f]).any()]

    @property
    def iso(self) -> list[str]:
        return [name for name in self.columns if name.startswith("iso.") and name.endswith("_um")]

    @property
    def still(self) -> list[str]:
        """The figures that vary by no more than the two roads agree to."""
        return [f for f in self.figures if float(np.nanmax(self[f]) - np.nanmin(self[f])) <= NOISE_UM]

    @property
    def parameters(self) -> dict[str, NDArray[Any]]:
        """Every parameter's values."""
        return {p.key: np.array(p.values) for p in self.study.parameters}

    def beyond(self, figure: str) -> NDArray[np.bool_]:
        """In which jobs a figure is beyond its tolerance, shape (jobs,)."""
        low, high = self.frame.limits(figure)
        return (self[figure] < low) | (self[figure] > high)

    def use(self, figure: str) -> NDArray[np.float64]:
        """The share of its tolerance that a figure uses up in each job; without a tolerance its size [um]."""
        low, high = self.frame.limits(figure)
        value = self[figure]
        limit = np.where(value < 0.0, -low, high)
        return np.abs(value) / limit if np.isfinite([low, high]).any() else np.abs(value)

    def unmeasured(self) -> NDArray[np.int_]:
        """How many samples of each job have a bound in place of a deviation: uncut, or cut through."""
        counts = [np.nan_to_num(v) for name, v in self.columns.items() if name.endswith(_UNMEASURED)]
        return np.sum(counts, axis=0).astype(int) if counts else np.zeros(len(self.study), dtype=int)


def label(figure: str) -> str:
    """A figure's name in words."""
    if figure.startswith("iso."):
        _, parameter, side = figure.split(".")
        return f"{parameter} {side.removesuffix('_um')}"
    surface, _, kind = figure.rpartition(".")
    return f"{surface} {KINDS[kind]}"


def micro(unit: str) -> str:
    """A unit as it is printed."""
    return re.sub(r"\bu(m|rad)\b", r"µ\1", unit)


def worst_jobs(told: Told, most: int) -> list[int]:
    """The jobs farthest beyond, or nearest to, what is tolerated: those first in which most samples have no deviation.

    By figures that have a tolerance, or all where none has.
    """
    held = [f for f in told.figures if np.isfinite(told.frame.limits(f)).any()]
    figures = held or [f for f in told.figures if not f.endswith(".rms_um")]
    if not figures:
        return []
    use = np.max([np.nan_to_num(told.use(f)) for f in figures], axis=0)
    order = np.lexsort((np.arange(len(use)), -use, -told.unmeasured()))
    return [int(k) for k in order if told.verdicts[k] != "error"][:most]


def headlines(told: Told, most: int) -> list[str]:
    """The figures worth looking into: of each surface and ISO parameter the one that varies most, those first that are
    often beyond their tolerance, then those that use most of it.
    """
    groups: dict[str, list[str]] = {}
    for figure in told.figures:
        if figure not in told.still:
            groups.setdefault(figure.rpartition(".")[0], []).append(figure)
    chosen = [max(group, key=lambda f: float(np.nanstd(told[f]))) for group in groups.values()]
    held = {f: bool(np.isfinite(told.frame.limits(f)).any()) for f in chosen}
    order = sorted(chosen, key=lambda f: (-int(told.beyond(f).sum()), not held[f], -float(np.nanmax(told.use(f)))))
    return order[:most]
