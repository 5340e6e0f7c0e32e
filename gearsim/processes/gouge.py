"""The command ``gearsim gouge``."""

from __future__ import annotations

import argparse

from rich.console import Console

from gearsim.errors import InputError
from gearsim.gouging.asked import read_faces, read_mills
from gearsim.gouging.check import check_faces
from gearsim.output.files import into, staged
from gearsim.output.gouging.check import print_check, write_check
from gearsim.scene.catalogue import read_cutter


def gouge(options: argparse.Namespace) -> int:
    """Look at the faces of a file, print the answer, write the files if asked; returns the exit code."""
    if options.grid < 2:
        raise InputError(f"--grid {options.grid}: at least 2 points a side are needed")
    if not 0.0 <= options.margin < 0.5:
        raise InputError(f"--margin {options.margin:g}: expected a share from 0 to below 0.5")
    asked = read_faces(options.surface, options.number, options.flip)
    cutter, mills = read_cutter(options.cutter), read_mills(options.catalogue)
    check = check_faces(asked, cutter, mills, grid=options.grid, margin=options.margin, axis=options.axis,
                        device=options.device)  # fmt: skip
    console = Console(highlight=False, soft_wrap=True)
    print_check(check, console)
    if options.out:
        with staged(options.out) as stage, into(options.out):
            write_check(check, stage)
        console.print(f"report: {options.out / 'report.html'}")
    return check.exit_code
