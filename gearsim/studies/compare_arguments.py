"""What ``gearsim compare`` understands."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

_HELP = """examples:
  gearsim compare runs/before runs/after
  gearsim compare studies/wear studies/wear-finer --beyond 0.01 --out changes.json

runs        every value of report.json but times and versions, every column of samples.parquet sample by sample, the
            programs byte by byte
studies     jobs matched by their parameters' values, whatever their numbers: every figure, verdict and map

noise       at most UM of a length in um, a thousandth of it in mm and deg, or 1e-9 of the number. How the two were
            asked for, where not alike, is told as a note and makes no difference by itself.

exit codes:
  0  the same but for noise
  1  something changed, or stands in one alone
  2  bad input
"""


def add_compare(commands: Any) -> None:
    """Add the command to the others."""
    compare = commands.add_parser(
        "compare",
        help="say what changed beyond noise between two runs or two data sets of studies",
        description="Compare two runs' folders, or two studies' data sets: what changed beyond noise, and where most.",
        epilog=_HELP,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    compare.add_argument("a", type=Path, metavar="A", help="a run's or a study's folder")
    compare.add_argument("b", type=Path, metavar="B", help="another one of the same kind")
    compare.add_argument("--beyond", type=_um, default=1e-6, metavar="UM",
                         help="what is a change, in um (default: %(default)s)")  # fmt: skip
    compare.add_argument("--out", type=Path, metavar="FILE", help="also write all changes as JSON to this file")


def _um(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        value = -1.0
    if not 0.0 <= value <= 1e6:
        raise argparse.ArgumentTypeError(f"expected a number of um from 0 to 1e6, got {text!r}")
    return value
