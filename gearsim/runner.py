"""One verb: run a scene and return its Result. Writing files is the output room's work."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from time import perf_counter
from typing import Any, Protocol

from gearsim import flank_milling, generating, generation_milling, sculptured
from gearsim.cutters.profile import Profile
from gearsim.envelope import prepare_envelope
from gearsim.metrology.machine import MeasuringMachine
from gearsim.result import Result
from gearsim.scene import (
    FlankMillingScene,
    GeneratedScene,
    GenerationMillingScene,
    GougeExampleScene,
    Scene,
    SculpturedScene,
    load_scene,
)
from gearsim.simulation.removal import SLOT_BYTES, prepare, tile_rays

_PROCESSES: dict[type[Scene], Any] = {
    FlankMillingScene: flank_milling,
    GeneratedScene: generating,
    GenerationMillingScene: generation_milling,
    SculpturedScene: sculptured,
    GougeExampleScene: sculptured,
}


class Progress(Protocol):
    """Told of a run's progress; the silent default does nothing."""

    def stage(self, name: str, total: int) -> None: ...

    def advance(self, amount: int) -> None: ...


class _Silent:
    def stage(self, name: str, total: int) -> None:
        pass

    def advance(self, amount: int) -> None:
        pass


def run(
    scene: Scene | str | Path, *, device: str = "cpu", overrides: tuple[str, ...] = (), folder: Path | None = None,
    progress: Progress | None = None,
) -> Result:  # fmt: skip
    """Simulate a scene and measure the machined surfaces.

    ``scene`` is a Scene, a built-in name or a path; ``overrides`` are ``table.key=value`` strings for the
    latter two; ``folder`` is where relative file names in the scene are looked up (default: the scene file's
    own folder); ``device`` is ``cpu`` or ``cuda:0``, .... Raises InputError for anything wrong in the input and
    NumericalError where a kernel status forbids trust.
    """
    started = perf_counter()
    progress = progress or _Silent()
    progress.stage("planning", 0)
    if not isinstance(scene, Scene):
        scene, found_in = load_scene(scene, overrides)
        folder = folder or found_in
    process = _process(scene)
    job = process.plan(scene, folder or Path())
    planned = perf_counter()
    progress.stage("compiling kernels", 0)
    compile_s = prepare(device) + prepare_envelope()
    settings = scene.simulation

    def machine_for(cutter: Profile) -> MeasuringMachine:
        return MeasuringMachine(cutter, device, settings.tolerance_mm, settings.interval_slots, progress.advance)

    progress.stage("cutting and measuring", job.ray_count() + job.envelope_samples())
    result: Result = process.measure(job, machine_for, device)
    timings = {"compile": compile_s, "plan": planned - started, **result.timings_s}
    return replace(result, timings_s={**timings, "total": perf_counter() - started})


def estimate(scene: Scene, folder: Path) -> dict[str, float]:
    """Rays, segments, memory [MB] and time [s] of a run, from figures measured on two common CPU cores."""
    job = _process(scene).plan(scene, folder)
    rays, segments, samples = job.ray_count(), job.segment_count(), job.envelope_samples()
    slots = scene.simulation.interval_slots
    return {
        "rays": rays,
        "segments": segments,
        "memory_mb": 600.0 + 1e-6 * (SLOT_BYTES * slots * min(rays, tile_rays(slots)) + 450 * rays + 2000 * samples),
        "seconds": 6.0 + rays / 60e3 + 2e-6 * job.ring_pairs() + samples * (2.2e-4 + 5e-7 * segments),
    }


def _process(scene: Scene) -> Any:
    """The package that plans and measures scenes of this kind."""
    return next(package for kind, package in _PROCESSES.items() if isinstance(scene, kind))
