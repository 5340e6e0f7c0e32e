"""Write everything a run leaves behind into a folder: one writer, whatever was made and measured."""

from __future__ import annotations

import json
from collections.abc import Iterator
from fnmatch import fnmatchcase
from math import inf
from pathlib import Path

from gearsim.errors import InputError
from gearsim.output.charts import all_charts
from gearsim.output.columns import Column
from gearsim.output.exr import stated, write_exr
from gearsim.output.files import LAST
from gearsim.output.markdown import write_report
from gearsim.output.painting import Painters
from gearsim.output.presenters import collected
from gearsim.output.report import report_text
from gearsim.output.summary import summary, write_json
from gearsim.output.table import write_parquet
from gearsim.output.wanted import Wanted
from gearsim.result import Result

REPORTS = (LAST, "report.md", "report.html")
SAMPLES = "samples.parquet"


def write_result(result: Result, stage: Path, painters: Painters | None = None) -> list[str]:
    """Write the files of a run into a scratch folder; returns what could not be drawn, one line each.

    ``painters`` are the drawing processes, where they were started ahead of time; they know what is wanted, by default
    everything. Raises InputError for a name or pattern that is wanted and that no file of this run bears.
    """
    painters = painters or Painters()
    wanted = painters.wanted
    _refuse_unknown(result, wanted)
    painters.draw(result, stage)
    _write_data(result, stage, wanted)
    captions, missing = painters.finish()
    if any(map(wanted.file, REPORTS)):
        _write_reports(result, stage, wanted, captions, missing)
    return missing


def _refuse_unknown(result: Result, wanted: Wanted) -> None:
    unknown = set(wanted.only)
    for name in _all_names(result, wanted) if unknown else ():
        unknown -= {pattern for pattern in unknown if fnmatchcase(name, pattern)}
        if not unknown:
            return
    if unknown:
        known = ", ".join(sorted(_all_names(result, wanted)))
        raise InputError(f"--only {', '.join(sorted(unknown))}: no file of this run has that name; there are {known}")


def _all_names(result: Result, wanted: Wanted) -> Iterator[str]:
    """Every file the run could leave, apart from formats that were not asked for; the cheapest to tell first."""
    yield from REPORTS
    yield from result.job.files
    yield from _maps(result)
    if wanted.pictures:
        for chart in all_charts(result):
            yield from wanted.chart_files(chart.file)
    if _tables(result):
        yield SAMPLES
    if wanted.pictures:
        from gearsim.output.drawer import solid_files

        yield from solid_files(result)


def _write_reports(
    result: Result, stage: Path, wanted: Wanted, captions: dict[str, str], missing: list[str]
) -> None:  # fmt: skip
    figures = summary(result)
    figures["not_drawn"] = missing
    names = _names(stage) + [LAST] * wanted.file(LAST)
    write_report(report_text(result, figures, captions, names), result.name, stage, wanted)
    if wanted.file(LAST):
        write_json(figures, stage / LAST)


def _write_data(result: Result, stage: Path, wanted: Wanted) -> None:
    notes = stated(result) | {"settings": json.dumps(result.scene, default=str)}
    for name, parts in _maps(result).items():
        if wanted.file(name):
            write_exr(parts, notes, stage / name, _tolerance_um(result))
    tables = _tables(result) if wanted.file(SAMPLES) else []
    if tables:
        write_parquet(tables, result, stage / SAMPLES)
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
