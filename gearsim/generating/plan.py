"""From a scene to its generating job."""

from __future__ import annotations

from pathlib import Path

from gearsim.generating.envelope import plan_envelope
from gearsim.generating.face_milling import plan_face_milling
from gearsim.generating.hypoid import plan_hypoid
from gearsim.generating.job import GeneratingJob
from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, GeneratedScene, HypoidScene


def plan(scene: GeneratedScene, folder: Path) -> GeneratingJob:
    """Build the surfaces and motions of a scene; it names no files to look up in ``folder``."""
    if isinstance(scene, EnvelopeScene):
        return plan_envelope(scene)
    if isinstance(scene, FaceMillingScene):
        return plan_face_milling(scene)
    assert isinstance(scene, HypoidScene)
    return plan_hypoid(scene)
