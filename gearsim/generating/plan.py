"""From a scene to its generating job."""

from __future__ import annotations

from difflib import get_close_matches
from pathlib import Path

from gearsim.errors import InputError
from gearsim.generating.envelope import plan_envelope
from gearsim.generating.face_milling import plan_face_milling
from gearsim.generating.hypoid import plan_hypoid
from gearsim.generating.job import GeneratingJob
from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, GeneratedScene, HypoidScene


def plan(scene: GeneratedScene, folder: Path) -> GeneratingJob:
    """Build the surfaces and motions of a scene; it names no files to look up in ``folder``.

    Raises InputError where the geometry is impossible or ``metrology.judged`` names a motion that the scene lacks.
    """
    job = _plan(scene)
    motions = list(job.cuts[0].sources)
    for name in scene.metrology.judged:
        if name not in motions:
            near = get_close_matches(name, motions, n=1, cutoff=0.4)
            hint = f"; did you mean {near[0]!r}?" if near else ""
            raise InputError(f"metrology.judged: got {name!r}, expected one of {', '.join(motions)}{hint}")
    return job


def _plan(scene: GeneratedScene) -> GeneratingJob:
    if isinstance(scene, EnvelopeScene):
        return plan_envelope(scene)
    if isinstance(scene, FaceMillingScene):
        return plan_face_milling(scene)
    assert isinstance(scene, HypoidScene)
    return plan_hypoid(scene)
