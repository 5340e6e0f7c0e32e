"""One contact under several tools: figures and its curvature picture."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any

from gearsim.gouging.choice import ContactMeasurement
from gearsim.output.gouging.curvature import draw_curvatures
from gearsim.output.gouging.plots import run_sheet
from gearsim.output.gouging.words import tool_words
from gearsim.output.saving import Chart
from gearsim.output.summary import number
from gearsim.result import Result


def files(*_: Any) -> list[str]:
    return ["curvature.png"]


def figures(m: ContactMeasurement) -> dict[str, Any]:
    p = m.plotted
    return {
        "u": p.u,
        "v": p.v,
        "place_mm": [float(x) for x in p.point],
        "least_difference_per_mm": {name: number(float(t.comparison.least[0])) for name, t in p.tools.items()},
    }


def charts(result: Result, found: Sequence[ContactMeasurement]) -> list[Chart]:
    tools = found[0].plotted.tools
    labels = {name: f"{name}: {tool_words(result.job.variant(name).cutter)}" for name in tools}
    sheet = run_sheet(result.name, tools, labels)
    if not sheet.plots:
        return []
    draw = partial(draw_curvatures, sheet.plots, sheet.heading, sheet.zero, sheet.file)
    return [Chart(sheet.file, "Normal curvature of tool and part over the direction at the plotted contact", draw)]
