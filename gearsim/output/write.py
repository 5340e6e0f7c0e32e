"""Write everything a run leaves behind into a folder."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from gearsim.output import charts, report
from gearsim.output.cylindrical import charts as cylindrical_charts
from gearsim.output.cylindrical import drawing as cylindrical_drawing
from gearsim.output.cylindrical import report as cylindrical_report
from gearsim.output.cylindrical import summary as cylindrical_summary
from gearsim.output.cylindrical.maps import map_channels, map_columns
from gearsim.output.drawer import DATA, finish_drawing, start_drawing
from gearsim.output.drawing import write_drawing
from gearsim.output.exr import grid_channels, write_exr
from gearsim.output.generating import charts as generating_charts
from gearsim.output.generating import drawing as generating_drawing
from gearsim.output.generating import report as generating_report
from gearsim.output.generating import summary as generating_summary
from gearsim.output.generating.maps import surface_channels, surface_columns
from gearsim.output.gouging import report as gouging_report
from gearsim.output.gouging import summary as gouging_summary
from gearsim.output.gouging.write import write_examples, write_sculptured
from gearsim.output.markdown import write_report
from gearsim.output.summary import summary, write_json
from gearsim.output.table import flank_columns, write_parquet
from gearsim.result import (
    FlankMillingResult,
    GearResult,
    GeneratingResult,
    GougeExampleResult,
    Result,
    SculpturedResult,
)


def write_result(result: Result, stage: Path) -> list[str]:
    """Write all files of a run into a scratch folder; returns what could not be drawn, one line each."""
    if isinstance(result, FlankMillingResult):
        return _write_flank_milling(result, stage)
    if isinstance(result, GearResult):
        return _write_gear(result, stage)
    if isinstance(result, SculpturedResult):
        return _write_sculptured(result, stage)
    if isinstance(result, GougeExampleResult):
        return _write_examples(result, stage)
    assert isinstance(result, GeneratingResult)
    return _write_generating(result, stage)


def _write_flank_milling(result: FlankMillingResult, stage: Path) -> list[str]:
    write_drawing(result, stage / DATA)
    drawing = start_drawing(stage)
    parts = {str(s): grid_channels(f.grid, f.all_passes, f.gap_cl.gap_um) for s, f in result.flanks.items()}
    write_exr(parts, result, stage / "deviation.exr")
    write_parquet([flank_columns(result, f) for f in result.flanks.values()], result, stage / "samples.parquet")
    (stage / "toolpath.cl").write_text(result.cl_text, encoding="utf-8")
    if result.nc_text:
        (stage / "program.nc").write_text(result.nc_text, encoding="ascii")
    charts.draw_deviation(result, stage / "deviation.png")
    charts.draw_profile(result, stage / "profile.png")
    missing = finish_drawing(drawing, stage, list(report.PICTURES))
    figures = summary(result)
    text = report.flank_milling_report(figures, _drawn(stage), missing)
    return _write_figures(figures, text, missing, stage)


def _write_generating(result: GeneratingResult, stage: Path) -> list[str]:
    generating_drawing.write_drawing(result, stage / DATA)
    drawing = start_drawing(stage)
    parts = {name: surface_channels(result, s) for name, s in result.surfaces.items()}
    write_exr(parts, result, stage / "deviation.exr")
    write_parquet([surface_columns(result, s) for s in result.surfaces.values()], result, stage / "samples.parquet")
    for name, text in result.programs.items():
        (stage / name).write_text(text, encoding="utf-8")
    generating_charts.draw_deviations(result, stage / "deviation.png")
    generating_charts.draw_axes(result, stage / "axes.png")
    expected = ["envelope.png"] + (["slot.png"] if result.dexels else [])
    missing = finish_drawing(drawing, stage, expected)
    figures = generating_summary.summary(result)
    text = generating_report.generating_report(figures, list(result.programs), _drawn(stage), missing)
    return _write_figures(figures, text, missing, stage)


def _write_gear(result: GearResult, stage: Path) -> list[str]:
    cylindrical_drawing.write_drawing(result, stage / DATA)
    drawing = start_drawing(stage)
    parts = {side: map_channels(surface) for side, surface in result.maps.items()}
    write_exr(parts, result, stage / "deviation.exr")
    write_parquet([map_columns(surface) for surface in result.maps.values()], result, stage / "samples.parquet")
    (stage / "program.nc").write_text(result.program, encoding="utf-8")
    cylindrical_charts.draw_charts(result, stage)
    missing = finish_drawing(drawing, stage, ["gear.png"])
    figures = cylindrical_summary.summary(result)
    text = cylindrical_report.gear_report(figures, _drawn(stage), missing)
    return _write_figures(figures, text, missing, stage)


def _write_sculptured(result: SculpturedResult, stage: Path) -> list[str]:
    missing = write_sculptured(result, stage)
    figures = gouging_summary.summary(result)
    text = gouging_report.sculptured_report(figures, _drawn(stage), missing)
    return _write_figures(figures, text, missing, stage)


def _write_examples(result: GougeExampleResult, stage: Path) -> list[str]:
    captions = write_examples(result, stage)
    figures = gouging_summary.summary(result)
    return _write_figures(figures, gouging_report.examples_report(figures, captions), [], stage)


def _drawn(stage: Path) -> list[str]:
    return sorted(file.name for file in stage.glob("*.png"))


def _write_figures(figures: dict[str, Any], text: str, missing: list[str], stage: Path) -> list[str]:
    (stage / DATA).unlink(missing_ok=True)
    figures["not_drawn"] = missing
    write_report(text, figures["scene"]["scene"]["name"], stage)
    write_json(figures, stage / "report.json")
    return missing
