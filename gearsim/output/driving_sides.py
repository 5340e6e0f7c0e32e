"""Drive and coast side of a bevel gear's flanks."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def driving_sides(scene: Mapping[str, Any]) -> list[str]:
    """Which flank of a spiral bevel gear is the drive side, in a line, by a scene's plain tables; else nothing.

    A scene does not say which way the gears turn. By the custom of the field the pinion drives with its concave flank,
    onto the convex one of the wheel; without a spiral, and of two alike members, custom knows no such side.
    """
    surface = scene.get("surface") or {}
    teeth, mate = surface.get("teeth"), surface.get("mate_teeth")
    if mate is None or teeth == mate or not surface.get("spiral_angle_deg"):
        return []
    member, drive, coast = ("pinion", "concave", "convex") if teeth < mate else ("wheel", "convex", "concave")
    return [
        f"this {member} of {teeth} teeth against {mate}: {drive} flank = drive side, {coast} flank = coast side, as is "
        "customary (the pinion drives with its concave flank); turned the other way round they change places"
    ]
