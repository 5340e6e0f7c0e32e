"""Scenes of cylindrical gears, planned without what most tests do not ask for."""

from gearsim.scene import load_scene

FEW = ("metrology.spaces=1", "metrology.points=15", "toolpath.finishing.axial_step_mm=2.5")


def gear_scene(*overrides, of="spur-external"):
    """A scene with few points, and without its [budget], whose two dozen causes are a third of what planning takes."""
    return load_scene(of, (*FEW, *overrides))[0].model_copy(update={"budget": None})
