"""The numerical settings of any scene, as a job wants them."""

from __future__ import annotations

from gearsim.metrology.job import Settings
from gearsim.scene import Scene


def settings(scene: Scene) -> Settings:
    """A scene's table [simulation]."""
    table = scene.simulation
    return Settings(table.tolerance_mm, table.interval_slots)
