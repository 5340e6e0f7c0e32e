"""The verbs: plan a scene into a job, run the job, say beforehand what a run would cost."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from importlib import import_module
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import TYPE_CHECKING, Any, Protocol

from gearsim.envelope import prepare_envelope
from gearsim.errors import InputError
from gearsim.metrology.inspection import Cut, Question, Solve, perform
from gearsim.metrology.job import Job, at_once, counted
from gearsim.metrology.study import Change, study_steps
from gearsim.metrology.verdict import verdict
from gearsim.output.presenters import flat_figures
from gearsim.result import Result, versions
from gearsim.scene import Scene, load_scene
from gearsim.scene.printed import printed_elsewhere
from gearsim.simulation.operation import Variant
from gearsim.simulation.room import RAY_BYTES, require_room
from gearsim.simulation.workshop import Workshop

if TYPE_CHECKING:
    from gearsim.processes.claims import Claim

_PLANNERS = {
    "FlankMillingScene": "flank_milling",
    "FaceMillingScene": "face_milling",
    "HypoidScene": "hypoid",
    "EnvelopeScene": "envelope",
    "CylindricalGearScene": "cylindrical",
    "SculpturedScene": "sculptured",
    "GougeExampleScene": "worked_examples",
    "ProgramScene": "any_program",
    "SolidScene": "solid_part",
    "FacedScene": "faced_part",
}
_OF_MACHINES = ("FlankMillingScene", "CylindricalGearScene", "ProgramScene", "SolidScene", "FacedScene")
_SMALLER = "lower metrology.rows and columns or raise simulation.dexel_pitch_mm"


class Progress(Protocol):
    """Told of a run's progress; the silent default does nothing."""

    def stage(self, name: str, total: int) -> None: ...

    def advance(self, amount: int) -> None: ...


class _Silent:
    def stage(self, name: str, total: int) -> None:
        pass

    def advance(self, amount: int) -> None:
        pass


def plan(scene: Scene, folder: Path | None = None) -> Job:
    """What a scene asks for, made ready to run; ``folder`` is where relative file names in it are looked up.

    Figures printed for another geometry are left out, which a note tells (`printed_elsewhere`).

    Raises InputError where the geometry is impossible or a file cannot be used.
    """
    folder = folder or Path()
    elsewhere = printed_elsewhere(scene, folder)
    if elsewhere:
        scene = scene.model_copy(update={"reference": None})
    job: Job = _planner(scene).plan(scene, folder)
    if scene.stock is not None:
        job = import_module("gearsim.processes.whole_part").with_stock(job, scene.stock, folder)
    if type(scene).__name__ in _OF_MACHINES:
        job = import_module("gearsim.processes.machine_checks").with_machine(job, scene)
    return replace(job, notes=(*job.notes, elsewhere)) if elsewhere else job


def claims(scene: Scene, folder: Path | None = None) -> list[Claim]:
    """The closed forms that a scene declares; a planner without ``claims`` has none. Options and errors as of plan."""
    declare = getattr(_planner(scene), "claims", None)
    found: list[Claim] = declare(scene, folder or Path()) if declare else []
    return found


def _planner(scene: Scene) -> ModuleType:
    return import_module(f"gearsim.processes.{_PLANNERS[type(scene).__name__]}")


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
    require_device(device)
    progress = progress or _Silent()
    progress.stage("planning", 0)
    if not isinstance(scene, Scene):
        scene, found_in = load_scene(scene, overrides)
        folder = folder or found_in
    elif overrides:
        raise InputError(
            f"overrides ({', '.join(overrides)}) change a scene that is named or a file; this one is a Scene already: "
            "use its model_copy, or give its name or path"
        )
    job = plan(scene, folder)
    return run_job(job, device=device, progress=progress, planned_s=perf_counter() - started)


def require_device(device: str) -> None:
    """Raise InputError where there is no such device; the processor always is there, and Warp not started for it."""
    if device != "cpu":
        from gearsim.simulation.removal import open_device

        open_device(device)


def _prepare(questions: Sequence[Question], device: str) -> float:
    """Compile and load the kernels that questions need, those of both roads side by side; seconds taken.

    A whole part's are loaded by the first of its operations that needs them.
    """
    if not questions:
        return 0.0
    from gearsim.simulation.removal import open_device, prepare

    started = perf_counter()
    rings = {o.cutter.is_ring for q in questions if isinstance(q, Cut) for o in q.variant.operations}
    makers = [partial(prepare, device, ring) for ring in sorted(rings)]
    makers += [partial(prepare_envelope, device)] * any(isinstance(q, Solve) for q in questions)
    open_device(device)
    with ThreadPoolExecutor(2) as pool:
        for made in [pool.submit(make) for make in makers]:
            made.result()
    return perf_counter() - started


