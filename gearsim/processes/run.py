"""The verbs: plan a scene into a job, run the job, say beforehand what a run would cost."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from time import perf_counter
from types import ModuleType
from typing import Any, Protocol

from gearsim.envelope import prepare_envelope
from gearsim.errors import InputError
from gearsim.metrology.inspection import Question, perform
from gearsim.metrology.job import Job, at_once, counted
from gearsim.metrology.stock_check import StockInspection
from gearsim.metrology.study import Change, study_steps
from gearsim.metrology.verdict import verdict
from gearsim.output.presenters import flat_figures
from gearsim.processes.claims import Claim
from gearsim.processes.machine_checks import with_machine
from gearsim.processes.whole_part import with_stock
from gearsim.result import Result, versions
from gearsim.scene import Scene, load_scene
from gearsim.scene.printed import printed_elsewhere
from gearsim.simulation.operation import Variant
from gearsim.simulation.removal import SLOT_BYTES, open_device, prepare, tile_rays
from gearsim.simulation.room import RAY_BYTES, require_room
from gearsim.simulation.workshop import Workshop

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
    if scene.stock is not None and not any(isinstance(i, StockInspection) for i in job.inspections):
        job = with_stock(job, scene.stock, folder)
    job = with_machine(job, scene)
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
    open_device(device)
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


def _prepare(device: str) -> float:
    """Compile and load the kernels of both roads side by side; seconds taken."""
    started = perf_counter()
    open_device(device)
    with ThreadPoolExecutor(2) as pool:
        both = [pool.submit(make, device) for make in (prepare, prepare_envelope)]
        for made in both:
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
    progress.stage("compiling kernels", 0)
    compile_s = _prepare(device)
    s = job.settings
    workshop = Workshop(device, s.tolerance_mm, s.interval_slots, progress.advance, checkpoints)
    progress.stage("cutting and measuring", 0)
    planned_rays = 0

    def begin(questions: list[Question]) -> None:
        nonlocal planned_rays
        planned_rays, solved = counted(questions)
        require_room(at_once(questions), f"scene {job.name}", _SMALLER)
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
    _prepare(device)
    workshop = Workshop(device, job.settings.tolerance_mm, job.settings.interval_slots, progress.advance)
    found = perform(steps, workshop, lambda asked: progress.stage("cutting and measuring", sum(counted(asked))))
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
    open_device(device)
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
