"""Scenes: TOML files turned into the dataclasses of the other rooms, with every mistake told at once.

Only the kinds of scenes that are used are loaded.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearsim.scene.any_program import ProgramScene
    from gearsim.scene.base import Scene
    from gearsim.scene.built_in import scene_beside, scene_names, scene_text
    from gearsim.scene.cylindrical import CylindricalGearScene
    from gearsim.scene.faced_part import FacedScene
    from gearsim.scene.flank_milling import FlankMillingScene
    from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, GeneratedScene, HypoidScene
    from gearsim.scene.loading import check_scene, load_scene, scene_table
    from gearsim.scene.sculptured import GougeExampleScene, SculpturedScene
    from gearsim.scene.solid_part import SequenceScene, SolidScene

__all__ = [
    "CylindricalGearScene",
    "EnvelopeScene",
    "FaceMillingScene",
    "FacedScene",
    "FlankMillingScene",
    "GeneratedScene",
    "GougeExampleScene",
    "HypoidScene",
    "ProgramScene",
    "Scene",
    "SculpturedScene",
    "SequenceScene",
    "SolidScene",
    "check_scene",
    "load_scene",
    "scene_beside",
    "scene_names",
    "scene_table",
    "scene_text",
]

_HOMES = {
    "any_program": ["ProgramScene"],
    "base": ["Scene"],
    "built_in": ["scene_beside", "scene_names", "scene_text"],
    "cylindrical": ["CylindricalGearScene"],
    "faced_part": ["FacedScene"],
    "flank_milling": ["FlankMillingScene"],
    "generated": ["EnvelopeScene", "FaceMillingScene", "GeneratedScene", "HypoidScene"],
    "loading": ["check_scene", "load_scene", "scene_table"],
    "sculptured": ["GougeExampleScene", "SculpturedScene"],
    "solid_part": ["SequenceScene", "SolidScene"],
}


def __getattr__(name: str) -> Any:
    home = next((module for module, names in _HOMES.items() if name in names), None)
    if home is None:
        raise AttributeError(f"module 'gearsim.scene' has no attribute {name!r}")
    value = getattr(import_module(f"gearsim.scene.{home}"), name)
    globals()[name] = value
    return value
