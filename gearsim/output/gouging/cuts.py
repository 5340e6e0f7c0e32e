"""Surfaces cut by tools with their gouging predicted: figures, sections, gouging.png, maps, samples, surface.png."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from gearsim.cutters.contact import locate
from gearsim.gouging.attribution import Cause
from gearsim.gouging.choice import ContactMeasurement
from gearsim.gouging.compare import Decision
from gearsim.gouging.inspection import GougingMeasurement, ToolCut
from gearsim.output.columns import CAUSES, Column, key_of_numbers, key_of_words, known, words
from gearsim.output.gouging.charts import draw_cuts
from gearsim.output.gouging.words import tool_words
from gearsim.output.layers import outline, patch_arrays
from gearsim.output.markdown import table, um
from gearsim.output.presenters import slug
from gearsim.output.saving import Chart
from gearsim.output.summary import number, worst_at
from gearsim.result import Result
from gearsim.surfaces.nurbs import NurbsSurface


def files(*_: Any) -> list[str]:
    return ["gouging.png", "surface.png"]


def figures(m: GougingMeasurement) -> dict[str, Any]:
    return _tool(m.cut)


def _tool(cut: ToolCut) -> dict[str, Any]:
    rings, decision = cut.rings, cut.contacts.decision
    over, predicted = cut.made.cause > 0, cut.samples.gouges.reshape(cut.grid.shape)
    worst = np.abs(rings.found - rings.predicted)[~rings.near]
    return {
        "tool": tool_words(cut.cutter),
        "contacts": len(cut.path),
        "passes": len(cut.path.runs),
        "segments": cut.segments,
        "chord_um": 1e3 * cut.path.chord,
        "contacts_free": int(np.count_nonzero(decision == Decision.FREE)),
        "contacts_tie": int(np.count_nonzero(decision == Decision.TIE)),
        "contacts_gouging": int(np.count_nonzero(decision == Decision.GOUGES)),
        "deviation_um": cut.deviation.summary_um(),
        "worst_at": worst_at(cut.grid, cut.deviation),
        "overcut_samples": {c.name.lower(): cut.made.count(c) for c in Cause if c != Cause.NONE},
        "samples_predicted_and_overcut": int(np.count_nonzero(over & predicted)),
        "samples_predicted_not_overcut": int(np.count_nonzero(~over & predicted)),
        "samples_overcut_not_predicted_there": int(np.count_nonzero(over & ~predicted)),
        "cut_alone": {
            "contacts": len(rings.contact),
            "gouge": int(rings.gouging.sum()),
            "too_near_a_tie": int(rings.near.sum()),
            "disagree": int(rings.disagree.sum()),
            "largest_error_per_mm": number(float(worst.max())) if len(worst) else None,
        },
        "machined_points_off_tool_um": cut.check_um,
    }


def sections(_: Result, found: Sequence[GougingMeasurement]) -> dict[str, str]:
    tools = {m.variant: figures(m) for m in found}
    return {"costs": _tools(tools), "trust": _prediction(tools)}


def _prediction(tools: dict[str, Any]) -> str:
    rows = []
    for name, t in tools.items():
        a, o = t["cut_alone"], t["overcut_samples"]
        error = "–" if a["largest_error_per_mm"] is None else f"{a['largest_error_per_mm']:.1e}"
        rows.append([name, a["contacts"], a["gouge"], a["too_near_a_tie"], a["disagree"], error, o["local"], o["tie"],
                     o["global"], o["unpredicted"]])  # fmt: skip
    head = ["", "contacts cut alone", "gouge", "too near a tie", "**against prediction**", "largest error [1/mm]",
            "overcut samples: local", "tie", "global", "**not predicted**"]  # fmt: skip
    return (
        "Does the overcut appear where it is predicted? "
        "Every contact on its own: the tool stands there alone and 16 rays about it are cut; the clearance must\n"
        "have the curvature that was predicted. Then all passes together: every sample overcut beyond the tolerance\n"
        "is traced to the contact that cut deepest. Either the tool is clear of the surface on the way there, so that\n"
        "another part of it has hit another part of the surface (global gouging); or it is not, and then somewhere\n"
        "on the way the part must be predicted to gouge (local).\n\n" + table(head, rows)
    )


def _tools(tools: dict[str, Any]) -> str:
    rows = []
    for name, t in tools.items():
        d = t["deviation_um"]
        rows.append([f"{name}: {t['tool']}", t["contacts"], t["contacts_gouging"], t["contacts_tie"], um(d["min"]),
                     um(d["max"]), um(d["mean"]), d["uncut"], d["through"],
                     f"{t['machined_points_off_tool_um']:.1e}"])  # fmt: skip
    head = ["Tool", "contacts", "predicted to gouge", "tie", "min [µm]", "max", "mean", "uncut", "cut through",
            "machined points off the tool [µm]"]  # fmt: skip
    return "## What each tool cuts\n\n" + table(head, rows)


def screen(result: Result, found: Sequence[GougingMeasurement], console: Console) -> None:
    """Overcut by tool and cause."""
    shown = Table(title=f"{result.name}: deviation in um, + material left, - overcut; overcut samples by cause")
    for head in ("tool", "min", "max", "contacts gouging", "local", "tie", "global", "not predicted"):
        shown.add_column(head, justify="left" if head == "tool" else "right")
    for m in found:
        t = figures(m)
        d, o = t["deviation_um"], t["overcut_samples"]
        ends = ("-" if d[k] is None else f"{d[k]:.1f}" for k in ("min", "max"))
        counts = (t["contacts_gouging"], o["local"], o["tie"], o["global"], o["unpredicted"])
        shown.add_row(f"{m.variant}: {t['tool']}", *ends, *(f"{c:,}" for c in counts))
    console.print(shown)
    for m in found:
        q = m.cut.rings
        console.print(
            f"{m.variant}: {len(q.contact):,} contacts cut alone, {int(q.disagree.sum())} against "
            f"prediction ({int(q.near.sum())} too near a tie to tell)"
        )


def charts(result: Result, found: Sequence[GougingMeasurement]) -> list[Chart]:
    labels = {m.variant: f"{m.variant}: {tool_words(m.cut.cutter)}" for m in found}
    tolerance = result.job.part.surfaces[found[0].surface].tolerance
    cuts, limit = {m.variant: m.cut for m in found}, tolerance.overcut_um if tolerance else 0.0
    caption = "Deviation and what made the overcut; dashed: where the tool is predicted to gouge"
    return [Chart("gouging.png", caption, partial(draw_cuts, result.name, cuts, labels, limit))]


def maps(result: Result, found: Sequence[GougingMeasurement]) -> dict[str, dict[str, dict[str, Column]]]:
    """What made the overcut and what was predicted, beside the deviations; the main tool's without its name."""
    channels: dict[str, dict[str, Column]] = {}
    for m in found:
        mark = "" if m.variant == result.job.main else f"{slug(m.variant)}."
        cause = Column(m.cut.made.cause, f"what made the overcut under {m.variant}", key_of_numbers(CAUSES))
        channels.setdefault(m.surface, {}).update({
            f"{mark}cause.id": cause,
            f"{mark}contact.id": _contact(m),
            f"{mark}least_difference.per_mm": _least(m),
        })  # fmt: skip
    return {"deviation.exr": channels}


