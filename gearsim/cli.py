"""The ``gearsim`` command."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from shlex import quote
from shutil import rmtree
from time import perf_counter
from typing import TYPE_CHECKING

from gearsim.arguments import parser
from gearsim.errors import GearsimError, InputError

if TYPE_CHECKING:
    from gearsim.output.painting import Painters
    from gearsim.scene import Scene


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    from gearsim.output.standard import safe_streams

    try:
        with safe_streams():
            return _told(arguments)
    except InputError as error:  # standard output takes no more
        print(f"gearsim: {error}", file=sys.stderr)
        return error.exit_code


def _told(arguments: Sequence[str] | None) -> int:
    """Run the command; every failure is told in one message and is its exit code."""
    try:
        options = parser(_RUNS).parse_args(arguments)
        return int(options.command(options))
    except GearsimError as error:
        print(f"gearsim: {error}", file=sys.stderr)
        return error.exit_code
    except MemoryError:
        print(
            "gearsim: out of memory; lower metrology.rows and columns or raise simulation.dexel_pitch_mm "
            "(gearsim run SCENE --dry-run estimates the need)",
            file=sys.stderr,
        )
        return InputError.exit_code
    except OSError as error:  # whatever the disk refuses where nobody else has said what it was for
        print(f"gearsim: {error}", file=sys.stderr)
        return InputError.exit_code
    except KeyboardInterrupt:
        print("gearsim: interrupted; nothing was written", file=sys.stderr)
        return 130


def _run(options: argparse.Namespace) -> int:
    if options.dry_run:
        return _dry_run(options)
    from gearsim.output.painting import Painters
    from gearsim.output.wanted import Wanted

    with Painters(Wanted(not options.no_pictures, options.figures, options.only)) as painters:  # loading meanwhile
        return _run_drawn(options, painters)


def _run_drawn(options: argparse.Namespace, painters: Painters) -> int:
    """Run a scene; its pictures are drawn by ``painters``."""
    scene, folder = _scene(options)
    from gearsim.output.files import CHECKPOINTS, into, staged
    from gearsim.output.presenters import promised
    from gearsim.output.screen import ScreenProgress, print_result
    from gearsim.output.write import refuse_unknown, write_result
    from gearsim.processes.run import plan, require_device, run_job

    require_device(options.device)
    wanted = painters.wanted
    out = options.out or Path("runs") / scene.name
    with staged(out) as stage, ScreenProgress() as progress:
        progress.stage("planning", 0)
        started = perf_counter()
        job = plan(scene, folder)
        refuse_unknown(job, wanted)
        painters.expect(promised(job))
        planned_s = perf_counter() - started
        kept = out / CHECKPOINTS
        result = run_job(job, device=options.device, progress=progress, planned_s=planned_s, checkpoints=kept)
        progress.stage("writing report and pictures", 0)
        with into(out):
            missing = write_result(result, stage, painters)
    rmtree(kept, ignore_errors=True)
    print_result(result, out / "report.html" if wanted.file("report.html") else out, missing)
    return result.exit_code


def _dry_run(options: argparse.Namespace) -> int:
    scene, folder = _scene(options)
    from gearsim.output.screen import print_estimate
    from gearsim.processes.run import estimate

    print_estimate(scene.name, estimate(scene, folder, options.device))
    return 0


def _scene(options: argparse.Namespace) -> tuple[Scene, Path]:
    """The scene that is asked for, and the folder its files are in."""
    from gearsim.scene import load_scene, scene_beside

    loaded = load_scene(options.scene, options.set)
    if beside := scene_beside(options.scene):
        print(f"gearsim: note: this is the built-in scene; the file is run by ./{beside}", file=sys.stderr)
    return loaded


def _scenes(_: argparse.Namespace) -> int:
    from gearsim.scene import scene_names

    return _list(scene_names())


def _studies(_: argparse.Namespace) -> int:
    from gearsim.scene.study_files import study_names

    return _list(study_names())


def _list(names: Mapping[str, str]) -> int:
    width = max(map(len, names))
    for name, text in names.items():
        print(f"{name:{width}}  {text}")
    return 0


def _batch(options: argparse.Namespace) -> int:
    from gearsim.studies.command import batch

    return batch(options)


def _new(options: argparse.Namespace) -> int:
    from gearsim.scene.new import write_new

    target = write_new(options.name, options.like)
    print(f"wrote {target}; edit it, then: gearsim run {quote(str(target))}")
    return 0


def _view(options: argparse.Namespace) -> int:
    from gearsim.output.window import open_window

    open_window(options.run)
    return 0


def _inspect(options: argparse.Namespace) -> int:
    from gearsim.processes.inspect import inspect

    return inspect(options)


def _animate(options: argparse.Namespace) -> int:
    from gearsim.processes.animate import animate

    return animate(options)


def _gouge(options: argparse.Namespace) -> int:
    from gearsim.processes.gouge import gouge

    return gouge(options)


def _verify(options: argparse.Namespace) -> int:
    from gearsim.verify.command import verify

    return verify(options)


def _bench(options: argparse.Namespace) -> int:
    from gearsim.bench.command import bench

    return bench(options)


def _compare(options: argparse.Namespace) -> int:
    from gearsim.studies.compare import command

    return command(options)


_RUNS = {
    "run": _run,
    "scenes": _scenes,
    "batch": _batch,
    "studies": _studies,
    "new": _new,
    "view": _view,
    "inspect": _inspect,
    "animate": _animate,
    "gouge": _gouge,
    "verify": _verify,
    "bench": _bench,
    "compare": _compare,
}


if __name__ == "__main__":
    sys.exit(main())
