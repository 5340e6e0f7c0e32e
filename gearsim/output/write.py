"""Write everything a run leaves behind into a folder."""

from __future__ import annotations

from pathlib import Path

from gearsim.output.charts import draw_deviation, draw_profile
from gearsim.output.draw import DATA, finish_drawing, start_drawing
from gearsim.output.drawing import write_drawing
from gearsim.output.exr import write_exr
from gearsim.output.report import write_report
from gearsim.output.summary import summary, write_json
from gearsim.output.table import write_parquet
from gearsim.result import Result


def write_result(result: Result, stage: Path) -> list[str]:
    """Write all files of a run into a scratch folder; returns what could not be drawn, one line each."""
    write_drawing(result, stage / DATA)
    drawing = start_drawing(stage)
    write_exr(result, stage / "deviation.exr")
    write_parquet(result, stage / "samples.parquet")
    (stage / "toolpath.cl").write_text(result.cl_text, encoding="utf-8")
    draw_deviation(result, stage / "deviation.png")
    draw_profile(result, stage / "profile.png")
    missing = finish_drawing(drawing, stage)
    (stage / DATA).unlink()
    report = summary(result)
    report["not_drawn"] = missing
    write_report(report, stage, missing)
    write_json(report, stage / "report.json")
    return missing
