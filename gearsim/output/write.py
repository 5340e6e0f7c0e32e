"""Write everything a run leaves behind into a folder: one writer, whatever was made and measured."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.output.exr import header, write_exr
from gearsim.output.markdown import write_report
from gearsim.output.painting import Painters
from gearsim.output.presenters import collected
from gearsim.output.report import report_text
from gearsim.output.summary import summary, write_json
from gearsim.output.table import write_parquet
from gearsim.result import Result


@dataclass(frozen=True)
class Wanted:
    """What to write: pictures or none, and in which ``formats`` beside PNG (svg, pdf)."""

    pictures: bool = True
    formats: tuple[str, ...] = ()


def write_result(
    result: Result, stage: Path, wanted: Wanted = Wanted(), painters: Painters | None = None
) -> list[str]:  # fmt: skip
    """Write all files of a run into a scratch folder; returns what could not be drawn, one line each.

    ``painters`` are the drawing processes, where they were started ahead of time.
    """
    painters = painters or (Painters() if wanted.pictures else None)
    if painters is not None:
        painters.draw(result, stage, wanted.formats)
    _write_data(result, stage)
    captions, missing = painters.finish() if painters is not None else ({}, [])
    figures = summary(result)
    figures["not_drawn"] = missing
    text = report_text(result, figures, captions, _names(stage))
    write_report(text, result.name, stage)
    write_json(figures, stage / "report.json")
    return missing


def _write_data(result: Result, stage: Path) -> None:
    main = f"deviation.um and segment.id are under {result.job.main}; NAME.deviation.um under NAME"
    for name, parts in _maps(result).items():
        write_exr(parts, header(result.name, result.frame, program=main), stage / name)
    tables = [table for tables in collected(result, "rows") for table in tables]
    for more in collected(result, "columns"):
        for table in tables:
            table |= {name: np.ravel(values) for name, values in more.get(str(table["surface"][0]), {}).items()}
    if tables:
        write_parquet(tables, result, stage / "samples.parquet")
    for name, text in result.job.files.items():
        (stage / name).write_text(text, encoding="utf-8")


def _maps(result: Result) -> dict[str, dict[str, dict[str, NDArray]]]:
    """The channels that all presenters give, by file and part."""
    files: dict[str, dict[str, dict[str, NDArray]]] = {}
    for given in collected(result, "maps"):
        for file, parts in given.items():
            for part, channels in parts.items():
                files.setdefault(file, {}).setdefault(part, {}).update(channels)
    return files


def _names(stage: Path) -> list[str]:
    names: Sequence[str] = [f.name for f in stage.iterdir() if not f.name.startswith("_")]
    return sorted([*names, "report.json"])
