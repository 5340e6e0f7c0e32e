"""What a study's summary says in words and tables, as Markdown."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from gearsim.output.markdown import table, um
from gearsim.studies.chunk import tables_of
from gearsim.studies.importance import DRAWN
from gearsim.studies.records import Parameter, Study, Value
from gearsim.studies.summary_figures import Told, label, micro

_SPECIAL = re.compile(r"([\\`*_{}\[\]<>#+!|~])")
_VERDICTS = ("pass", "fail", "unchecked", "error")
_MOST_KEYS = 40
_MOST_ERRORS = 10
_TEXT = 400  # characters of an error


def plain(text: str) -> str:
    """A user's text with nothing in it that Markdown reads, in one line."""
    return _SPECIAL.sub(r"\\\1", " ".join(text.split()))


def head(told: Told) -> str:
    """The study's name, what came of its jobs, what was asked, and what its signs mean."""
    study = told.study
    counts = {v: int((told.verdicts == v).sum()) for v in _VERDICTS}
    summed = ", ".join(f"{n:,} {v}" for v, n in counts.items() if n)
    scene = str(_header(study).get("scene", ""))
    checked = int(np.nan_to_num(told["cross_checked"].astype(float)).sum())
    rows = [
        ["scene", f"`{scene}`" if scene else "given as tables"],
        ["values by", f"{study.method}, seed {study.seed}" if study.method in DRAWN else study.method],
        ["measured", ", ".join(study.asked.measure)],
        ["cross-checked by both roads", _of(checked, len(study))],
    ]
    if "within_tolerance" in told.columns:
        within = int(np.nansum(told["within_tolerance"].astype(float)))
        rows.append(["within tolerance by the removal road", _of(within, len(study))])
    return (
        f"# {plain(study.name)}\n\n{plain(study.summary)}\n\n**{_jobs(len(study))}**: {summed}.\n\n{_unchecked(counts)}"
        "Deviation is measured along the outward normal of the intended surface: **positive is material left, "
        f"negative is overcut**.\n\n{table(['Study', ''], rows)}\n{_parameters(study)}"
    )


def _unchecked(counts: Mapping[str, int]) -> str:
    if not counts["unchecked"]:
        return ""
    return (
        "Of unchecked jobs some road, or part of it, is missing: their figures stand, but nothing passes by them.\n\n"
    )


def _of(some: int, all_: int) -> str:
    return f"{some:,} of {all_:,} jobs"


def _jobs(n: int) -> str:
    return "1 job" if n == 1 else f"{n:,} jobs"


def _header(study: Study) -> Mapping[str, Any]:
    header = study.source.get("study", {})
    return header if isinstance(header, Mapping) else {}


def _parameters(study: Study) -> str:
    rows = [_parameter(p) for p in study.parameters[:_MOST_KEYS]]
    more = len(study.parameters) - len(rows)
    rest = f"\n{more} more parameters are in jobs.parquet.\n" if more else ""
    return table(["Parameter", "unit", "lowest", "median", "highest", "values"], rows) + rest


def _parameter(p: Parameter) -> list[Any]:
    different = len(set(p.values))
    if any(isinstance(v, str | bool) for v in p.values):
        words = list(dict.fromkeys(_toml(v) for v in p.values))
        return [f"`{p.key}`", "", "", "", "", plain(", ".join(words[:6]) + ", ..." * (len(words) > 6))]
    values = np.array(p.values, dtype=float)
    ends = [f"{x:.6g}" for x in (values.min(), np.median(values), values.max())]
    return [f"`{p.key}`", "" if p.unit == "1" else micro(p.unit), *ends, f"{different:,}"]


def distributions(told: Told) -> str:
    """Quantiles of every figure, and how many jobs are beyond its tolerance."""
    drawn = told.study.method in DRAWN
    rows = []
    for figure in told.figures:
        values = told[figure][np.isfinite(told[figure])]
        at = np.quantile(values, [0.0, 0.05, 0.5, 0.95, 1.0])
        rows.append([label(figure), *map(um, at), _limits(told, figure), _beyond(told, figure, len(values), drawn)])
    quantiles = ["lowest", "5 %", "median", "95 %", "highest"]
    return table(["Over the jobs [µm]", *quantiles, "tolerance", "beyond"], rows)


def _limits(told: Told, figure: str) -> str:
    low, high = told.frame.limits(figure)
    if not np.isfinite([low, high]).any():
        return "–"
    return f"±{high:g}" if low == -high else f"{low:g} to {high:g}".replace("-", "−").replace("inf", "∞")


