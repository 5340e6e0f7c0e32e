"""What of a gear's flanks the tool generates: figures and the report's table."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

from gearsim.metrology.gear_reach import ReachMeasurement
from gearsim.output.markdown import table
from gearsim.result import Result
from gearsim.surfaces.cylindrical_gear import SIDES


def figures(m: ReachMeasurement) -> dict[str, Any]:
    """By side the rolls and radii at root and tip between which the flank is generated over the whole facewidth."""
    gear = m.probed.gear
    out: dict[str, Any] = {}
    for side in SIDES:
        root, tip = m.probed.reached[side]
        out[side] = {
            "root_roll_deg": degrees(root),
            "tip_roll_deg": degrees(tip),
            "root_radius_mm": float(gear.radius(root)),
            "tip_radius_mm": float(gear.radius(tip)),
        }
    return out


def sections(_: Result, found: Sequence[ReachMeasurement]) -> dict[str, str]:
    gear = found[0].probed.gear
    rows = [
        [
            side, *(f"{r[f'{end}_roll_deg']:.3f}°" for end in ("root", "tip")),
            *(f"{r[f'{end}_radius_mm']:.3f}" for end in ("root", "tip")),
        ]
        for side, r in figures(found[0]).items()
    ]  # fmt: skip
    rows.append(["circles of the gear", "", "", f"{gear.root_radius:.3f}", f"{gear.tip_radius:.3f}"])
    head = ["Generated over the whole face width", "roll at root", "roll at tip", "R at root [mm]", "R at tip [mm]"]
    return {"first": table(head, rows)}
