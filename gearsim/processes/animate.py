"""The command ``gearsim animate``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from time import perf_counter

import numpy as np

from gearsim.errors import InputError
from gearsim.geometry.solid import Solid
from gearsim.metrology.job import Job
from gearsim.metrology.stock_check import StockInspection
from gearsim.output.cutting import write_cutting
from gearsim.output.files import into
from gearsim.output.screen import ScreenProgress, print_line
from gearsim.processes.run import plan
from gearsim.processes.whole_part import with_stock
from gearsim.scene import load_scene
from gearsim.scene.stock import StockTable
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.removal import open_device
from gearsim.simulation.room import require_bytes, require_room
from gearsim.simulation.sequence import ray_count
from gearsim.simulation.stages import Stage, Way, even_stops
from gearsim.simulation.workshop import Workshop

_RAYS = 60_000
_NARROWEST = 4.0  # cells across the narrowest side of a blank
_FRAME_BYTES = 4e6  # of a picture, and of what it is packed from


def animate(options: argparse.Namespace) -> int:
    """Cut a scene's whole part, look at it in between, write the frames; returns the exit code.

    Raises InputError for anything wrong in the input, NumericalError where a status forbids trust.
    """
    started = perf_counter()
    open_device(options.device)
    scene, folder = load_scene(options.scene, options.set)
    file = options.out or Path("runs") / scene.name / "cut.webp"
    if file.suffix.lower() != ".webp":
        raise InputError(f"--out {file}: an animation's name ends in .webp")
    require_bytes(_FRAME_BYTES * options.frames, f"--frames {options.frames}: pictures that need", "ask for fewer")
    with ScreenProgress() as progress:
        progress.stage("planning", 0)
        job = plan(scene, folder)
        way = _way(job, options, folder)
        progress.stage("cutting and drawing", len(way))
        workshop = Workshop(options.device, job.settings.tolerance_mm, job.settings.interval_slots)

        def told() -> Iterator[Stage]:
            for stage in way.stages(workshop):
                yield stage
                progress.advance(1)

        with into(file.parent):
            file.parent.mkdir(parents=True, exist_ok=True)
        count = write_cutting(way, told(), file)
    print_line(
        f"{file}: {count} frames of {len(way.operations)} operations, {ray_count(way.box):,} rays "
        f"{way.box.pitch:.3g} mm apart; {perf_counter() - started:.0f} s."
    )
    return 0


def _way(job: Job, options: argparse.Namespace, folder: Path) -> Way:
    """The job's operations on its blank, or where it has no [stock], on the part's own."""
    asked = next((i for i in job.inspections if isinstance(i, StockInspection)), None)
    if asked is None:
        blank = job.part.stock
        job = with_stock(job, StockTable(pitch_mm=1.0 if blank is None else _pitch(blank)), folder)
        asked = next(i for i in job.inspections if isinstance(i, StockInspection))
    operations = asked.operations(job)
    stops = even_stops(operations, options.frames - 1)
    if asked.saved is not None:
        if options.pitch_mm not in (None, asked.box.pitch):
            raise InputError(
                f"--pitch-mm {options.pitch_mm:g}: the saved stock's rays are {asked.box.pitch:g} mm apart, and it has "
                "no others; leave the option out"
            )
        return Way(asked.blank, asked.box, operations, stops, asked.turning, asked.saved)
    pitch = options.pitch_mm or _pitch(asked.blank)
    narrowest = float(np.subtract(*asked.blank.box[::-1]).min())
    if not narrowest >= pitch:
        raise InputError(f"--pitch-mm {pitch:g}: the blank is only {narrowest:.4g} mm wide")
    return Way(asked.blank, _box(asked.box, pitch), operations, stops, asked.turning)


def _pitch(blank: Solid) -> float:
    """What makes about so many rays, and is fine enough for the narrowest side."""
    lower, upper = blank.box
    x, y, z = (float(v) for v in upper - lower)
    return min(float(np.sqrt((x * y + y * z + z * x) / _RAYS)), min(x, y, z) / _NARROWEST)


def _box(box: DexelBox, pitch: float) -> DexelBox:
    """The box with rays so far apart, one cell wider than what lies in it.

    Raises InputError where that needs more memory than there is.
    """
    wider = pitch - box.pitch
    lower, upper = box.lower - wider, box.upper + wider
    cells = (upper - lower) / pitch
    require_room(sum(float(np.delete(cells, k).prod()) for k in range(3)), f"--pitch-mm {pitch:g}", "raise it")
    return replace(box, lower=lower, upper=upper, pitch=pitch)
