"""Write everything a run leaves behind into a folder: one writer, whatever was made and measured."""

from __future__ import annotations

import json
from collections.abc import Sequence
from fnmatch import fnmatchcase
from math import inf
from pathlib import Path

from gearsim.errors import InputError
from gearsim.metrology.job import Job
from gearsim.output.columns import Column
from gearsim.output.drawer import FRAGMENT, PICTURES
from gearsim.output.exr import stated, write_exr
from gearsim.output.files import LAST, MESHES, PART, SAMPLES, VIEW
from gearsim.output.markdown import write_report
from gearsim.output.painting import Painters
from gearsim.output.presenters import collected, promised
from gearsim.output.report import report_text
from gearsim.output.summary import summary, write_json
from gearsim.output.table import write_columns
from gearsim.output.wanted import Wanted
from gearsim.result import Result

REPORTS = (LAST, "report.md", "report.html")


def write_result(result: Result, stage: Path, painters: Painters | None = None) -> list[str]:
    """Write the files of a run into a scratch folder; returns what could not be drawn, one line each.

    ``painters`` are the drawing processes, where they were started ahead of time; they know what is wanted, by default
    everything. A name that is wanted and that the job promised, but that nothing came of, is one of those lines.
    """
    painters = painters or Painters()
    wanted = painters.wanted
    painters.draw(result, stage)
    _write_data(result, stage, wanted)
    captions, missing = painters.finish()
    view = _taken(stage / FRAGMENT)
    missing += _empty(result, stage, wanted)
    if VIEW in wanted.only and not view:
        missing.append(f"{VIEW}: nothing to show in it")
    if any(map(wanted.file, REPORTS)):
        _write_reports(result, stage, wanted, captions, missing, view)
    return missing


def _taken(file: Path) -> str:
    """The text of a file that is then gone; nothing where there is none."""
    text = file.read_text(encoding="utf-8") if file.exists() else ""
    file.unlink(missing_ok=True)
    return text


def refuse_unknown(job: Job, wanted: Wanted) -> None:
    """Raises InputError for a name or pattern that is wanted and that no file of a job's run can bear."""
    if not wanted.only:
        return
    there = promised(job)
    names = [*REPORTS, *job.files, *_formats(there, wanted)] + [VIEW] * (
        wanted.pictures and bool({MESHES, PART} & {*there})
    )
    unknown = [pattern for pattern in wanted.only if not any(fnmatchcase(name, pattern) for name in names)]
    if unknown:
        known = ", ".join(sorted(names))
        raise InputError(f"--only {', '.join(unknown)}: no file of this run has that name; there are {known}")
    if VIEW in wanted.only and not wanted.file("report.html"):
        raise InputError(f"--only {VIEW}: the view stands in report.html, which is not wanted; add report.html")


def _formats(names: Sequence[str], wanted: Wanted) -> list[str]:
    """Names, those of charts in all formats that are asked for; without pictures where none are wanted."""
    out = [name for name in names if not name.endswith(".png")]
    solid = {picture.file for picture in PICTURES}
    for name in names if wanted.pictures else ():
        if name.endswith(".png"):
            out += [name] if name in solid else wanted.chart_files(name)
    return out


def _empty(result: Result, stage: Path, wanted: Wanted) -> list[str]:
    """Names that are wanted, one by one, and promised by the job, and that nothing came of."""
    named = [name for name in _formats(promised(result.job), wanted) if name in wanted.only]
    return [f"{name}: nothing to show in it" for name in named if not (stage / name).exists()]


def _write_reports(
    result: Result, stage: Path, wanted: Wanted, captions: dict[str, str], missing: list[str], view: str
) -> None:  # fmt: skip
    figures = summary(result)
    figures["not_drawn"] = missing
    names = _names(stage) + [LAST] * wanted.file(LAST)
    text = report_text(result, figures, captions, names, bool(view))
    write_report(text, result.name, stage, wanted, view)
    if wanted.file(LAST):
        write_json(figures, stage / LAST)


def _write_data(result: Result, stage: Path, wanted: Wanted) -> None:
    notes = stated(result) | {"settings": json.dumps(result.scene, default=str)}
    for name, parts in _maps(result).items():
        if wanted.file(name):
            write_exr(parts, notes, stage / name, _tolerance_um(result))
    tables = _tables(result) if wanted.file(SAMPLES) else []
    if tables:
        write_columns(tables, result, stage / SAMPLES)
    for given in collected(result, "data"):
        for name, write in given.items():
            if wanted.file(name):
                write(stage / name)
    for name, text in result.job.files.items():
        if wanted.file(name):
            (stage / name).write_text(text, encoding="utf-8")


def _tolerance_um(result: Result) -> float:
    """The tightest tolerance of all surfaces, inf where there is none."""
    given = (s.tolerance for s in result.job.part.surfaces.values() if s.tolerance is not None)
    return min((um for t in given for um in (t.overcut_um, t.excess_um) if um > 0.0), default=inf)


def _tables(result: Result) -> list[dict[str, Column]]:
    """The columns that all presenters give, one table a surface."""
    tables = [table for tables in collected(result, "rows") for table in tables]
    for more in collected(result, "columns"):
        for table in tables:
            table |= more.get(str(table["surface"].values.flat[0]), {})
    return tables


def _maps(result: Result) -> dict[str, dict[str, dict[str, Column]]]:
    """The channels that all presenters give, by file and part."""
    files: dict[str, dict[str, dict[str, Column]]] = {}
    for given in collected(result, "maps"):
        for file, parts in given.items():
            for part, channels in parts.items():
                files.setdefault(file, {}).setdefault(part, {}).update(channels)
    return files


def _names(stage: Path) -> list[str]:
    return sorted(f.name for f in stage.iterdir() if not f.name.startswith("_"))
