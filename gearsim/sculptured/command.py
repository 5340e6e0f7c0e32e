"""The command ``gearsim gouge``."""

from __future__ import annotations

import argparse

from rich.console import Console

from gearsim.errors import InputError
from gearsim.output.files import staged
from gearsim.output.gouging.check import print_check, write_check
from gearsim.scene.catalogue import read_cutter
from gearsim.sculptured.check import check_surface, read_mills, read_surface


def gouge(options: argparse.Namespace) -> int:
    """Look at a surface, print the answer, write the files if asked; returns the exit code."""
    if options.grid < 2:
        raise InputError(f"--grid {options.grid}: at least 2 points a side are needed")
    if not 0.0 <= options.margin < 0.5:
        raise InputError(f"--margin {options.margin:g}: expected a share from 0 to below 0.5")
    surface, count = read_surface(options.surface, options.number, options.flip)
    cutter, mills = read_cutter(options.cutter), read_mills(options.catalogue)
    check = check_surface(surface, cutter, mills, grid=options.grid, margin=options.margin, axis=options.axis,
                          device=options.device)  # fmt: skip
    console = Console(highlight=False, soft_wrap=True)
    if count > 1:
        console.print(f"{options.surface} holds {count} surfaces; this is number {options.number}")
    print_check(check, console)
    if options.out:
        with staged(options.out) as stage:
            write_check(check, stage)
        console.print(f"report: {options.out / 'report.html'}")
    return check.exit_code
