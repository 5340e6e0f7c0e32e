"""From a scene to its generating job, and what running it would take."""

from __future__ import annotations

from gearsim.generating.envelope import plan_envelope
from gearsim.generating.face_milling import plan_face_milling
from gearsim.generating.hypoid import plan_hypoid
from gearsim.generating.job import GeneratingJob
from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, GeneratedScene, HypoidScene
from gearsim.simulation.removal import SLOT_BYTES, tile_rays


def plan(scene: GeneratedScene) -> GeneratingJob:
    """Build the surfaces and motions of a scene."""
    if isinstance(scene, EnvelopeScene):
        return plan_envelope(scene)
    if isinstance(scene, FaceMillingScene):
        return plan_face_milling(scene)
    assert isinstance(scene, HypoidScene)
    return plan_hypoid(scene)


def estimate(job: GeneratingJob) -> dict[str, float]:
    """Rays, segments, memory [MB] and time [s] of a run, from figures measured on two common CPU cores."""
    rays, samples = job.ray_count(), job.samples()
    segments = sum(len(job.compiled(cut, source).table) for cut in job.cuts for source in cut.sources.values())
    slots = job.scene.simulation.interval_slots
    return {
        "rays": rays,
        "segments": segments,
        "memory_mb": 600.0 + 1e-6 * (SLOT_BYTES * slots * min(rays, tile_rays(slots)) + 450 * rays + 2000 * samples),
        "seconds": 6.0 + rays / 60e3 + samples * (2.2e-4 + 5e-7 * segments),
    }
