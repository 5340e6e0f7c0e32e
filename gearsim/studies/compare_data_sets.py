"""Two studies' data sets compared: jobs matched by their parameters' values, figures, verdicts, maps."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.studies.compare import Change, Comparison, Noise, change_of, ordered
from gearsim.studies.opened import DataSet
from gearsim.studies.study_file import differences

_AT_ONCE = 256  # jobs whose maps are held at a time


@dataclass(frozen=True)
class Matched:
    """Which ``rows`` of two data sets' tables are the same job, shape (jobs,) each, and how a job is told."""

    a: DataSet
    b: DataSet
    keys: Sequence[str]
    rows_a: NDArray[np.integer]
    rows_b: NDArray[np.integer]

    def __len__(self) -> int:
        return len(self.rows_a)

    def where(self, k: int) -> str:
        """A matched job: its number, in both where not the same, and what its parameters are."""
        first, second = int(self.rows_a[k]), int(self.rows_b[k])
        number = f"job {first}" if first == second else f"job {first} ({second} in B)"
        values = ", ".join(f"{key} = {_text(self.a.values(key)[first])}" for key in self.keys[:3])
        return f"{number}: {values}" if values else number


def compare_data_sets(a: Path, b: Path, noise: Noise) -> Comparison:
    """What changed between two data sets, beyond noise. Raises InputError where one is not as its manifest says."""
    sets = DataSet(a), DataSet(b)
    for data in sets:
        data.verify()
    matched, alone = _match(*sets)
    ours, theirs = (s.columns for s in sets)
    left_out = {"job", *matched.keys}
    names = [n for n in ours if n in theirs and n not in left_out]
    alone += [f"column {n} only in A" for n in ours if n not in theirs and n not in left_out]
    alone += [f"column {n} only in B" for n in theirs if n not in ours and n not in left_out]
    changes: list[Change | None] = [*_verdicts(matched)]
    for name in names:
        if name != "verdict":
            changes.append(
                change_of(name, ours[name][matched.rows_a], theirs[name][matched.rows_b], matched.where, noise)
            )
    compared = len(names) * len(matched)
    for surface in dict.fromkeys([*sets[0].maps, *sets[1].maps]):
        found, count, apart = _compare_maps(matched, surface, noise)
        changes, compared, alone = [*changes, *found], compared + count, [*alone, *apart]
    differ = differences(sets[0].told, sets[1].told)
    asked = [f"the studies differ in {'; '.join(differ[:8])}{'; ...' * (len(differ) > 8)}"] if differ else []
    return Comparison("studies", compared, ordered(changes), tuple(alone), tuple(asked))


def _match(a: DataSet, b: DataSet) -> tuple[Matched, list[str]]:
    """Jobs of the same values, the first such of one with the first of the other; what is left in one alone."""
    keys = list(dict.fromkeys([*a.keys, *b.keys]))
    rows = [_named(s, keys) for s in (a, b)]
    both = [name for name in rows[0] if name in rows[1]]
    alone = []
    for k, mine in enumerate(rows):
        left = [row for name, row in mine.items() if name not in rows[1 - k]]
        if left:
            shown = ", ".join(map(str, left[:10]))
            alone.append(f"{len(left):,} jobs only in {'AB'[k]}: {shown}{', ...' * (len(left) > 10)}")
    found = [np.array([r[name] for name in both], dtype=int) for r in rows]
    return Matched(a, b, keys, *found), alone


def _named(data: DataSet, keys: Sequence[str]) -> dict[Any, int]:
    """Row by values and how many rows of the same values came before."""
    columns = [data.values(key) for key in keys]
    seen: Counter[Any] = Counter()
    out = {}
    for row in range(len(data.columns["job"])):
        values = tuple(column[row] for column in columns)
        out[values, seen[values]] = row
        seen[values] += 1
    return out


def _verdicts(matched: Matched) -> list[Change]:
    """Every change from a verdict to another one, with the first job that has it."""
    a, b = (s.columns["verdict"][rows] for s, rows in ((matched.a, matched.rows_a), (matched.b, matched.rows_b)))
    steps: list[tuple[str, str]] = list(zip(a.tolist(), b.tolist(), strict=True))
    counted = Counter(step for step in steps if step[0] != step[1])
    return [
        Change("verdict", "", len(steps), count, None, matched.where(steps.index(step)), *step)
        for step, count in sorted(counted.items())
    ]


def _compare_maps(matched: Matched, surface: str, noise: Noise) -> tuple[list[Change], int, list[str]]:
    """The largest change of a surface's deviations and where, and how often something else was met."""
    maps = [s.maps.get(surface) for s in (matched.a, matched.b)]
    if maps[0] is None or maps[1] is None:
        return [], 0, [f"maps of {surface} only in {'A' if maps[1] is None else 'B'}"]
    shape = maps[0][0].shape[1:]
    if shape != maps[1][0].shape[1:]:
        return [], 0, [f"maps of {surface}: {shape} samples a job in A, {maps[1][0].shape[1:]} in B"]
    found: list[Change] = []
    for at in (0, 1):
        parts = [_part(matched, maps, at, start, surface, noise) for start in range(0, len(matched), _AT_ONCE)]
        found += _joined([p for p in parts if p is not None], len(matched) * int(np.prod(shape)))
    return found, 2 * len(matched) * int(np.prod(shape)), []


def _part(matched: Matched, maps: Sequence[Any], at: int, start: int, surface: str, noise: Noise) -> Change | None:
    """The change of some jobs' deviations (``at`` 0) or crossings (1)."""
    jobs = slice(start, start + _AT_ONCE)
    values = [m[at].oindex[rows[jobs]] for m, rows in zip(maps, (matched.rows_a, matched.rows_b), strict=True)]
    shape = values[0].shape

    def where(k: int) -> str:
        job, row, column = np.unravel_index(k, shape)
        return f"row {row}, column {column}, {matched.where(start + int(job))}"

    if at == 0:
        return change_of(f"map of {surface}", values[0].ravel(), values[1].ravel(), where, noise, "um")
    found = change_of(f"crossing of {surface}", values[0].ravel(), values[1].ravel(), where, noise, "")
    words = str(maps[0][1].attrs["flag_meanings"]).split()
    return found and replace(found, largest=None, a=words[int(found.a)], b=words[int(found.b)])


def _joined(parts: Sequence[Change], compared: int) -> list[Change]:
    """One change for those of several parts of a map."""
    if not parts:
        return []
    worst = max(parts, key=lambda c: -1.0 if c.largest is None else abs(c.largest))
    return [Change(
        worst.name, worst.unit, compared, sum(c.changed for c in parts), worst.largest, worst.where, worst.a, worst.b
    )]  # fmt: skip


def _text(value: Any) -> str:
    return f"{value:.10g}" if isinstance(value, float) else str(value)
