"""What ``gearsim batch`` understands, and its help."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

_HELP = """examples:
  gearsim batch cl-density --dry-run
  gearsim batch cl-density --out results
  gearsim batch taper-radius --set study.samples=256 --workers 2
  gearsim batch my-study.toml --out /shared/results --scheduler tcp://HOST:8786

a study is a TOML file: a scene, and the keys of it that vary (docs/batch.md has all of them):
  [study]
  name = "my-study"
  scene = "spiral-bevel-flank"    # built-in, or a path seen from this file
  method = "monte-carlo"          # or grid, list, latin-hypercube, sobol
  samples = 1000                  # not for grid and list
  seed = 1
  cross_checked = 0.01            # share of jobs judged by both roads; 1 (default): all, some seconds each
  [study.set]                     # for all jobs
  metrology.rows = 17
  [[vary]]
  key = "cutter.taper_deg"        # any key of the scene; errors.pivot_um.2 is a place in a list
  distribution = "normal"         # uniform: low, high, scale = "log"; normal: mean, deviation, lower, upper;
  mean = 15.0                     # triangular: low, mode, high; tolerance: nominal, tolerance (3 deviations);
  deviation = 0.02                # of a grid or list: values = [...], or low, high and count

in DIR: jobs.parquet (a row a job: parameters, figures, verdict, error), maps.zarr, timings.parquet, manifest.json,
summary.html. Jobs are kept as they are done: stopped by Ctrl-C, or killed, the same command goes on from there.

exit codes:
  0    every job has its result; their verdicts stand in jobs.parquet
  1    some jobs could not be done; their rows say why
  2    bad input, a folder that cannot be written, or a cluster that was lost
  130  stopped
"""


def add_batch(commands: Any, positive: Callable[[str], int]) -> None:
    """Add the command; ``positive`` reads a whole number above 0."""
    batch = commands.add_parser(
        "batch",
        help="compute a study: a scene under many values of some of its keys, as a data set",
        description="Compute all jobs of a study, here or on many machines, and make a data set of them.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    batch.add_argument("study", help="a built-in study (see 'gearsim studies') or the path of a .toml file")
    batch.add_argument("--out", type=Path, metavar="DIR", help="the study's folder (default: runs/NAME)")
    batch.add_argument("--set", action="append", default=[], metavar="TABLE.KEY=VALUE",
                       help="of the study (study.samples=64), or of the scene in all jobs; repeatable")  # fmt: skip
    batch.add_argument("--device", default="cpu", help="cpu (default) or cuda:0, cuda:1, ...; of every worker")
    where = batch.add_mutually_exclusive_group()
    where.add_argument("--workers", type=positive, metavar="N",
                       help="compute in N processes of one core each (pip install 'gearsim[batch]')")  # fmt: skip
    where.add_argument("--scheduler", metavar="ADDRESS", help="compute on the workers of a running Dask scheduler")
    batch.add_argument("--exr", action="store_true", help="write an EXR file a job, too")
    batch.add_argument("--no-summary", action="store_true", help="write data alone, no summary.html")
    batch.add_argument("--dry-run", action="store_true", help="say what would be computed; compute nothing")
