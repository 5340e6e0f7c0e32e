"""The ``gearsim`` command."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import Any

from gearsim import __version__
from gearsim.errors import GearsimError, InputError

_EXIT_CODES = """exit codes:
  0  ran, within the scene's tolerances
  1  ran, out of tolerance (the findings say where)
  2  bad input
  3  unchecked: nothing was judged or compared, or two ways of computing it disagree
"""


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
        options = _parser().parse_args(arguments)
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


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="gearsim",
        description="Machine gears virtually and measure the machined tooth in micrometres.",
        epilog=_EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action="version", version=f"gearsim {__version__}")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")

    _add_run(commands)
    scenes = commands.add_parser("scenes", help="list the built-in scenes")
    scenes.set_defaults(command=_scenes)

    new = commands.add_parser("new", help="write a commented scene to start from")
    new.add_argument("name", help="the scene's name or file; NAME.toml is written")
    new.add_argument("--like", default="spiral-bevel-flank", help="built-in scene to copy (default: %(default)s)")
    new.set_defaults(command=_new)

    _add_gouge(commands)
    _add_verify(commands)
    _add_bench(commands)
    return parser


def _add_run(commands: Any) -> None:
    run = commands.add_parser(
        "run",
        help="simulate a scene, measure the tooth and write the report",
        description="Simulate a scene by two independent roads and write report, pictures and data.",
        epilog="examples:\n  gearsim run spiral-bevel-flank\n"
        "  gearsim run my.toml --out results --set toolpath.points=129\n"
        "  gearsim run my.toml --only report.json,samples.parquet,'deviation*'\n"
        "  gearsim run my.toml --dry-run\n\n" + _EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    run.add_argument("scene", help="a built-in scene (see 'gearsim scenes') or the path of a .toml file")
    run.add_argument("--out", type=Path, help="output folder (default: runs/NAME)")
    run.add_argument("--device", default="cpu", help="cpu (all cores; default) or cuda:0, cuda:1, ...")
    run.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="TABLE.KEY=VALUE",
        help="override a value; repeatable",
    )
    run.add_argument("--no-pictures", action="store_true", help="write data and report alone")
    run.add_argument("--only", type=_names, default=(), metavar="NAMES",
                     help="write these files alone, names or patterns: report.json,'deviation*'")  # fmt: skip
    run.add_argument("--figures", type=_names, default=(), metavar="FORMATS",
                     help="draw charts as svg, pdf or svg,pdf beside PNG, for papers")  # fmt: skip
    run.add_argument("--dry-run", action="store_true", help="say what would be cut, how large, how long; cut nothing")
    run.set_defaults(command=_run)


_GOUGE_HELP = """examples:
  gearsim gouge khan-9-1-free-form --cutter bull diameter_mm=40 corner_radius_mm=15
  gearsim gouge part.step --cutter ball diameter_mm=12 --catalogue metric
  gearsim gouge part.json --cutter flat diameter_mm=10 --axis 0 -0.2 1 --flip
  gearsim gouge walls.igs --cutter ball diameter_mm=12 --flip 'face 2'

material side: a solid's faces know theirs and JSON states it; of other faces (IGES 128, open shells) it is
assumed behind the normal r_u x r_v of the file's parameters, and said so; --flip turns it.

where faces meet: within 1e-5 of the part's size. A smooth tool enters no concave corner; tangent joins are compared
in the sector of each face; on convex edges the edge itself is compared, along itself.

exit codes:
  0  gouges nowhere
  1  gouges, the report says where
  2  bad input
  3  unchecked: no point is reached, a face was skipped, left out or reached nowhere, or material sides disagree
