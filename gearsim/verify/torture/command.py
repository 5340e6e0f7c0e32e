"""The torture in its sizes, behind ``gearsim verify --torture SIZE``."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from time import perf_counter

from gearsim.errors import InputError, written
from gearsim.output.screen import ScreenProgress
from gearsim.output.summary import write_json
from gearsim.verify.torture import motions, rays, tools
from gearsim.verify.torture.campaign import Case, case, try_cases
from gearsim.verify.torture.defects import defects, unsettled
from gearsim.verify.torture.judge import prepare
from gearsim.verify.torture.report import Figures, print_report, summary

TOLERANCE = 1e-9
PAIRS = {"small": 12_000, "medium": 800_000, "large": 10_000_000}
_RAYS_A_KIND = {"small": 4, "medium": 24, "large": 48}
_CASES = 48


def run_torture(options: argparse.Namespace) -> int:
    """``gearsim verify --torture``: print what was found, write it where asked; the exit code."""
    if options.scenes or options.surface:
        raise InputError("--torture takes no scene and no --surface: it makes its own tools and motions")
    size, seed = options.torture, options.seed
    with ScreenProgress() as progress:
        progress.stage(f"torture, {size}", PAIRS.get(size, 0))
        figures, seconds = torture(size, seed, progress.advance)
    print_report(figures, seconds)
    if options.out:
        with written(options.out) as scratch:
            write_json(summary(figures, size, seed, seconds), scratch)
    return figures.exit_code


def torture(size: str, seed: int, progress: Callable[[int], None] = lambda n: None) -> tuple[Figures, float]:
    """Try as many ray-row pairs as the size says; what was found, and the seconds it took.

    ``progress`` is told of pairs done. Raises InputError for an unknown size.
    """
    if size not in PAIRS:
        raise InputError(f"no torture of size {size!r}; there are {', '.join(PAIRS)}")
    started, figures, batch = perf_counter(), Figures(), 0
    prepare(thorough=size != "small")
    with ThreadPoolExecutor(1) as ahead:
        following = ahead.submit(_planned_batch, seed, batch, size)
        while figures.pairs < PAIRS[size]:
            cases, done, batch = following.result(), figures.pairs, batch + 1
            following = ahead.submit(_planned_batch, seed, batch, size)
            for tried in try_cases(cases, TOLERANCE):
                figures.add(tried, defects(tried, TOLERANCE), unsettled(tried, TOLERANCE))
            progress(figures.pairs - done)
    return figures, perf_counter() - started


def _planned_batch(seed: int, batch: int, size: str) -> list[Case]:
    return [planned((seed, batch, i), size) for i in range(_CASES)]


def planned(seed: tuple[int, ...], size: str) -> Case:
    """The case of a seed: tools and motions take turns, so that every kind comes in every size."""
    turn = seed[1] * _CASES + seed[2]
    tool = tools.KINDS[turn % len(tools.KINDS)]
    motion = list(motions.KINDS)[(turn // len(tools.KINDS) + turn) % len(motions.KINDS)]
    return case(seed, tool, motion, list(rays.KINDS), _RAYS_A_KIND[size] // (4 if tool in tools.RINGS else 1))
