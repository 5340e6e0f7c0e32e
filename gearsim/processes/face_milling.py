"""Face milling: the slot that a head generates by roll, or leaves by plunging."""

from __future__ import annotations

from pathlib import Path

from gearsim.metrology.job import Job
from gearsim.motion.sources import CurveMotion
from gearsim.processes.claims import Claim, head_claims
from gearsim.processes.errors import error_notes, mounted
from gearsim.processes.frames import GEAR_FRAME
from gearsim.processes.generated import Sweep, generated_job
from gearsim.processes.parts import held
from gearsim.scene import FaceMillingScene


def plan(scene: FaceMillingScene, folder: Path) -> Job:
    """The slot's patches under the generator's own motion; it names no files to look up in ``folder``.

    Raises InputError for a slot that no gear has.
    """
    tooth = scene.tooth()
    tooth.check()
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


def claims(scene: FaceMillingScene, folder: Path) -> list[Claim]:
    """The head's envelopes and the tooth's patches."""
    return head_claims(scene.tooth())
