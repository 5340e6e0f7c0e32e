"""Face-milling scenes: the slot that a head generates by roll, or leaves by plunging."""

from __future__ import annotations

from gearsim.generating.job import Cut, GeneratingJob
from gearsim.motion.sources import CurveMotion
from gearsim.result import GEAR_FRAME
from gearsim.scene.generated import FaceMillingScene


def plan_face_milling(scene: FaceMillingScene) -> GeneratingJob:
    """The slot's patches under the generator's own motion."""
    tooth = scene.tooth()
    tooth.check()
    motion = CurveMotion(tooth.poses, *tooth.motion_range)
    if tooth.generated:
        name, text = "roll", "generating roll: cradle and work turn together, continuously"
    else:
        name, text = "plunge", "infeed along the head's axis, cradle and work at rest"
    cut = Cut(tooth.head, tuple(tooth.patches), {name: motion})
    return GeneratingJob(scene, (cut,), {name: text}, GEAR_FRAME, blank=tooth.blank)
