"""The verb ``gearsim verify``: scenes, a surface file or a point list in, reports out."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from time import perf_counter

from gearsim.errors import InputError
from gearsim.programs.point_list import read_points, write_points
from gearsim.scene import load_scene, scene_names
from gearsim.verify.checks import FormReport, Limits, verify_form
from gearsim.verify.closed_form import ClosedForm
from gearsim.verify.points import machined_points, verify_points
from gearsim.verify.report import SubjectReport
from gearsim.verify.scenes import closed_forms
from gearsim.verify.user_surface import load_surface

Subjects = dict[str, list[ClosedForm]]
GRID = (9, 33)


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
    written = []
    for form in _only(subjects, "--write-points")[1]:
        points = machined_points(form, *GRID)
        if len(points.point):
            slug = re.sub(r"[^a-z0-9]+", "-", form.name.lower().replace("+", "plus").replace("-1", "minus1")).strip("-")
            target = file.with_name(f"{file.stem}-{slug}{file.suffix}")
            write_points(points, target)
            written.append(target)
    return written


def _only(subjects: Subjects, option: str) -> tuple[str, list[ClosedForm]]:
    declared = [(name, forms) for name, forms in subjects.items() if forms]
    if len(declared) != 1:
        raise InputError(f"{option} needs exactly one scene with a closed form, or --surface FILE; got {len(declared)}")
    return declared[0]


def _timed(name: str, run: Callable[[], list[FormReport]]) -> SubjectReport:
    started = perf_counter()
    forms = tuple(run())
    return SubjectReport(name, forms, perf_counter() - started)
