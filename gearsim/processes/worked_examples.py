"""Contacts known by their curvatures only: printed numbers beside ours, nothing is cut."""

from __future__ import annotations

from pathlib import Path

from gearsim.gouging.attribution import Cause
from gearsim.gouging.khan.inspection import WorkedInspection
from gearsim.metrology.job import Job
from gearsim.processes.frames import NET_FRAME
from gearsim.processes.settings import settings
from gearsim.scene import GougeExampleScene, scene_table
from gearsim.surfaces.part import Part

CONVENTIONS = {
    "curvature": "1/mm, positive where the part curves towards the tool and the tool away from the part",
    "directions": "counter-clockwise about the normal, seen from the tool, 0 where the tool's meridian leads uphill",
    "least_difference": "least of tool minus part over all directions: below 0 gouges, within 1e-9/mm is a tie",
    "cause": "what made overcut beyond the tolerance: " + ", ".join(f"{c.value} {c.name.lower()}" for c in Cause),
    "grids": "rows along v, columns along u",
}


def plan(scene: GougeExampleScene, folder: Path) -> Job:
    """A job without a part; it names no files to look up in ``folder``."""
    chosen = scene.reference
    return Job(
        name=scene.name,
        part=Part(NET_FRAME, None, {}),
        variants=(),
        main="printed",
        inspections=(WorkedInspection(chosen.sections, chosen.names, alone=True),),
        settings=settings(scene),
        scene=scene_table(scene),
        conventions=CONVENTIONS,
    )
