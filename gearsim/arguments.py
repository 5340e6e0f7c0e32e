"""What the ``gearsim`` command understands: its commands, their options and their help."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from gearsim import __version__
from gearsim.studies.compare_arguments import add_compare
from gearsim.studies.options import add_batch

_FORMATS = ("svg", "pdf")  # of charts, beside PNG
_EXIT_CODES = """exit codes:
  0  ran, within the scene's tolerances
  1  ran, out of tolerance (the findings say where)
  2  bad input
  3  unchecked: nothing was judged or compared, or two ways of computing it disagree
"""


def parser(runs: Mapping[str, Callable[[argparse.Namespace], int]]) -> argparse.ArgumentParser:
    """The command line; what is parsed has as ``command`` the one of ``runs`` that runs it."""
    out = argparse.ArgumentParser(
        prog="gearsim",
        description="Machine gears virtually and measure the machined tooth in micrometres.",
        epilog=_EXIT_CODES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    out.add_argument("--version", action="version", version=f"gearsim {__version__}")
    commands = out.add_subparsers(required=True, metavar="COMMAND")

    _add_run(commands)
    commands.add_parser("scenes", help="list the built-in scenes")
    add_batch(commands, _positive)
    commands.add_parser("studies", help="list the built-in studies")

    new = commands.add_parser("new", help="write a commented scene to start from")
    new.add_argument("name", help="the scene's name or file; NAME.toml is written")
    new.add_argument("--like", default="spiral-bevel-flank", help="built-in scene to copy (default: %(default)s)")

    _add_view(commands)
    _add_inspect(commands)
    _add_animate(commands)
    _add_gouge(commands)
    _add_verify(commands)
    _add_bench(commands)
    add_compare(commands)
    for name, made in commands.choices.items():
        made.set_defaults(command=runs[name])
    return out


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
    run.add_argument("--figures", type=_formats, default=(), metavar="FORMATS",
                     help="draw charts as svg, pdf or svg,pdf beside PNG, for papers")  # fmt: skip
    run.add_argument("--dry-run", action="store_true", help="say what would be cut, how large, how long; cut nothing")


_VIEW_HELP = """examples:
  gearsim view runs/spiral-bevel-flank
  gearsim view runs/spiral-bevel-flank/tooth.vtp

in the window: drag turns, the wheel zooms, shift and drag moves, c goes on to the next colours (deviation within the
tolerance, row of the program, surface, plain), r shows the whole part again, q closes. Black: nothing was measured.

Without a screen, as on a server or in a container: open the run's report.html in any browser; it holds a 3D view.

exit codes:
  0  shown
  2  no mesh, or no screen
"""


def _add_view(commands: Any) -> None:
    view = commands.add_parser(
        "view",
        help="show a run's machined surfaces in a window, coloured by deviation",
        description="Show the machined surfaces that a run has left, in a window that turns and zooms.",
        epilog=_VIEW_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    view.add_argument("run", type=Path, metavar="DIR", help="a run's folder, or a .vtp file")


_INSPECT_HELP = """examples:
  gearsim inspect runs/drill-grid
  gearsim inspect runs/drill-grid --section z=-5 section.svg --section 'n=1,1,0;d=40' diagonal.csv
  gearsim inspect runs/drill-grid --distance '13,8,-6 27,8,-6'
  gearsim inspect runs/drill-grid --points ends.ply
  gearsim inspect runs/spiral-bevel-flank --section z=23.5 section.png --step machined.step

all lengths in mm, in the frame of the part; deviations in um along the outward normal, + material left.

--section   where a plane cuts the part as made (part.vtp; with [stock] alone) and the intended surfaces as they were
            measured (samples.parquet): outline and area of the material, and the deviations along each surface's line.
            z=-5 or n=1,1,0;d=40: points p with n.p = d, n made of length 1. Files: .svg, .pdf, .png, .csv, .vtp.
--distance  between the points of the part's surface that are nearest to two places. Both see the surface as its
            triangles: flat faces are exact, of a radius R they miss pitch^2 / 8 R.
--points    every end of material along the rays of stock.parquet, exact, with its normal and the operation that made
            it; the scene is planned again for the normals. Files: .parquet, .csv, .ply.
