"""The mean profile of a flank: figures, and the table and picture beside printed values."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import isfinite
from typing import Any

from gearsim.metrology.mean_profile import ProfileMeasurement
from gearsim.output.charts import draw_mean_profiles
from gearsim.output.markdown import table, um
from gearsim.output.saving import Chart
from gearsim.output.summary import number
from gearsim.result import Result


def files(*_: Any) -> list[str]:
    return ["mean-profile.png"]


def figures(m: ProfileMeasurement) -> dict[str, Any]:
    out: dict[str, Any] = {
        "offsets_mm": list(m.offsets_mm),
        "normal_um": {k: number(v) for k, v in m.normal_um.items()},
        "in_plane_um": {k: number(v) for k, v in m.in_plane_um.items()},
    }
    if m.published is not None:
        out["published_um"] = dict(zip(m.normal_um, m.published.um, strict=False))
    return out


def sections(_: Result, found: Sequence[ProfileMeasurement]) -> dict[str, str]:
    rows = []
    for m in found:
        if m.published is not None:
            rows.append([f"{m.surface}, published (sign turned)", *map(um, m.published.um)])
        rows.append([f"{m.surface}, ours, surface normal", *map(um, m.normal_um.values())])
        rows.append([f"{m.surface}, ours, normal in the profile plane", *map(um, m.in_plane_um.values())])
    head = ["Deviation at the mean profile [µm]", *found[0].normal_um]
    text = f"Under {found[0].variant}; L0 lies at mid working depth, where passes planned here touch the tooth."
    if not all(isfinite(value) for m in found for value in m.normal_um.values()):
        text += " –: the flank ends before, or nothing was measured there."
    printed = found[0].published
    if printed is None:
        return {"details": f"## Mean profile\n\n{text}\n\n" + table(head, rows)}
    sign = "counts overcut as positive; its sign is turned here" if printed.overcut_is_positive else "has our sign"
    intro = f"{printed.source}. The source {sign}. {text} {printed.note}"
    return {"beside": f"## Beside the published figures\n\n{intro}\n\n" + table(head, rows)}


def charts(result: Result, found: Sequence[ProfileMeasurement]) -> list[Chart]:
    caption = "Deviation over the height above the contact path, at the mean profile"
    return [Chart("mean-profile.png", caption, partial(draw_mean_profiles, result, found))]
