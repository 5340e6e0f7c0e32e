"""Two runs' folders compared: every value of report.json, every column of samples.parquet, the programs written."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, is_file, read_input
from gearsim.output.columns import unit_of
from gearsim.output.files import LAST, SAMPLES
from gearsim.studies.compare import Change, Comparison, Noise, change_of, ordered
from gearsim.studies.opened import columns_of
from gearsim.studies.study_file import unequal

_LEFT_OUT = ("scene", "timings_s", "versions", "conventions", "schema_version", "device")
_FOLLOWS = ".worst_at."  # where the worst lies jumps between equals; how large it is stands beside it
_KEYS = ("surface", "row", "column")
_TEXTS = (".cl", ".nc", ".csv")


def compare_runs(a: Path, b: Path, noise: Noise) -> Comparison:
    """What changed between two runs, beyond noise."""
    reports = [_report(folder / LAST) for folder in (a, b)]
    compared, changes, alone = _compare_reports(reports[0], reports[1], noise)
    if all(is_file(folder / SAMPLES) for folder in (a, b)):
        more = _compare_samples(a / SAMPLES, b / SAMPLES, noise)
        compared, changes, alone = compared + more[0], changes + more[1], alone + more[2]
    elif any(is_file(folder / SAMPLES) for folder in (a, b)):
        alone.append(f"{SAMPLES} only in {'A' if is_file(a / SAMPLES) else 'B'}")
    texts = _compare_texts(a, b)
    return Comparison("runs", compared, (*texts, *ordered(changes)), tuple(alone), tuple(_notes(reports)))


def _report(file: Path) -> dict[str, Any]:
    try:
        return dict(json.loads(read_input(file, "report")))
    except (ValueError, TypeError) as error:
        raise InputError(f"{file}: it is no report of a run ({error})") from error


def leaves(value: Any, name: str = "") -> Iterator[tuple[str, Any]]:
    """All values of nested plain ones by their dotted names; an empty list or table is none."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from leaves(inner, f"{name}.{key}" if name else str(key))
    elif isinstance(value, list):
        for k, inner in enumerate(value):
            yield from leaves(inner, f"{name}.{k}")
    else:
        yield name, value


def _compare_reports(a: Any, b: Any, noise: Noise) -> tuple[int, list[Change | None], list[str]]:
    told = [
        {k: v for k, v in leaves({k: v for k, v in r.items() if k not in _LEFT_OUT}) if _FOLLOWS not in k
         or k.endswith("_um")}
        for r in (a, b)
    ]  # fmt: skip
    both = [name for name in told[0] if name in told[1]]
    alone = [f"{LAST}: {name} only in {'AB'[k]}" for k in (0, 1) for name in _branches(told[k], told[1 - k])]
    changes = [_leaf(name, told[0][name], told[1][name], noise) for name in both]
    return len(both), changes, alone


def _branches(mine: Collection[str], theirs: Collection[str]) -> list[str]:
    """What stands in one alone, a whole branch by its own name."""
    known = {name[: m.start()] for name in theirs for m in re.finditer(r"\.|$", name)}
    out: dict[str, None] = {}
    for name in mine:
        if name not in known:
            ends = (m.start() for m in re.finditer(r"\.|$", name))
            out[next(name[:end] for end in ends if name[:end] not in known)] = None
    return list(out)


def _leaf(name: str, a: Any, b: Any, noise: Noise) -> Change | None:
    """The change of one value: of numbers where both are such or missing, else of words."""
    numbers = all(v is None or (isinstance(v, int | float) and not isinstance(v, bool)) for v in (a, b))
    one, other = (
        np.array([np.nan if v is None else float(v)]) if numbers else np.array([v], dtype=object) for v in (a, b)
    )
    count = isinstance(a, int) and isinstance(b, int)
    return change_of(name, one, other, lambda _: "", noise, "" if count else _unit(name))


def _unit(name: str) -> str:
    """The unit that the last of a dotted name's parts says that says one."""
    return next((unit for part in reversed(name.split(".")) if (unit := unit_of(part))), "")


def _compare_samples(a: Path, b: Path, noise: Noise) -> tuple[int, list[Change | None], list[str]]:
    tables = [_columns(file) for file in (a, b)]
    keys = [list(zip(*(t[k].tolist() for k in _KEYS), strict=True)) for t in tables]
    places = {key: row for row, key in enumerate(keys[1])}
    rows = np.array([places.get(key, -1) for key in keys[0]], dtype=int)
    mine, theirs = np.flatnonzero(rows >= 0), rows[rows >= 0]
    alone = [
        f"{SAMPLES}: {count:,} samples only in {'AB'[k]}"
        for k in (0, 1) if (count := len(keys[k]) - len(mine))
    ]  # fmt: skip
    names = [n for n in tables[0] if n in tables[1] and n not in _KEYS]
    alone += [
        f"{SAMPLES}: column {name} only in {'AB'[k]}"
        for k in (0, 1) for name in tables[k] if name not in tables[1 - k]
    ]  # fmt: skip

    def where(k: int) -> str:
        surface, row, column = keys[0][mine[k]]
        return f"{surface}, row {int(row)}, column {int(column)}"

    changes = [
        change_of(f"samples: {n}", tables[0][n][mine], tables[1][n][theirs], where, noise, unit_of(n)) for n in names
    ]
    return len(names) * len(mine), changes, alone


def _columns(file: Path) -> dict[str, NDArray[Any]]:
    """A table's columns: numbers, nan where there is none, or objects."""
    import pyarrow.parquet as pq

    try:
        table = pq.read_table(file)
    except (OSError, ValueError) as error:
        raise InputError(f"cannot read {file}: {error}") from error
    if not set(_KEYS) <= set(table.column_names):
        raise InputError(f"{file}: expected columns {', '.join(_KEYS)}; another version of gearsim wrote it")
    return columns_of(table)


def _compare_texts(a: Path, b: Path) -> list[Change]:
    """Programs and tables as text that are not the same, byte by byte."""
    names = sorted({f.name for folder in (a, b) for f in folder.iterdir() if f.suffix in _TEXTS})
    out = []
    for name in names:
        texts = [(folder / name).read_bytes() if is_file(folder / name) else None for folder in (a, b)]
        if texts[0] != texts[1]:
            sizes = [None if text is None else f"{len(text):,} bytes" for text in texts]
            out.append(Change(name, "", 1, 1, None, _first_line(texts[0], texts[1]), *sizes))
    return out


def _first_line(a: bytes | None, b: bytes | None) -> str:
    if a is None or b is None:
        return ""
    lines = [text.splitlines() for text in (a, b)]
    first = next((k for k, (x, y) in enumerate(zip(*lines, strict=False)) if x != y), min(map(len, lines)))
    return f"from line {first + 1}"


def _notes(reports: list[dict[str, Any]]) -> list[str]:
    """How the two runs were asked for, where not alike."""
    out = []
    for key in ("scene", "versions", "device"):
        differ = list(unequal(key, *(r.get(key) for r in reports)))
        if differ:
            out.append(f"differ in {'; '.join(differ[:8])}{'; ...' * (len(differ) > 8)}")
    return out
