"""A study read: every mistake of its file and of its jobs' tables is told before the first job."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from typing import Any

from gearsim.errors import InputError
from gearsim.scene import Scene, check_scene, scene_table, scene_text
from gearsim.scene.keys import plain, put, with_lists
from gearsim.scene.loading import read_override, scene_of, toml_tables
from gearsim.scene.study import StudyHeader, StudyTables, VaryTable, checked_study, mistaken
from gearsim.scene.study_files import study_tables
from gearsim.studies.records import Asked, Parameter, Study
from gearsim.studies.sampling import parameters, told

_MOST_CHECKED = 5_000  # jobs whose tables are validated one by one, beside those at the ends of every key's range
_MOST_VALUES = 1_000  # of a key in those: a longer list is looked at by its ends
_GRID = ("metrology.rows", "metrology.columns")


def read_study(
    source: str | Path | Mapping[str, Any], folder: Path | None = None, overrides: Sequence[str] = ()
) -> Study:
    """A study by built-in name, path or as nested plain tables, with the values of all its jobs.

    ``folder``: where a scene's relative path begins (default: the study file's own folder). ``overrides``:
    ``table.key=value``; those of ``study`` change the study (``study.samples=64``), others the scene in all jobs.

    Raises InputError that names file, table and key of every mistake: of the study's own tables, of its scene, and of
    what the varied keys make of the scene's tables; whether a job's geometry is possible is for the job to find.
    """
    tables, label, beside = _given(source)
    for override in overrides:
        _override(tables, override)
    checked = checked_study(tables, label)
    head, varied = checked.study, checked.vary
    data, name, found_in = _scene_tables(head, label, folder or beside)
    scene = check_scene(deepcopy(data), f"{name} under [study.set] of study {label}" if head.set else name)
    _refuse_unequal(checked, scene, label)
    found = parameters(head, varied, label)
    base = with_lists(data, [p.key for p in found], plain(scene_table(scene)))
    _check_jobs(base, found, varied, label)
    return Study(
        name=head.name, summary=head.summary, tables=base, folder=found_in.resolve(), parameters=found,
        method=head.method, seed=head.seed, asked=Asked(head.measure, head.cross_checked), chunk=head.chunk,
        source=plain(tables), notes=told(head),
    )  # fmt: skip


def _given(source: str | Path | Mapping[str, Any]) -> tuple[dict[str, Any], str, Path]:
    """The study's tables, the name to use in messages, and the folder of its file."""
    if not isinstance(source, Mapping):
        return study_tables(str(source))
    header = source.get("study")
    name = header.get("name") if isinstance(header, Mapping) else None
    return deepcopy(dict(source)), str(name or "given as tables"), Path()


def _override(tables: dict[str, Any], override: str) -> None:
    key, value = read_override(override)
    table, _, rest = key.partition(".")
    header = tables.setdefault("study", {})
    if table == "study" and isinstance(header, dict):
        put(header, rest, value)
        return
    fixed = header.setdefault("set", {}) if isinstance(header, dict) else None
    if isinstance(fixed, dict):  # else the study's own check tells
        _forget(fixed, key)
        fixed[key] = value


def _forget(table: dict[str, Any], key: str) -> None:
    """Remove a value that a study sets as nested tables."""
    first, dot, rest = key.partition(".")
    if dot and isinstance(table.get(first), dict):
        _forget(table[first], rest)
    table.pop(key, None)


def _scene_tables(head: StudyHeader, label: str, beside: Path) -> tuple[dict[str, Any], str, Path]:
    """The scene's tables under the values that all jobs have, its name in messages and its files' folder."""
    try:
        text, name, folder = scene_text(head.scene, beside)
    except InputError as error:
        raise mistaken(label, [f"study.scene: {error}"]) from None
    data = toml_tables(text, f"scene {name}")
    if any(part.isdecimal() for key in head.fixed for part in key.split(".")):
        data = with_lists(data, list(head.fixed), plain(scene_table(scene_of(deepcopy(data), name))))
    for key, value in head.fixed.items():
        try:
            put(data, key, value)
        except InputError as error:
            raise mistaken(label, [f"study.set: {error}"]) from None
    return data, name, folder


def _refuse_unequal(checked: StudyTables, scene: Scene, label: str) -> None:
    """Raises InputError where what is measured does not go with the scene or with what varies."""
    measure, metrology = checked.study.measure, getattr(scene, "metrology", None)
    problems = [
        f"vary.{i}: {key} varies, and the maps of all jobs are one array: fix it in [study.set], or measure = [\"iso\"]"
        for i, vary in enumerate(checked.vary) for key in vary.names if key in _GRID and "maps" in measure
    ]  # fmt: skip
    if "iso" in measure and not hasattr(metrology, "iso_class"):
        problems.append("study.measure: iso is for cylindrical gears, whose metrology.iso_class asks for a class")
    if problems:
        raise mistaken(label, problems)


def _check_jobs(base: dict[str, Any], found: Sequence[Parameter], varied: Sequence[VaryTable], label: str) -> None:
    """Raises InputError where a job's tables are no scene's: which key, which value, in how many jobs."""
    tables, count = deepcopy(base), len(found[0].values)
    jobs = _looked_at(found, count)
    faults: dict[tuple[str, str], tuple[str, list[int]]] = {}
    for job in jobs:
        for text in _job_mistakes(tables, found, job, label):
            place, wanted = text.partition(": ")[0], text.rpartition("; ")[2]
            faults.setdefault((place, wanted), (text, []))[1].append(job)
    if faults:
        raise mistaken(label, [_told(*fault, jobs, count, varied) for fault in faults.values()])


def _job_mistakes(tables: dict[str, Any], found: Sequence[Parameter], job: int, label: str) -> list[str]:
    try:
        for parameter in found:
            put(tables, parameter.key, parameter.values[job])
        scene_of(tables, label)
    except InputError as error:
        return str(error).split("\n  - ")[1:] or [str(error)]  # without the line that counts them
    return []


def _looked_at(found: Sequence[Parameter], count: int) -> list[int]:
    """The jobs whose tables are validated: all, or evenly chosen ones and those at the ends of every key's range."""
    jobs = set(range(0, count, -(-count // _MOST_CHECKED)))
    if len(jobs) < count:
        for parameter in found:
            jobs |= set(_telling(parameter.values))
    return sorted(jobs)


def _telling(values: Sequence[Any]) -> Iterable[int]:
    """Where each of a few values stands first, or the least and the largest of many."""
    first: dict[Any, int] = {}
    for i, value in enumerate(values):
        first.setdefault(value, i)
    if len(first) <= _MOST_VALUES:
        return first.values()
    return first[min(first)], first[max(first)]


def _one_within_another(key: str, other: str) -> bool:
    return f"{key}.".startswith(f"{other}.") or other.startswith(f"{key}.")


def _told(text: str, at: list[int], jobs: list[int], count: int, varied: Sequence[VaryTable]) -> str:
    """A mistake of jobs' tables, and which [[vary]] makes it in how many of them."""
    place = text.partition(": ")[0]
    names = ((i, key) for i, vary in enumerate(varied) for key in vary.names)
    maker = next((f"vary.{i} ({key}): " for i, key in names if _one_within_another(key, place)), "")
    if len(at) == len(jobs):
        return f"{maker}{text}" + (f" (all {count:,} jobs)" if "unknown key" not in text else "")
    looked = f"{count:,}" if len(jobs) == count else f"{len(jobs):,} looked at of {count:,}"
    return f"{maker}{text} ({len(at):,} of {looked} jobs, first in job {at[0]})"
