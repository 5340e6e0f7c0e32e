"""Machine bodies: which of them tools were held against, how, and which are not known."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from gearsim.metrology.body_check import BodyMeasurement
from gearsim.output.markdown import table
from gearsim.result import Result


def figures(m: BodyMeasurement) -> dict[str, Any]:
    return {
        "bodies": [
            {
                "name": k.name,
                "rows": k.rows,
                "near": k.near,
                "pitch_mm": k.pitch or None,
                "widest_unseen_mm": 2.0**0.5 * k.pitch or None,
            }
            for k in m.looks
        ],
        "unchecked": [*m.missing, *(f"above the flutes: {name}" for name in m.bare)],
    }


def sections(_: Result, found: Sequence[BodyMeasurement]) -> dict[str, str]:
    return {"beside": "".join(map(_section, found))}


def _section(m: BodyMeasurement) -> str:
    text = "## Bodies of the machine\n\n"
    if m.looks:
        rows = [
            [k["name"], k["rows"], k["rows"] - k["near"], *(_plain(k[n]) for n in ("pitch_mm", "widest_unseen_mm"))]
            for k in figures(m)["bodies"]
        ]
        text += (
            "What tools and holders do, over the whole program. Rows that are clear of a body are, for certain; the "
            "others were looked at by rays through it and along its surface, as far apart as told, which see every "
            "overlap that holds a ball wider than told.\n\n"
            + table(["Body", "rows", "clear for certain", "rays apart [mm]", "ball unseen [mm]"], rows)
        )
    if m.missing:
        text += f"\nUnchecked: no {', no '.join(m.missing)} is named, so that nothing is known of hits with one.\n"
    if m.bare:
        text += f"\nUnchecked: what stands above the flutes is not named for {', '.join(m.bare)}.\n"
    return text + "\n"


def _plain(x: float | None) -> str:
    return "–" if x is None else f"{x:.3g}"
