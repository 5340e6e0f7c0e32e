"""Scenes: TOML files turned into the dataclasses of the other rooms, with every mistake told at once."""

from gearsim.scene.any_program import ProgramScene
from gearsim.scene.base import Scene
from gearsim.scene.cylindrical import CylindricalGearScene
from gearsim.scene.faced_part import FacedScene
from gearsim.scene.flank_milling import FlankMillingScene
from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, GeneratedScene, HypoidScene
from gearsim.scene.loading import check_scene, load_scene, scene_beside, scene_names, scene_table, scene_text
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
