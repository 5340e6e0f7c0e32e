"""Write everything a run leaves behind into a folder."""

from __future__ import annotations

from pathlib import Path

from gearsim.output.charts import draw_deviation, draw_profile
from gearsim.output.draw import DATA, finish_drawing, start_drawing
from gearsim.output.drawing import write_drawing
from gearsim.output.exr import grid_channels, write_exr
from gearsim.output.markdown import write_report
from gearsim.output.report import PICTURES, flank_milling_report
from gearsim.output.summary import summary, write_json
from gearsim.output.table import flank_columns, write_parquet
from gearsim.result import FlankMillingResult


def write_result(result: FlankMillingResult, stage: Path) -> list[str]:
    """Write all files of a run into a scratch folder; returns what could not be drawn, one line each."""
    write_drawing(result, stage / DATA)
    drawing = start_drawing(stage)
    flanks = result.flanks
    parts = {s: grid_channels(f.grid, f.all_passes, f.gap_cl.gap_um) for s, f in flanks.items()}
    write_exr({str(s): p for s, p in parts.items()}, result, stage / "deviation.exr")
    write_parquet([flank_columns(result, f) for f in flanks.values()], result, stage / "samples.parquet")
    (stage / "toolpath.cl").write_text(result.cl_text, encoding="utf-8")
    draw_deviation(result, stage / "deviation.png")
    draw_profile(result, stage / "profile.png")
    missing = finish_drawing(drawing, stage)
    (stage / DATA).unlink()
    report = summary(result)
    report["not_drawn"] = missing
    drawn = [name for name in PICTURES if (stage / name).exists()]
    write_report(flank_milling_report(report, drawn, missing), result.name, stage)
    write_json(report, stage / "report.json")
    return missing
