"""What a run of the torture tells: counts by tool, motion and ray, the worst defects and where to find them."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from gearsim.verify.torture.campaign import Tried
from gearsim.verify.torture.defects import END, LOST, SPANNED, Defect

_SHOWN = 12


@dataclass
class Figures:
    """Counts of a run. ``pairs`` are rays times rows; ``by`` counts pairs and defects by kind's name.

    ``coarse`` rays were decided only where the tool may be off by 8 times the noise or 1e-10 mm.
    """

    rays: int = 0
    pairs: int = 0
    hits: int = 0
    flagged: int = 0
    undecided: int = 0
    coarse: int = 0
    cells: int = 0
    defects: list[Defect] = field(default_factory=list)
    by: dict[str, Counter[str]] = field(default_factory=dict)

    def add(self, tried: Tried, found: list[Defect], undecided: NDArray[np.integer]) -> None:
        """Count one case, whose rays ``undecided`` remain so when looked at more coarsely."""
        case, rows = tried.case, len(tried.case.table)
        self.rays += len(case.rays)
        self.pairs += len(case.rays) * rows
        self.hits += int(np.count_nonzero(np.diff(tried.removal.removed.first)))
        self.flagged += int(np.count_nonzero(~tried.trusted))
        self.undecided += len(undecided)
        self.coarse += int(np.count_nonzero(tried.undecided)) - len(undecided)
        self.cells += int(tried.judgement.cells.sum())
        self.defects += found
        kinds = {f"ray {name}": case.ray_kind == name for name in np.unique(case.ray_kind)}
        everything = np.ones(len(case.rays), dtype=bool)
        for name, mine in {f"tool {case.tool}": everything, f"motion {case.motion}": everything, **kinds}.items():
            counts = self.by.setdefault(name, Counter())
            counts["pairs"] += int(mine.sum()) * rows
            counts["undecided"] += int(np.count_nonzero(mine[undecided]))
            counts["flagged"] += int(np.count_nonzero(mine & ~tried.trusted))
        for defect in found:
            for what, name in zip(("tool", "motion", "ray"), defect.names, strict=True):
                self.by[f"{what} {name}"][defect.kind] += 1

    def count(self, kind: str, deep: bool | None = None) -> int:
        """Defects of a kind; the deep ones, those that are not, or all."""
        return sum(d.kind == kind and deep in (None, d.deep) for d in self.defects)

    @property
    def exit_code(self) -> int:
        """0: nothing wrong and nothing undecided; 1: something is."""
        return int(bool(self.defects or self.undecided))


def summary(figures: Figures, size: str, seed: int, seconds: float) -> dict[str, Any]:
    """Everything the JSON file holds."""
    kinds = {kind.replace(" ", "_"): figures.count(kind) for kind in (LOST, SPANNED, END)}
    counts = {k: getattr(figures, k) for k in ("rays", "pairs", "hits", "flagged", "coarse", "undecided", "cells")}
    worst = sorted(figures.defects, key=lambda d: -d.length)
    return {
        "schema_version": 1, "size": size, "seed": seed, "time_s": round(seconds, 1), **counts, **kinds,
        "by": {name: dict(c) for name, c in sorted(figures.by.items())},
        "worst": [_line(d) for d in worst[:100]],
    }  # fmt: skip


def print_report(figures: Figures, seconds: float) -> None:
    """A table by kind, the worst defects, one line of totals."""
    console = Console(highlight=False, width=110)
    table = Table(title="removal road against separating planes")
    heads = ("pairs", "flagged", "undecided", LOST, SPANNED, END)
    for head in ("kind", *heads):
        table.add_column(head, justify="left" if head == "kind" else "right")
    for name, c in sorted(figures.by.items()):
        table.add_row(name, *(f"{c[k]:,}" for k in heads))
    console.print(table)
    for d in sorted(figures.defects, key=lambda d: -d.length)[:_SHOWN]:
        console.print(_line(d), markup=False)
    shares = ", ".join(f"{figures.count(k)} {k} ({figures.count(k, True)} deep)" for k in (LOST, SPANNED, END))
    console.print(
        f"{figures.pairs:,} ray-row pairs, {figures.hits:,} of {figures.rays:,} rays hit, {figures.flagged:,} flagged, "
        f"{figures.coarse} decided coarsely, {figures.undecided} undecided: {shares}; {seconds:.0f} s",
        markup=False,
    )


def _line(d: Defect) -> str:
    where = "case " + " ".join(map(str, d.seed)) + f", ray {d.ray}"
    return f"{d.kind}: {d.length:.3g} mm, {'deep' if d.deep else 'shallow'}; {', '.join(d.names)}; {where}"
