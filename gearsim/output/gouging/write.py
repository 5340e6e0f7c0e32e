"""Write what runs of local gouging leave behind, all but the report's common parts."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from gearsim.gouging.khan_sizes import SideBySide
from gearsim.output.drawer import DATA, finish_drawing, start_drawing
from gearsim.output.exr import write_exr
from gearsim.output.gouging.charts import draw_deviation, draw_flat_rule, draw_sizes
from gearsim.output.gouging.curvature import draw_curvatures
from gearsim.output.gouging.drawing import write_drawing
from gearsim.output.gouging.maps import cut_channels, cut_columns, size_channels
from gearsim.output.gouging.plots import Sheet, example_sheets, run_sheet
from gearsim.output.gouging.summary import tool_words, whole_figures
from gearsim.output.table import write_parquet
from gearsim.result import GougeExampleResult, SculpturedResult


def write_sculptured(result: SculpturedResult, stage: Path) -> list[str]:
    """Maps, table and pictures; returns what could not be drawn."""
    labels = {name: f"{name} tool: {tool_words(cut.cutter)}" for name, cut in result.cuts.items()}
    write_drawing(result, labels, stage / DATA)
    drawing = start_drawing(stage)
    write_exr({n: cut_channels(result.grid, c) for n, c in result.cuts.items()}, result, stage / "deviation.exr")
    write_exr({"tool_size": size_channels(result.sizes)}, result, stage / "tool_size.exr")
    write_parquet([cut_columns(result, name) for name in result.cuts], result, stage / "samples.parquet")
    draw_deviation(result, labels, stage / "deviation.png")
    notes = size_notes(result.sizes.whole, result.sizes.place)
    draw_sizes(result.sizes, f"{result.name}: largest mill of the catalogue", notes, stage / "tool_size.png")
    _draw_sheet(run_sheet(result.name, result.plotted.tools, labels), stage)
    return finish_drawing(drawing, stage, ["surface.png"])


def write_examples(result: GougeExampleResult, stage: Path) -> dict[str, str]:
    """Curvature pictures of the worked examples; returns their captions by file name."""
    captions = {}
    for sheet in example_sheets(result.sections):
        _draw_sheet(sheet, stage)
        captions[sheet.file] = f"{sheet.heading}: normal curvature of tool and part, gouging directions shaded"
    if "6.3" in result.sections:
        draw_flat_rule(stage / "flat-end-mill.png")
        captions["flat-end-mill.png"] = "Khan 6.3: the largest flat end mill in a bowl, as printed and rightly"
    return captions


def size_notes(whole: SideBySide | None, place: Sequence[float] = ()) -> list[str]:
    """Thesis and optimum in a line; ``place`` [mm] limits them."""
    figures = whole_figures(whole, place)
    if not figures:
        return ["no mill of the catalogue reaches any point"]
    words = []
    for name, key in (("the thesis's algorithm", "thesis"), ("true optimum", "optimum")):
        mill = figures[key]
        gouges = " (gouges)" if mill.get("gouges") else ""
        size = "none" if mill["shank_mm"] is None else f"R = {mill['shank_mm']:g}, r = {mill['corner_mm']:.4g} mm"
        words.append(f"{name}: {size}{gouges}")
    notes = ["one mill for the whole surface: " + "; ".join(words)]
    if figures["optimum"]["shank_mm"] is None:
        at = f", not at ({', '.join(f'{x:.4g}' for x in place)}) mm" if place else ""
        notes.append(f"no mill of the catalogue fits everywhere{at}")
    return notes


def _draw_sheet(sheet: Sheet, stage: Path) -> None:
    if sheet.plots:
        draw_curvatures(sheet.plots, sheet.heading, sheet.zero, stage / sheet.file)