--step      every surface measured on a grid as it was machined, a bicubic B-spline face each, through every second
            row and column of its samples; how far the others are off it is told, and stated in the file. Needs
            gearsim[cad].

exit codes:
  0  done
  2  bad input, or nothing of the kind in this folder
"""


def _add_inspect(commands: Any) -> None:
    inspect = commands.add_parser(
        "inspect",
        help="cut sections, take distances, write points or STEP surfaces of what a run has made",
        description="Ask a run's folder about the part as it was machined; without options: what there is.",
        epilog=_INSPECT_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    inspect.add_argument("run", type=Path, metavar="DIR", help="a run's folder")
    inspect.add_argument("--section", nargs=2, action="append", default=[], metavar=("PLANE", "FILE"),
                         help="write the section by a plane; repeatable")  # fmt: skip
    inspect.add_argument("--distance", action="append", default=[], metavar="'X,Y,Z X,Y,Z'",
                         help="measure from point to point; repeatable")  # fmt: skip
    inspect.add_argument("--points", type=Path, metavar="FILE", help="write the ends of all rays as a point cloud")
    inspect.add_argument("--step", type=Path, metavar="FILE", help="write the machined surfaces as STEP")


_ANIMATE_HELP = """examples:
  gearsim animate drill-grid
  gearsim animate spiral-bevel-complete --frames 60 --out gear.webp
  gearsim animate spiral-bevel-flank --set 'stock.spaces="all"' --set stock.pitch_mm=1 --pitch-mm 0.8

every frame is the true stock after so many rows of the program, cut on a tri-dexel of its own: rays --pitch-mm apart
(left out: about 60,000 rays). A scene without [stock] is cut from the part's own blank; a saved one begins as its
closed surface, less than a cell off. Time runs with the tip's way in
feed; the line above tells operation, time in feed and volume. Any browser shows the file.

exit codes:
  0  written
  2  bad input, or nothing here that draws
  3  numerical status that forbids trust
"""


def _add_animate(commands: Any) -> None:
    animate = commands.add_parser(
        "animate",
        help="show a part being cut, operation after operation, as an animated WebP",
        description="Cut a scene's whole part and write what is left after every few rows, with the tool, as one "
        "animated picture.",
        epilog=_ANIMATE_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    animate.add_argument("scene", help="a built-in scene (see 'gearsim scenes') or the path of a .toml file")
    animate.add_argument("--out", type=Path, metavar="FILE", help="a .webp file (default: runs/NAME/cut.webp)")
    animate.add_argument("--frames", type=_positive, default=40, metavar="N",
                         help="about so many, at least two an operation (default: %(default)s)")  # fmt: skip
    animate.add_argument("--pitch-mm", type=_number(1e-3, 1e3), metavar="MM", help="between the rays")
    animate.add_argument("--set", action="append", default=[], metavar="TABLE.KEY=VALUE",
                         help="override a value of the scene; repeatable")  # fmt: skip
    animate.add_argument("--device", default="cpu", help="cpu (default) or cuda:0, cuda:1, ...")


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
    verify.add_argument(
        "--limit-mm", type=_number(1e-12, 1.0), default=1e-9, help="largest distance error (default: %(default)s)"
    )
    verify.add_argument("--out", type=Path, metavar="FILE", help="also write the figures as JSON to this file")
    verify.add_argument("--plot", type=Path, metavar="FILE",
                        help="also draw where over u and v each formula errs (.png, .svg or .pdf)")  # fmt: skip


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


def _names(text: str) -> tuple[str, ...]:
    names = tuple(name.strip() for name in text.split(","))
    if not all(names):
        raise argparse.ArgumentTypeError(f"expected names with commas between them, got {text!r}")
    return names


def _formats(text: str) -> tuple[str, ...]:
    names = _names(text)
    for name in names:
        if name not in _FORMATS:
            raise argparse.ArgumentTypeError(f"expected {' or '.join(_FORMATS)}, with commas between, got {name!r}")
    return names


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"expected a whole number above 0, got {text!r}")
    return int(text)


def _number(least: float, largest: float) -> Callable[[str], float]:
    def read(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            value = 0.0
        if not least <= value <= largest:
            raise argparse.ArgumentTypeError(f"expected a number from {least:g} to {largest:g}, got {text!r}")
        return value

    return read
