"""Many scenes planned beside each other, for studies."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from gearsim.errors import GearsimError
from gearsim.processes.brief import Brief, Planned, shortened
from gearsim.processes.run import plan
from gearsim.scene import Scene

_TOGETHER = {"FlankMillingScene": "flank_milling_many", "CylindricalGearScene": "cylindrical_many"}


def plan_many(scenes: Sequence[Scene], folder: Path, brief: Brief) -> list[Planned | GearsimError]:
    """Each scene's job, with what the brief wants alone (see `shortened`), or why there is none, in their order.

    ``folder`` is where files that scenes name are looked up. What scenes beside each other share is made once, where
    their process has a planner for that.
    """
    out: dict[int, Planned | GearsimError] = {}
    by_kind: dict[str, list[int]] = {}
    for i, scene in enumerate(scenes):
        whole = scene.stock is not None
        by_kind.setdefault("" if whole else _TOGETHER.get(type(scene).__name__, ""), []).append(i)
    for module, members in by_kind.items():
        mine = [scenes[i] for i in members]
        if module:
            jobs = import_module(f"gearsim.processes.{module}").plan_many(mine, folder, brief)
        else:
            jobs = [_planned(scene, folder, brief) for scene in mine]
        out |= dict(zip(members, jobs, strict=True))
    return [out[i] for i in range(len(scenes))]


def _planned(scene: Scene, folder: Path, brief: Brief) -> Planned | GearsimError:
    try:
        return Planned(shortened(plan(scene, folder), brief))
    except GearsimError as error:
        return error