"""


def _add_gouge(commands: Any) -> None:
    gouge = commands.add_parser(
        "gouge",
        help="say where a cutter gouges the faces of a file, and which mill is the largest that does not",
        description="Compare the curvatures of cutter and part on all faces of a file, each trimmed to its boundary, "
        "and where faces meet: where the cutter gouges, in which directions, how deep; the largest mill of a "
        "catalogue. Nothing is cut; only the surface beside each contact is looked at (local gouging).",
        epilog=_GOUGE_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    gouge.add_argument("surface", help="a shipped control net or a file: .json, .igs, .iges, .stp, .step")
    gouge.add_argument("--cutter", nargs="+", required=True, metavar=("KIND", "KEY=VALUE"),
                       help="a cutter of the catalogue with its sizes, as in a scene's [cutter] table")  # fmt: skip
    gouge.add_argument("--catalogue", default="khan", metavar="NAME|FILE",
                       help="end mills to choose from: khan (default), metric, or a file of R, r [mm]")  # fmt: skip
    gouge.add_argument("--number", type=_positive, metavar="N",
                       help="look at face N only; where the file holds others, nothing is called free")  # fmt: skip
    gouge.add_argument("--flip", nargs="*", metavar="FACE",
                       help="put the material on the other side of all faces or of those named")  # fmt: skip
    gouge.add_argument("--axis", type=float, nargs=3, default=(0.0, 0.0, 1.0), metavar=("X", "Y", "Z"),
                       help="tool axis, away from the tip (default: 0 0 1)")  # fmt: skip
    gouge.add_argument("--grid", type=_positive, default=256,
                       help="lines along the longest face, more where a face bends (default: %(default)s)")  # fmt: skip
    gouge.add_argument("--margin", type=float, default=0.0,
                       help="share left out at every face's borders, and with it where faces meet")  # fmt: skip
    gouge.add_argument("--out", type=Path, metavar="DIR", help="also write report, pictures and maps")
    gouge.add_argument("--device", default="cpu", help="cpu (default) or cuda:0, cuda:1, ...")
    gouge.set_defaults(command=_gouge)


def _add_verify(commands: Any) -> None:
    verify = commands.add_parser(
        "verify",
        help="check closed-form surfaces against brute force that uses no envelope condition",
        description="Check closed-form machined surfaces at random points: distance to the tool over its whole motion, "
        "side, normals, curvatures. A formula of your own: --surface; points of your own: --points-file.",
        epilog="examples:\n  gearsim verify\n  gearsim verify spiral-bevel-flank --points 2000 --out verify.json\n"
        "  gearsim verify --surface my_surface.py\n  gearsim verify spiral-bevel-flank --points-file points.csv\n"
        "  gearsim verify --torture medium\n\n"
        "exit codes:\n  0  all passed\n  1  something failed, the table says what\n  2  bad input\n",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    verify.add_argument("scenes", nargs="*", metavar="SCENE", help="built-in scenes or .toml files (default: all)")
    verify.add_argument("--surface", type=Path, metavar="FILE", help="a Python file: cutter, motion, points(u, v)")
    lists = verify.add_mutually_exclusive_group()
    lists.add_argument("--points-file", type=Path, metavar="FILE", help="check this point list (.csv or .parquet)")
    lists.add_argument("--write-points", type=Path, metavar="FILE", help="write the surfaces as point lists instead")
    lists.add_argument("--torture", metavar="SIZE", help="small (CI), medium (minutes), large (an hour): judge the "
                       "removal road by an oracle of its own, on rays that touch, graze and pass")  # fmt: skip
    verify.add_argument("--points", type=_positive, default=500, help="points per surface (default: %(default)s)")
    verify.add_argument("--seed", type=int, default=1, help="seed of the random points (default: %(default)s)")
    verify.add_argument("--limit-mm", type=_size, default=1e-9, help="largest distance error (default: %(default)s)")
    verify.add_argument("--out", type=Path, metavar="FILE", help="also write the figures as JSON to this file")
    verify.add_argument("--plot", type=Path, metavar="FILE",
                        help="also draw where over u and v each formula errs (.png, .svg or .pdf)")  # fmt: skip
    verify.set_defaults(command=_verify)


_BENCH_HELP = """examples:
  gearsim bench                                      # lists the suites
  gearsim bench removal                              # small: under 45 s on two cores
  gearsim bench scenes                               # the README's command, warm and cold, and four scenes: minutes
  gearsim bench scenes --size large --out now.json   # all scenes
  gearsim bench scenes --against ../before/.venv     # beside another build, in turns; prints the ratios
