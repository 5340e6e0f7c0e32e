"""Every number of two runs' report.json and samples.parquet, old names led to new ones."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

_LEFT_OUT = ("scene.", "timings_s.", "versions.", "conventions.")
_RULES = Path(__file__).with_name("renamed.txt")
_COLUMNS = {
    "own_pass_um": "theory_um", "own_pass_cl_um": "own_pass_um", "all_passes_um": "program_um",
    "crossing": "program_crossing", "segment": "program_segment", "envelope_cl_um": "own_pass_envelope_um",
    "envelope_class": "own_pass_class", "envelope_gap_cl_um": "own_pass_gap_um", "roll_angle_rad": "u",
    "arc_length_mm": "v", "phi_rad": "u", "profile_height_mm": "v", "envelope_gap_um": "last_operation_gap_um",
}  # fmt: skip
_KEYS = ("row", "column")


class Differs(NamedTuple):
    """A number that is not the same, or stands in one run only (nan in the other)."""

    name: str
    old: float
    new: float


def flat(value: Any, name: str = "") -> dict[str, float]:
    """All numbers of nested plain values by their names."""
    if isinstance(value, dict):
        parts = (flat(v, f"{name}.{k}" if name else str(k)) for k, v in value.items())
        return {k: v for part in parts for k, v in part.items()}
    if isinstance(value, list):
        return {k: v for i, item in enumerate(value) for k, v in flat(item, f"{name}[{i}]").items()}
    return {name: float(value)} if isinstance(value, int | float) else {}


def rules() -> list[tuple[re.Pattern[str], str]]:
    """Patterns of old names with what replaces them ("-": nothing)."""
    lines = (line.split("  #")[0].strip() for line in _RULES.read_text().splitlines())
    pairs = (line.split(" -> ") for line in lines if line and not line.startswith("#"))
    return [(re.compile(old), new) for old, new in pairs]


def compare_reports(old: dict[str, Any], new: dict[str, Any]) -> tuple[int, list[Differs], list[str]]:
    """How many numbers were compared, those that differ, and old names without a new one."""
    ours, known, compared, differ, lost = flat(new), rules(), 0, [], []
    for name, value in flat(old).items():
        if name.startswith(_LEFT_OUT):
            continue
        rule = next(((p, to) for p, to in known if p.fullmatch(name)), (None, name))
        target = rule[0].sub(rule[1], name) if rule[0] else name
        if target == "-":
            continue
        found = [target] if target in ours else _matching(target, ours)
        if not found:
            lost.append(name)
            continue
        compared += 1
        if value != ours[found[0]]:
            differ.append(Differs(name, value, ours[found[0]]))
    return compared, differ, lost


def _matching(target: str, names: dict[str, float]) -> list[str]:
    if "*" not in target:
        return []
    pattern = re.compile(re.escape(target).replace(r"\*", "[^.]+"))
    return [name for name in names if pattern.fullmatch(name)]


def compare_samples(old: Path, new: Path) -> tuple[int, list[Differs], list[str]]:
    """The same for two samples.parquet: columns of numbers and words, row by row."""
    import pyarrow.parquet as pq

    a, b = (pq.read_table(f) for f in (old, new))
    first, second = (
        {n: np.array(t[n].to_pylist(), dtype=object) for n in t.column_names} for t in (a, b)
    )  # fmt: skip
    by, places = next(name for name in ("tool", "flank", "surface") if name in first), {}
    for i, key in enumerate(zip(second["surface"], *(second[k] for k in _KEYS), strict=True)):
        places[key] = i
    only = second["surface"][0] if by == "tool" else None
    keys = zip(first[by], *(first[k] for k in _KEYS), strict=True)
    rows = [places[only or surface, row, column] for surface, row, column in keys]
    compared, differ, lost = 0, [], []
    for name, values in first.items():
        if name in (by, *_KEYS):
            continue
        for group in dict.fromkeys(first[by]) if by == "tool" else [None]:
            mine = first[by] == group if by == "tool" else np.ones(len(values), dtype=bool)
            target = _column(name, second, group)
            if target is None:
                lost.append(name)
                continue
            theirs = second[target][np.array(rows)[mine]]
            compared += int(mine.sum())
            differ += _unequal(f"{name} of {group}" if group else name, values[mine], theirs)
    return compared, differ, lost


def _column(name: str, ours: dict[str, Any], tool: str | None) -> str | None:
    stem = {"deviation_um": "um"}.get(name, name)
    candidates = [f"{tool}_tool_{stem}"] if tool else [_COLUMNS.get(name, name)]
    candidates += [name, name.replace("_envelope_gap_um", "_gap_um")]
    if name.startswith("machined_"):
        candidates += [f"{v}_{name.removeprefix('machined_')}" for v in ("theory", "own_pass")]
    return next((c for c in candidates if c in ours), None)


def _unequal(name: str, old: Any, new: Any) -> list[Differs]:
    if isinstance(next((x for x in old if x is not None), 0.0), str):
        wrong = int(np.count_nonzero(old != new))
        return [Differs(f"{name}: words that differ", 0.0, float(wrong))] if wrong else []
    a, b = (np.array([np.nan if x is None else float(x) for x in values]) for values in (old, new))
    off = ~((a == b) | (np.isnan(a) & np.isnan(b)))
    if not off.any():
        return []
    i = int(np.argmax(np.where(off, np.nan_to_num(np.abs(a - b), nan=np.inf), -1.0)))
    return [Differs(f"{name}: {int(off.sum())} rows, worst", float(a[i]), float(b[i]))]


def compare_runs(old: Path, new: Path) -> tuple[int, list[Differs], list[str]]:
    """Everything that two runs of one scene left behind."""
    compared, differ, lost = compare_reports(*(json.loads((f / "report.json").read_text()) for f in (old, new)))
    names = ("samples.parquet",)
    if all((f / n).exists() for f in (old, new) for n in names):
        more = compare_samples(old / names[0], new / names[0])
        compared, differ, lost = compared + more[0], differ + more[1], lost + more[2]
    for text in sorted(f.name for f in old.iterdir() if f.suffix in (".cl", ".nc", ".csv")):
        same = (new / text).exists() and (new / text).read_bytes() == (old / text).read_bytes()
        differ += [] if same else [Differs(text, np.nan, np.nan)]
    return compared, differ, lost
