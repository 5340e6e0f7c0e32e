"""Face milling: the slot that a head generates by roll, or leaves by plunging."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from gearsim.metrology.job import Job
from gearsim.motion.sources import CurveMotion
from gearsim.processes.claims import Claim, head_claims
from gearsim.processes.errors import error_notes, mounted
from gearsim.processes.frames import GEAR_FRAME
from gearsim.processes.generated import Sweep, generated_job
from gearsim.processes.parts import held
from gearsim.scene import FaceMillingScene
from gearsim.scene.bevel import GeneratorTable
from gearsim.scene.catalogue import CatalogueTable
from gearsim.scene.generated import FaceMilledTable
from gearsim.surfaces.face_milled import FaceMilledTooth


def plan(scene: FaceMillingScene, folder: Path) -> Job:
    """The slot's patches under the generator's own motion; it names no files to look up in ``folder``.

    Raises InputError for a slot that no gear has.
    """
    tooth = _tooth(scene.surface, scene.cutter, scene.generator)
    errors, real, run = scene.errors, scene.real(), tooth.motion_range
    nominal = (tooth.head, CurveMotion(tooth.poses, *run)) if errors.acting() else None
    if tooth.generated:
        name, text = "roll", "generating roll: cradle and work turn together, continuously"
    else:
        name, text = "plunge", "infeed along the head's axis, cradle and work at rest"
    motion = mounted(CurveMotion(real.poses, *run), errors)
    cut = Sweep(real.head, tuple(tooth.patches), {name: motion}, nominal=nominal)
    on_blank = held(name, tooth, scene.metrology.tooth)
    told = error_notes(errors)
    return generated_job(scene, [cut], {name: text}, GEAR_FRAME, blank=tooth.blank, notes=told, tooth=on_blank)


@lru_cache(maxsize=8)
def _tooth(surface: FaceMilledTable, cutter: CatalogueTable, generator: GeneratorTable) -> FaceMilledTooth:
    """The slot that tables describe; kept, for jobs beside each other share it."""
    tooth = surface.tooth(cutter.build(), generator)
    tooth.check()
    return tooth


def claims(scene: FaceMillingScene, folder: Path) -> list[Claim]:
    """The head's envelopes and the tooth's patches."""
    return head_claims(scene.tooth())
