"""A generated tooth beside its blank: figures and a table."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearsim.metrology.tooth_check import ToothMeasurement
from gearsim.output.markdown import table
from gearsim.output.presenters import slug
from gearsim.result import Result


def figures(m: ToothMeasurement) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for f in m.figures:
        out[slug(f.name.replace(",", ""))] = {
            f"least_{f.unit}": f.least,
            f"most_{f.unit}": f.most,
            f"demanded_{f.unit}": f.wanted,
            f"tolerance_{f.unit}": None if f.wanted is None else f.tolerance,
            **({"hand": f.hand, "demanded_hand": f.wanted_hand or None} if f.hand else {}),
        }
    return out


def sections(_: Result, found: Sequence[ToothMeasurement]) -> dict[str, str]:
    """What the blank and the scene demand of the tooth, beside what it is."""
    rows = [[f.name, f.measured, f.demanded, "FAILS" if f.fails else ""] for m in found for f in m.figures]
    text = (
        "Deviations are from the tooth that the scene's own settings generate. Whether that is the part's tooth is "
        "judged here: bottom land, gaps and top land along the whole face, the rest on the pitch cone at the mean "
        "cone distance; thickness and top land are measured around the gear axis."
    )
    return {"first": f"## The tooth in its blank\n\n{text}\n\n" + table(["Figure", "is", "demanded", ""], rows)}
