"""The command ``gearsim batch``: a study computed, with its progress; stopped cleanly, it says how to go on."""

from __future__ import annotations

import argparse
import signal
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from gearsim.output.jobs_bar import JobsBar
from gearsim.output.screen import print_line
from gearsim.scene.mistakes import short
from gearsim.scene.study import RANDOM
from gearsim.studies.reading import read_study
from gearsim.studies.records import Parameter, Study
from gearsim.studies.run import StudyResult, study
from gearsim.studies.store import STUDY, Store

_LISTED = 8  # values of a parameter that are told one by one
_TOLD = 5  # errors
_STOPPED = 130


def batch(options: argparse.Namespace) -> int:
    """Run the command; its exit code."""
    asked = read_study(options.study, overrides=options.set)
    for note in asked.notes:
        print(f"gearsim: note: {note}", file=sys.stderr)
    out = options.out or Path("runs") / asked.name
    if options.dry_run:
        _print_plan(asked, out)
        return 0
    try:
        with _terminated_like_interrupted(), JobsBar() as progress:
            result = study(
                asked, out, device=options.device, workers=options.workers, scheduler=options.scheduler,
                exr=options.exr, progress=progress, summary=not options.no_summary,
            )  # fmt: skip
    except KeyboardInterrupt:
        told = f"{_kept(asked, out):,} of {len(asked):,} jobs are kept in {out}"
        print(f"gearsim: stopped; {told}; the same command goes on from there", file=sys.stderr)
        return _STOPPED
    _print_result(result)
    return result.exit_code


@contextmanager
def _terminated_like_interrupted() -> Iterator[None]:
    """Meanwhile SIGTERM is Ctrl-C."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _kept(asked: Study, out: Path) -> int:
    """How many jobs are done in a folder."""
    if not (out / STUDY).exists():
        return 0
    return sum(len(asked.jobs_of(chunk)) for chunk in Store(out, asked).done())


def _print_plan(asked: Study, out: Path) -> None:
    """What would be computed. Raises InputError where the folder is another study's, as computing it would."""
    Store(out, asked).refuse_another()
    chunks = "1 chunk" if asked.chunks == 1 else f"{asked.chunks:,} chunks"
    seed = f", seed {asked.seed}" if asked.method in RANDOM else ""
    print_line(f"{asked.name}: {len(asked):,} jobs in {chunks}, by {asked.method}{seed}")
    width = max(len(p.key) for p in asked.parameters)
    for parameter in asked.parameters:
        print_line(f"  {parameter.key:{width}}  {_values(parameter)}")
    print_line(f"{_kept(asked, out):,} jobs are kept in {out}; nothing was computed.")


def _values(parameter: Parameter) -> str:
    unit = "" if parameter.unit == "1" else f" {parameter.unit}"
    different = list(dict.fromkeys(parameter.values))
    if len(different) <= _LISTED or isinstance(different[0], str):
        return short(different).strip("[]") + unit
    numbers = [float(v) for v in different]
    return f"{len(different):,} values from {min(numbers):g} to {max(numbers):g}{unit}"


def _print_result(result: StudyResult) -> None:
    """How many jobs have which verdict, and what the errors were."""
    counts = ", ".join(f"{count:,} {verdict}" for verdict, count in result.counts.items())
    if result.counts.get("error"):
        rows = result.table.select(["job", "error"]).to_pylist()
        errors = Counter(row["error"] for row in rows if row["error"])
        for text, count in errors.most_common(_TOLD):
            first = next(row["job"] for row in rows if row["error"] == text)
            print_line(f"{count:,} {'job has' if count == 1 else 'jobs have'} an error, job {first} first: {text}")
        if len(errors) > _TOLD:
            print_line(f"... and {len(errors) - _TOLD:,} other errors; jobs.parquet has them all")
    print_line(f"{result.study.name}: {sum(result.counts.values()):,} jobs: {counts}   data set: {result.folder}")
