"""Two runs, or two data sets of studies, held against each other: what changed beyond noise."""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, is_file, is_folder, written
from gearsim.output.columns import unit_of
from gearsim.output.files import LAST
from gearsim.studies.store import MANIFEST, STUDY

_SHOWN = 40
_WORDS = ("what", "where")
_FIGURES = 4  # beyond a change's first digit
_FLOOR = 1e-12  # of numbers that are neither lengths nor angles


@dataclass(frozen=True)
class Noise:
    """What is no change: at most ``beyond_um`` of a length in um, a thousandth of it in mm and deg, and at most
    ``relative`` of the greater number.
    """

    beyond_um: float = 1e-6
    relative: float = 1e-9

    def exceeded(self, a: NDArray[np.floating], b: NDArray[np.floating], unit: str) -> NDArray[np.bool_]:
        """Where numbers differ by more than noise, or one of them is none (nan) or infinite and the other is not so."""
        floor = {"um": self.beyond_um, "mm": 1e-3 * self.beyond_um, "deg": 1e-3 * self.beyond_um}.get(unit, _FLOOR)
        with np.errstate(invalid="ignore"):
            apart = np.abs(b - a) > np.maximum(floor, self.relative * np.maximum(np.abs(a), np.abs(b)))
        numbers = np.isfinite(a) & np.isfinite(b)
        return np.where(numbers, apart, (a != b) & ~(np.isnan(a) & np.isnan(b)))


@dataclass(frozen=True)
class Change:
    """Of one name's values so many ``changed`` of those ``compared``; the ``largest`` change, where, from what to what.

    ``largest`` is None where words changed, or a value stands in one alone; the first such is told then.
    """

    name: str
    unit: str
    compared: int
    changed: int
    largest: float | None
    where: str
    a: Any
    b: Any


@dataclass(frozen=True)
class Comparison:
    """What was ``compared`` (how many values), what changed, what stands in one ``alone``; ``notes`` on what was asked
    and by whom do not make two differ.
    """

    kind: str
    compared: int
    changes: tuple[Change, ...]
    alone: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    @property
    def same(self) -> bool:
        return not self.changes and not self.alone


def compare(a: Path, b: Path, noise: Noise | None = None) -> Comparison:
    """Compare two folders of runs or of studies. Raises InputError where they are neither, or not of one kind."""
    from gearsim.studies.compare_data_sets import compare_data_sets
    from gearsim.studies.compare_runs import compare_runs

    kinds = [_kind(folder) for folder in (a, b)]
    if kinds[0] != kinds[1]:
        raise InputError(f"{a} is a {kinds[0]}, {b} a {kinds[1]}; two runs or two studies can be compared")
    return (compare_runs if kinds[0] == "run" else compare_data_sets)(a, b, noise or Noise())


def _kind(folder: Path) -> str:
    if is_file(folder / LAST):
        return "run"
    if is_file(folder / STUDY):
        if not is_file(folder / MANIFEST):
            raise InputError(f"{folder}: the study is not finished (no {MANIFEST}); run it again to go on")
        return "study"
    if not is_folder(folder):
        raise InputError(f"{folder} is no folder; expected a run's, with {LAST}, or a study's, with {STUDY}")
    raise InputError(f"{folder} holds neither {LAST} of a run nor {STUDY} of a study")


def change_of(
    name: str, a: NDArray[Any], b: NDArray[Any], where: Callable[[int], str], noise: Noise, unit: str | None = None
) -> Change | None:
    """What changed from values to others, shape (n,), numbers or objects; None: nothing beyond noise."""
    unit = unit_of(name) if unit is None else unit
    if a.dtype.kind == "O" or b.dtype.kind == "O":
        a, b = (np.array([_value(x) for x in values], dtype=object) for values in (a, b))
        off = np.asarray(a != b, dtype=bool)
        largest, k = None, int(np.argmax(off)) if off.size else 0
    else:
        a, b = a.astype(float), b.astype(float)
        off = noise.exceeded(a, b, unit)
        with np.errstate(invalid="ignore"):
            sizes = np.where(off & np.isfinite(b - a), np.abs(b - a), -1.0)  # where both are numbers
        k = int(np.argmax(sizes if (sizes >= 0.0).any() else off)) if off.size else 0
        largest = float(b[k] - a[k]) if off.size and sizes[k] >= 0.0 else None
    if not off.any():
        return None
    return Change(name, unit, len(off), int(off.sum()), largest, where(k), _value(a[k]), _value(b[k]))


def _value(x: Any) -> Any:
    x = x.item() if isinstance(x, np.generic) else x
    return None if isinstance(x, float) and not isfinite(x) else x


def ordered(changes: Sequence[Change | None]) -> tuple[Change, ...]:
    """Words and what is in one alone first, then lengths in um and mm, the largest change first, then other numbers."""
    rank = {"um": 1, "mm": 1}
    size = {"um": 1.0, "mm": 1e3}
    found = [c for c in changes if c is not None]
    return tuple(
        sorted(
            found,
            key=lambda c: (0, 0.0) if c.largest is None else (
                rank.get(c.unit, 2), -abs(c.largest) * size.get(c.unit, 1.0)
            ),
        )
    )  # fmt: skip


def command(options: argparse.Namespace) -> int:
    """``gearsim compare A B``: 0 the same, 1 not."""
    from gearsim.output.screen import print_line, print_rows

    noise = Noise(options.beyond)
    found = compare(options.a, options.b, noise)
    if options.out:
        told = {"same": found.same, "a": str(options.a), "b": str(options.b), **asdict(noise), **asdict(found)}
        with written(options.out, "comparison") as scratch:
            scratch.write_text(json.dumps(told, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    for note in found.notes:
        print_line(f"note: {note}")
    for text in found.alone:
        print_line(text)
    if found.changes:
        heads = ("what", "changed", "of", "largest change", "from", "to", "where")
        print_rows(
            f"{found.kind}: A {options.a}, B {options.b}", heads, [_row(c) for c in found.changes[:_SHOWN]], _WORDS
        )
    print_line(_headline(found, noise, bool(options.out)))
    return 0 if found.same else 1


def _row(c: Change) -> list[str]:
    largest = "" if c.largest is None else f"{c.largest:+.{_FIGURES}g} {c.unit}".strip()
    return [c.name, f"{c.changed:,}", f"{c.compared:,}", largest, _short(c.a), _short(c.b), c.where]


def _short(x: Any) -> str:
    text = "-" if x is None else f"{x:.10g}" if isinstance(x, float) else str(x)
    return text if len(text) <= 40 else f"{text[:37]}..."


def _headline(found: Comparison, noise: Noise, out: bool) -> str:
    limits = f"{noise.beyond_um:g} um, {noise.beyond_um / 1e3:g} mm or deg, {noise.relative:g} of the number"
    if found.same:
        return f"the same: {found.compared:,} values, none apart by more than {limits}"
    more = max(0, len(found.changes) - _SHOWN)
    hint = f"; {more} more names{'' if out else ', all with --out FILE'}" if more else ""
    changed = sum(c.changed for c in found.changes)
    return f"{changed:,} of {found.compared:,} values apart by more than {limits}{hint}"