def columns(_: Result, found: Sequence[GougingMeasurement]) -> dict[str, dict[str, Column]]:
    """Columns beside those of the dense grid, by surface."""
    out: dict[str, dict[str, Column]] = {}
    for m in found:
        name, cut, under = slug(m.variant), m.cut, f"under {m.variant}"
        theta = np.degrees(cut.samples.contacts.theta)
        out.setdefault(m.surface, {}).update({
            f"{name}_cause": Column(
                words(CAUSES, cut.made.cause), f"what made the overcut {under}", key_of_words(CAUSES)
            ),
            f"{name}_contact": _contact(m),
            f"{name}_contact_apart_mm": Column(cut.made.apart, f"way from that contact to the sample {under}"),
            f"{name}_theta_deg": Column(theta, f"angle of the contact on the tool's profile {under}"),
            f"{name}_least_difference_per_mm": _least(m),
            f"{name}_predicted_gouge": Column(cut.samples.gouges, f"whether the curvatures predict a gouge {under}"),
        })  # fmt: skip
    return out


def _contact(m: GougingMeasurement) -> Column:
    return Column(known(m.cut.made.contact), f"contact of the path, from 0, that made the overcut under {m.variant}")


def _least(m: GougingMeasurement) -> Column:
    """The least difference of curvature; nothing where the tool does not touch."""
    samples = m.cut.samples
    least = np.where(samples.touches, samples.comparison.least, np.nan).reshape(m.cut.grid.shape)
    return Column(least, f"tool's curvature minus the part's, least over all directions, under {m.variant}")


def layers(result: Result, found: Sequence[GougingMeasurement]) -> dict[str, NDArray]:
    """The machined surface under every tool, with the tool at the contact that is drawn; the main tool adds no name."""
    arrays: dict[str, NDArray] = {}
    drawn = next((m for m in result.measurements.values() if isinstance(m, ContactMeasurement)), None)
    for number_, m in enumerate(found):
        named = m.surface if m.variant == result.job.main else f"{m.surface} {number_ + 1} {m.variant}"
        arrays |= patch_arrays(m.cut.grid, m.cut.deviation, named)
        arrays[f"gouge:{named}:profile"] = outline(m.cut.cutter)
        tolerance = result.job.part.surfaces[m.surface].tolerance
        arrays[f"gouge:{named}:tolerance_um"] = np.array(0.0 if tolerance is None else tolerance.overcut_um)
        arrays[f"gouge:{named}:label"] = np.array(f"{m.variant}: {tool_words(m.cut.cutter)}")
        tip = np.full(3, np.nan)
        if drawn is not None:
            surface = cast(NurbsSurface, result.job.part.patch(m.surface))
            jet = surface.jet(np.array([drawn.plotted.u]), np.array([drawn.plotted.v]))
            tip = locate(m.cut.cutter, jet.r, jet.normal).tip[0]
        arrays[f"gouge:{named}:tip"] = tip
    return arrays