"""


def _add_bench(commands: Any) -> None:
    bench = commands.add_parser(
        "bench",
        help="measure speed: rays, segments and ray-segment pairs per second, whole scenes",
        description="Measure speed on this machine, by suites.",
        epilog=_BENCH_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    bench.add_argument("suite", nargs="?", help="the suite to run (default: list them)")
    bench.add_argument("--size", default="small", help="small (default) or large")
    bench.add_argument("--against", type=Path, metavar="VENV",
                       help="with suite scenes: also run the build installed in this virtual environment")  # fmt: skip
    bench.add_argument("--peers", action="store_true", help="measure other programs on the same work instead")
    bench.add_argument("--device", default="cpu", help="cpu or cuda:0, ...")
    bench.add_argument("--out", type=Path, help="also write the figures as JSON to this file")
    bench.set_defaults(command=_bench)


def _run(options: argparse.Namespace) -> int:
    from gearsim.scene import load_scene, scene_beside

    scene, folder = load_scene(options.scene, options.set)
    if beside := scene_beside(options.scene):
        print(f"gearsim: note: this is the built-in scene; the file is run by ./{beside}", file=sys.stderr)
    if options.dry_run:
        return _dry_run(scene, folder, options.device)
    from gearsim.output.files import into, staged
    from gearsim.output.painting import Painters
    from gearsim.output.screen import ScreenProgress, print_result
    from gearsim.output.wanted import Wanted
    from gearsim.output.write import refuse_unknown, write_result
    from gearsim.processes.run import plan, run_job

    wanted = Wanted(not options.no_pictures, options.figures, options.only)
    out = options.out or Path("runs") / scene.name
    with staged(out) as stage, Painters(wanted) as painters, ScreenProgress() as progress:
        progress.stage("planning", 0)
        started = perf_counter()
        job = plan(scene, folder)
        refuse_unknown(job, wanted)
        result = run_job(job, device=options.device, progress=progress, planned_s=perf_counter() - started)
        progress.stage("writing report and pictures", 0)
        with into(out):
            missing = write_result(result, stage, painters)
    print_result(result, out / "report.html" if wanted.file("report.html") else out, missing)
    return result.exit_code


def _dry_run(scene: Any, folder: Path, device: str) -> int:
    from gearsim.output.screen import print_estimate
    from gearsim.processes.run import estimate

    print_estimate(scene.name, estimate(scene, folder, device))
    return 0


def _scenes(_: argparse.Namespace) -> int:
    from gearsim.scene import scene_names

    names = scene_names()
    width = max(map(len, names))
    for name, text in names.items():
        print(f"{name:{width}}  {text}")
    return 0


def _new(options: argparse.Namespace) -> int:
    from gearsim.scene import scene_names, scene_text

    target = _new_file(options.name)
    if options.like not in scene_names():
        raise InputError(f"--like {options.like}: no such built-in scene; there are {', '.join(scene_names())}")
    text = scene_text(options.like)[0].replace(f'name = "{options.like}"', f'name = "{target.stem}"')
    try:
        with target.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InputError(f"{target} exists already; choose another name") from None
    except OSError as error:
        with suppress(OSError):
            target.unlink()
        raise InputError(f"cannot write {target}: {error.strerror}") from error
    print(f"wrote {target}; edit it, then: gearsim run {target}")
    return 0


def _new_file(name: str) -> Path:
    """Where a scene of that name is written. Raises InputError for names that no file has or that others have."""
    from gearsim.scene import scene_names
    from gearsim.scene.tables import file_name

    target = Path(f"{name.removesuffix('.toml')}.toml")
    try:
        file_name(target.stem if name else "")
    except ValueError as error:
        raise InputError(f"new {name!r}: {error}") from None
    if target.stem in scene_names():
        raise InputError(f"new {name}: a built-in scene has that name; choose another")
    return target


def _gouge(options: argparse.Namespace) -> int:
    from gearsim.processes.gouge import gouge

    return gouge(options)


def _names(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"expected names with commas between them, got {text!r}")
    return names


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number above 0, got {text!r}")
    return int(text)


def _size(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = 0.0
    if not 1e-12 <= value <= 1.0:
        raise argparse.ArgumentTypeError(f"expected a number from 1e-12 to 1, got {text!r}")
    return value


def _verify(options: argparse.Namespace) -> int:
    from gearsim.verify.command import verify

    return verify(options)


def _bench(options: argparse.Namespace) -> int:
    from gearsim.bench.command import bench

    return bench(options)


if __name__ == "__main__":
    sys.exit(main())
