"""report.json of runs of local gouging and of worked examples."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.gouging.attribution import Cause
from gearsim.gouging.compare import Decision
from gearsim.gouging.khan_sizes import SideBySide
from gearsim.gouging.worked import WorkedRow
from gearsim.output.summary import number, provenance_figures, worst_at
from gearsim.result import GougeExampleResult, SculpturedResult, SizeChoice, ToolCut

_CONVENTIONS = {
    "curvature": "1/mm, positive where the part curves towards the tool and the tool away from the part",
    "directions": "counter-clockwise about the normal, seen from the tool, 0 where the tool's meridian leads uphill",
    "least_difference": "least of tool minus part over all directions: below 0 gouges, within 1e-9/mm is a tie",
    "cause": "what made overcut beyond the tolerance: " + ", ".join(f"{c.value} {c.name.lower()}" for c in Cause),
    "grids": "rows along v, columns along u",
}


def summary(result: SculpturedResult | GougeExampleResult) -> dict[str, Any]:
    """Everything report.json holds."""
    out = {**provenance_figures(result, _CONVENTIONS), "worked_examples": worked_figures(result.worked)}
    if isinstance(result, GougeExampleResult):
        return out
    return {
        **out,
        "tools": {name: _tool(result, cut) for name, cut in result.cuts.items()},
        "tool_size": size_figures(result.sizes),
        "plotted": {
            "u": result.plotted.u,
            "v": result.plotted.v,
            "place_mm": [float(x) for x in result.plotted.point],
            "least_difference_per_mm": {
                name: number(float(p.comparison.least[0])) for name, p in result.plotted.tools.items()
            },
        },
    }


def worked_figures(rows: Sequence[WorkedRow]) -> dict[str, Any]:
    return {
        "agree": sum(r.agrees for r in rows),
        "differ": sum(not r.agrees for r in rows),
        "rows": [r._asdict() for r in rows],
    }


def tool_words(cutter: Profile) -> str:
    """A tool by its kind and sizes."""
    bottom = [e for e in cutter.elements if e.is_arc]
    corner = f", r = {bottom[0].radius:g} mm" if bottom and cutter.name.startswith(("bull", "ball")) else ""
    return f"{cutter.name}, R = {cutter.max_radius:g} mm{corner}"


def size_figures(sizes: SizeChoice) -> dict[str, Any]:
    """The mill for the whole surface, by the thesis's algorithm and truly, and how sizes spread."""
    fits = np.isfinite(sizes.shank)
    return {
        "points": int(fits.size),
        "no_mill_fits": int(np.count_nonzero(~fits)),
        "least_shank_mm": number(float(np.nanmin(sizes.shank))) if fits.any() else None,
        "greatest_shank_mm": number(float(np.nanmax(sizes.shank))) if fits.any() else None,
        **whole_figures(sizes.whole, sizes.place),
    }


def whole_figures(whole: SideBySide | None, place: Sequence[float]) -> dict[str, Any]:
    """One mill for everything, by the thesis's algorithm and truly; empty where none reaches anything."""
    if whole is None:
        return {}
    return {
        "thesis": {
            "shank_mm": number(whole.khan[0]),
            "corner_mm": number(whole.khan[1]),
            "least_difference_per_mm": number(whole.least),
            "gouges": bool(whole.least < -1e-9),
        },
        "optimum": {
            "shank_mm": number(whole.best.shank),
            "corner_mm": number(whole.best.corner),
            "least_difference_per_mm": number(whole.best.least),
            "limited_at_mm": list(place),
        },
    }


def _tool(result: SculpturedResult, cut: ToolCut) -> dict[str, Any]:
    rings, decision = cut.rings, cut.contacts.decision
    over, predicted = cut.made.cause > 0, cut.samples.gouges.reshape(result.grid.shape)
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
        "worst_at": worst_at(result.grid, cut.deviation),
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
