"""The command ``gearsim bench``: suites to the screen and to a file."""

from __future__ import annotations

import argparse

from gearsim.bench.suites import SUITES, run_suite
from gearsim.errors import InputError, written
from gearsim.output.screen import print_bench
from gearsim.output.summary import write_json


def bench(options: argparse.Namespace) -> int:
    """Run a suite as asked, or list them; returns the exit code. Raises InputError as ``run_suite`` does."""
    if options.peers and options.suite:
        raise InputError("--peers takes no suite; give one or the other")
    suite = "peers" if options.peers else options.suite
    if suite is None:
        if options.against:
            raise InputError("--against goes with a suite: gearsim bench scenes --against VENV")
        for name, measure in SUITES.items():
            print(f"{name:{max(map(len, SUITES))}}  {(measure.__doc__ or '').splitlines()[0]}")
        return 0
    report = run_suite(suite, options.device, options.size, options.against)
    print_bench(report)
    if options.out:
        with written(options.out) as scratch:
            write_json(report, scratch)
    return 0
