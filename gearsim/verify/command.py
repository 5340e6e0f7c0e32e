"""The verb ``gearsim verify``: scenes, a surface file or a point list in, reports out."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter

from gearsim.errors import InputError, written
from gearsim.output.summary import write_json
from gearsim.programs.point_list import read_points, write_points
from gearsim.scene import load_scene, scene_names
from gearsim.verify.checks import FormReport, Limits, verify_form
from gearsim.verify.closed_form import ClosedForm, file_name
from gearsim.verify.points import machined_points, verify_points
from gearsim.verify.report import SubjectReport, exit_code, print_report, summary
from gearsim.verify.scenes import closed_forms
from gearsim.verify.user_surface import load_surface

Subjects = dict[str, list[ClosedForm]]
GRID = (9, 33)


def verify(options: argparse.Namespace) -> int:
    """Check what is asked for, print and write what is found; returns the exit code."""
    _check_plot(options)
    if options.torture:
        from gearsim.verify.torture.command import run_torture

        return run_torture(options)
    limits = Limits(distance_mm=options.limit_mm)
    subjects = subjects_of(options.scenes, options.surface)
    if options.write_points:
        for file in write_lists(subjects, options.write_points):
            print(f"wrote {file}")
        return 0
    if options.points_file:
        reports = verify_list(subjects, options.points_file, limits)
    else:
        reports = verify_all(subjects, options.points, options.seed, limits)
    print_report(reports)
    if options.out:
        with written(options.out) as scratch:
            write_json(summary(reports, limits, options.seed), scratch)
    if options.plot:
        from gearsim.verify.plot import plot_maps

        print(*plot_maps(reports, limits, options.plot), sep="\n")
    return exit_code(reports)


def _check_plot(options: argparse.Namespace) -> None:
    """Refuse a picture that cannot be drawn before anything is computed."""
    if not options.plot:
        return
    if options.torture:
        raise InputError("--plot draws the errors of a formula; --torture checks none")
    if options.points_file or options.write_points:
        raise InputError("--plot draws a formula over its parameters u and v; a point list has none")
    from gearsim.verify.plot import check_plot

    check_plot(options.plot)


def subjects_of(scenes: Sequence[str], surface: Path | None) -> Subjects:
    """Closed forms by the name of what declares them; every built-in scene where nothing is named."""
    names = list(scenes) if scenes or surface else list(scene_names())
    subjects = {name: closed_forms(*load_scene(name)) for name in names}
    return subjects if surface is None else {**subjects, str(surface): [load_surface(surface)]}


def verify_all(subjects: Subjects, points: int, seed: int, limits: Limits) -> list[SubjectReport]:
    """Every closed form of every subject, checked at random points."""
    return [_timed(name, partial(_checked, forms, points, seed, limits)) for name, forms in subjects.items()]


def _checked(forms: list[ClosedForm], points: int, seed: int, limits: Limits) -> list[FormReport]:
    return [verify_form(form, points, seed, limits) for form in forms]


def verify_list(subjects: Subjects, file: Path, limits: Limits) -> list[SubjectReport]:
    """A point list, checked against the one subject's tool and motion."""
    name, forms = _only(subjects, "--points-file")
    points = read_points(file)
    return [_timed(f"{name}, {file}", lambda: [verify_points(forms, points, str(file), limits)])]


def write_lists(subjects: Subjects, file: Path) -> list[Path]:
    """The one subject's surfaces as point lists; every file's name is ``file``'s with the surface's put in."""
    name, forms = _only(subjects, "--write-points")
    files = []
    for form in forms:
        points = machined_points(form, *GRID)
        if len(points.point):
            target = file.with_name(f"{file.stem}-{file_name(form.name)}{file.suffix}")
            write_points(points, target)
            files.append(target)
    if not files:
        raise InputError(f"--write-points {file}: no surface of {name} has a point that its motion leaves")
    return files


def _only(subjects: Subjects, option: str) -> tuple[str, list[ClosedForm]]:
    declared = [(name, forms) for name, forms in subjects.items() if forms]
    if len(declared) != 1:
        raise InputError(f"{option} needs exactly one scene with a closed form, or --surface FILE; got {len(declared)}")
    return declared[0]


def _timed(name: str, run: Callable[[], list[FormReport]]) -> SubjectReport:
    started = perf_counter()
    forms = tuple(run())
    return SubjectReport(name, forms, perf_counter() - started)
