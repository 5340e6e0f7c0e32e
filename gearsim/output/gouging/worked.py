"""Worked examples: figures, printed numbers beside ours, their curvature pictures."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from rich.console import Console

from gearsim.gouging.khan.inspection import WorkedInspection, WorkedMeasurement
from gearsim.output.gouging.charts import draw_flat_rule
from gearsim.output.gouging.curvature import draw_curvatures
from gearsim.output.gouging.plots import example_sheets
from gearsim.output.markdown import table
from gearsim.output.saving import Chart
from gearsim.result import Result

_FLAT_RULE = "6.3"  # the section with a picture of its own


def files(_: Any, asked: Sequence[WorkedInspection]) -> list[str]:
    if not asked[0].alone:
        return []
    sections = asked[0].sections
    flat = ["flat-end-mill.png"] if _FLAT_RULE in sections else []
    return [*(sheet.file for sheet in example_sheets(sections) if sheet.plots), *flat]


def figures(m: WorkedMeasurement) -> dict[str, Any]:
    return {
        "agree": sum(r.agrees for r in m.rows),
        "differ": sum(not r.agrees for r in m.rows),
        "rows": [r._asdict() for r in m.rows],
    }


def sections(_: Result, found: Sequence[WorkedMeasurement]) -> dict[str, str]:
    return {"beside": worked_section(figures(found[0]))}


def worked_section(worked: dict[str, Any]) -> str:
    """Printed numbers beside ours."""
    if not worked["rows"]:
        return ""
    rows = [[r["section"], r["quantity"], r["printed"], r["ours"], r["verdict"]] for r in worked["rows"]]
    return f"## Beside the thesis\n\n{worked['agree']} of {len(rows)} printed results reproduce.\n\n" + table(
        ["Section", "quantity", "printed", "ours", "verdict"], rows
    )


def charts(_: Result, found: Sequence[WorkedMeasurement]) -> list[Chart]:
    """Curvature pictures of the worked examples, where they are all the job is about."""
    if not found[0].drawn:
        return []
    offered = [
        Chart(
            sheet.file, f"{sheet.heading}: normal curvature of tool and part, gouging directions shaded",
            partial(draw_curvatures, sheet.plots, sheet.heading, sheet.zero, sheet.file),
        )
        for sheet in example_sheets(found[0].sections)
        if sheet.plots
    ]  # fmt: skip
    if _FLAT_RULE in found[0].sections:
        caption = "Khan 6.3: the largest flat end mill in a bowl, as printed and rightly"
        offered.append(Chart("flat-end-mill.png", caption, draw_flat_rule))
    return offered


def screen(_: Result, found: Sequence[WorkedMeasurement], console: Console) -> None:
    rows = found[0].rows
    console.print(f"{sum(r.agrees for r in rows)} of {len(rows)} printed results reproduce")
    for r in rows:
        if not r.agrees:
            console.print(f"  {r.section} {r.quantity}: printed {r.printed}, ours {r.ours}: {r.verdict}", markup=False)