def run_job(
    job: Job, *, device: str = "cpu", progress: Progress | None = None, planned_s: float = 0.0,
    checkpoints: Path | None = None,
) -> Result:  # fmt: skip
    """Cut and measure a job; options as of ``run``.

    ``checkpoints``: a folder that keeps a whole part's stock after every operation; what stands there of this very job
    is not cut again.
    """
    started = perf_counter()
    progress = progress or _Silent()
    s = job.settings
    workshop = Workshop(device, s.tolerance_mm, s.interval_slots, progress.advance, checkpoints)
    progress.stage("cutting and measuring", 0)
    planned_rays, compile_s = 0, 0.0

    def begin(questions: list[Question]) -> None:
        nonlocal planned_rays, compile_s
        planned_rays, solved = counted(questions)
        require_room(at_once(questions), f"scene {job.name}", _SMALLER)
        progress.stage("compiling kernels", 0)
        compile_s = _prepare(questions, device)
        progress.stage("cutting and measuring", planned_rays + solved)

    readings = perform(job.steps(), workshop, begin)
    judged, status = verdict(job.part, readings)
    total = planned_s + perf_counter() - started
    return Result(
        job=job,
        device=device,
        readings=tuple(readings),
        verdict=judged,
        status=status,
        counts={
            "rays": workshop.rays,
            "following_rays": max(0, workshop.rays - planned_rays),  # fewer are cut where a killed run goes on
            "segments": job.rows(),
            "pairs": workshop.pairs,
            "candidates": workshop.candidates,
        },
        timings_s={"compile": compile_s, "plan": planned_s, "kernel": workshop.kernel_s, "total": total},
        versions=versions(),
    )


def study(
    job: Job, changes: Mapping[str, Mapping[str, Variant | str]], *, device: str = "cpu",
    progress: Progress | None = None,
) -> list[dict[str, Any]]:  # fmt: skip
    """One job under one change after another, all of them cut together: a table, one line a measurement.

    ``changes`` gives to each change's name the variants, or the names of the job's own, that take the places of the
    job's, by their names. A line holds ``change``, ``surface``, ``variant``, ``inspection`` and the measurement's
    figures as in report.json, their names joined by dots. The job as it is stands first, as change "". Raises
    InputError for a variant that the job has not.
    """
    progress = progress or _Silent()
    lines = [Change("", "", {}), *(Change(name, "", variants) for name, variants in changes.items())]
    steps = study_steps(job, lines, Job.steps)
    workshop = Workshop(device, job.settings.tolerance_mm, job.settings.interval_slots, progress.advance)

    def begin(questions: list[Question]) -> None:
        _prepare(questions, device)
        progress.stage("cutting and measuring", sum(counted(questions)))

    found = perform(steps, workshop, begin)
    return [
        {"change": c.name, "surface": m.surface, "variant": m.variant, "inspection": m.inspection, **flat_figures(m)}
        for c, readings in zip(lines, found, strict=True)
        for reading in readings
        for m in reading.measurements
    ]


def estimate(scene: Scene, folder: Path | None = None, device: str = "cpu") -> dict[str, float]:
    """Rays, segments, memory [MB] and time [s] of a run, from figures measured on two common CPU cores.

    Rays and segments are those that the run begins with; some rays follow from what it finds. Raises InputError where
    there is no such device.
    """
    from gearsim.simulation.removal import SLOT_BYTES, tile_rays

    require_device(device)
    job = plan(scene, folder)
    try:
        first = next(job.steps())
    except StopIteration:
        first = []
    rays, samples = counted(first)
    require_room(at_once(first), f"scene {job.name}", _SMALLER)
    held = at_once(first) - samples
    segments, slots = job.rows(), job.settings.interval_slots
    return {
        "rays": rays,
        "segments": segments,
        "memory_mb": 600.0
        + 1e-6 * (SLOT_BYTES * slots * min(held, tile_rays(slots)) + RAY_BYTES * held + 2000 * samples),
        "seconds": 6.0 + rays / 60e3 + samples * (2.2e-4 + 5e-7 * segments),
    }
