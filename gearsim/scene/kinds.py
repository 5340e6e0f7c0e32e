"""The kinds of scenes, by the surface they want, and where each is at home: only the one asked for is loaded."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearsim.scene.base import Scene

SCENES = {
    "ruled-bevel": "flank_milling.FlankMillingScene",
    "face-milled-flank": "flank_milling.FlankMillingScene",
    "envelope": "generated.EnvelopeScene",
    "face-milled": "generated.FaceMillingScene",
    "hypoid-pinion": "generated.HypoidScene",
    "cylindrical-gear": "cylindrical.CylindricalGearScene",
    "nurbs": "sculptured.SculpturedScene",
    "gouge-example": "sculptured.GougeExampleScene",
    "solid-part": "solid_part.SolidScene",
    "faced-part": "faced_part.FacedScene",
}
PROGRAM = "any_program.ProgramScene"  # of any of those surfaces that a program from a file cuts
GCODE = frozenset((".nc", ".ngc", ".tap", ".cnc", ".mpf", ".eia", ".gcode", ".ncc"))
AXIS_TABLE = ".csv"


def scene_class(home: str) -> type[Scene]:
    """A kind of scene by its home."""
    module, name = home.split(".")
    found: type[Scene] = getattr(import_module(f"gearsim.scene.{module}"), name)
    return found