def _beyond(told: Told, figure: str, count: int, drawn: bool) -> str:
    if not np.isfinite(told.frame.limits(figure)).any():
        return "–"
    beyond = int(told.beyond(figure).sum())
    if not drawn:
        return f"{beyond:,} of {count:,}"
    low, high = share_interval(beyond, count)
    return f"{beyond:,} of {count:,} ({100.0 * low:.2g} to {100.0 * high:.2g} %)"


def share_interval(hits: int, count: int) -> tuple[float, float]:
    """The 95 % interval of a share after Clopper and Pearson, Biometrika 26 (1934) 404-413."""
    from scipy.stats import beta

    low = 0.0 if hits == 0 else float(beta.ppf(0.025, hits, count - hits + 1))
    high = 1.0 if hits == count else float(beta.ppf(0.975, hits + 1, count - hits))
    return low, high


def failures(told: Told) -> str:
    """Errors by their text: how many jobs have each, and how to see the first again."""
    found: dict[str, list[int]] = {}
    for job in np.flatnonzero(told.verdicts == "error"):
        found.setdefault(" ".join(str(told["error"][job]).split()), []).append(int(job))
    if not found:
        return ""
    out = [f"## Jobs that could not be done: {sum(map(len, found.values())):,}\n"]
    for text, jobs in sorted(found.items(), key=lambda item: -len(item[1]))[:_MOST_ERRORS]:
        listed = ", ".join(map(str, jobs[:8])) + ", ..." * (len(jobs) > 8)
        cut = text[:_TEXT] + " ..." * (len(text) > _TEXT)
        out.append(f"**{_jobs(len(jobs))}** ({listed}): {plain(cut)}\n\n{command(told.study, jobs[0])}")
    more = len(found) - _MOST_ERRORS
    return "\n".join([*out, f"{more} more errors are in jobs.parquet.\n" * (more > 0)])


def worst(told: Told, job: int) -> str:
    """A job among the worst: its verdict, its figures beyond their tolerance or else the largest, its values."""
    held = [f for f in told.figures if np.isfinite(told.frame.limits(f)).any()] or told.figures
    order = sorted(held, key=lambda f: -float(np.nan_to_num(told.use(f)[job])))[:3]
    said = "; ".join(f"{label(f)} {um(float(told[f][job]))} µm{_tolerated(told, f)}" for f in order)
    lost = int(told.unmeasured()[job])
    bounds = f"; {lost:,} samples are uncut or cut through: there is a bound in place of a deviation" * (lost > 0)
    return f"### Job {job}: {told.verdicts[job]}\n\n{said}{bounds}.\n\n{command(told.study, job)}"


def _tolerated(told: Told, figure: str) -> str:
    text = _limits(told, figure)
    return "" if text == "–" else f" (tolerance {text})"


def command(study: Study, job: int) -> str:
    """What runs a job alone, as a block of code; empty where the study has no scene by name."""
    scene = _header(study).get("scene")
    if not scene:
        return ""
    settings = [f"--set {shlex.quote(f'{key}={_toml(value)}')}" for key, value in _settings(study, job).items()]
    return "```sh\n" + " \\\n  ".join([f"gearsim run {shlex.quote(str(scene))}", *settings]) + "\n```\n"


def _settings(study: Study, job: int) -> dict[str, Any]:
    """A job's values by dotted key; of a place in a list the whole list, which is what ``gearsim run`` can set."""
    tables = tables_of(study, job)
    given = {**_flat(_header(study).get("set", {})), **study.values_of(job)}
    return dict(_whole(tables, key, value) for key, value in given.items())


def _whole(tables: Mapping[str, Any], key: str, value: Any) -> tuple[str, Any]:
    """The first list on the way to a key, with its own key; else the key and its value."""
    at: Any = tables
    way: list[str] = []
    for part in key.split("."):
        at = at.get(part)
        way.append(part)
        if not isinstance(at, Mapping):
            break
    return (".".join(way), at) if isinstance(at, list) else (key, value)


def _flat(tables: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    """Nested tables as values by dotted key."""
    out: dict[str, Any] = {}
    for key, value in tables.items():
        out |= _flat(value, f"{before}{key}.") if isinstance(value, Mapping) else {f"{before}{key}": value}
    return out


def _toml(value: Value | Sequence[Any] | Mapping[str, Any]) -> str:
    """A value as TOML has it."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key} = {_toml(v)}" for key, v in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_toml, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
