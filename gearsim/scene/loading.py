"""Scenes by name or path: TOML read, checked, and every mistake told at once."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from difflib import get_close_matches
from pathlib import Path, PurePath
from re import search
from typing import Any

from pydantic import ValidationError

from gearsim.errors import InputError
from gearsim.scene.base import Scene
from gearsim.scene.built_in import scene_text
from gearsim.scene.kinds import AXIS_TABLE, GCODE, PROGRAM, SCENES, scene_class
from gearsim.scene.mistakes import explained, short

_CL_READERS = ("ruled-bevel", "face-milled-flank")
_PLANNED = {"nurbs": ("contact", "drop")}  # what toolpath.kind names beside "program"; other planners have one kind
_OF_ONE_MOTION = (
    "envelope",
    "gouge-example",
    "solid-part",
    "faced-part",
)  # surfaces that are cut by what stands in their scene alone


def load_scene(name_or_path: str | Path, overrides: Sequence[str] = ()) -> tuple[Scene, Path]:
    """A scene by built-in name or path, with ``key=value`` overrides; and the folder its files are in.

    Raises InputError that lists every mistake found.
    """
    text, label, folder = scene_text(str(name_or_path))
    data = toml_tables(text, f"scene {label}")
    for override in overrides:
        _override(data, override)
    return check_scene(data, label), folder


def toml_tables(text: str, what: str) -> dict[str, Any]:
    """The nested tables of a TOML text. Raises InputError with the line that is none, and ``what`` it should be."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{what}: not valid TOML: {error}{_line_of(error, text)}") from error


def _line_of(error: tomllib.TOMLDecodeError, text: str) -> str:
    """The line that an error names, as it stands in the file."""
    number, lines = search(r"\(at line (\d+),", str(error)), text.split("\n")
    return f": {short(lines[int(number[1]) - 1].strip())}" if number else ""


def check_scene(data: dict[str, Any], label: str) -> Scene:
    """Validate a scene given as nested tables. Raises InputError that lists every mistake found."""
    scene = scene_of(data, label)
    problems = []
    for build in scene.builders():
        try:
            build()
        except InputError as error:
            problems.append(str(error))
    if problems:
        raise _input_error(label, problems)
    return scene


def scene_of(data: dict[str, Any], label: str) -> Scene:
    """A scene given as nested tables, its keys and values checked; whether its geometry is possible is not.

    Raises InputError that lists every mistake found.
    """
    model = _model(data, label)
    try:
        return model.model_validate(data)
    except ValidationError as error:
        raise _input_error(label, explained(error, data, model) + _read_as_cl(data, model)) from None


def _read_as_cl(data: dict[str, Any], model: type[Scene]) -> list[str]:
    """That a file counts as CL data by its ending, where the scene has tables for other programs."""
    path, reader = data.get("toolpath"), scene_class(SCENES[_CL_READERS[0]])
    if model is not reader or not isinstance(path, dict) or not isinstance(path.get("file"), str):
        return []
    others = [name for name in ("machine", "control", "tools") if name in data]
    if not others and "mounting" not in path:
        return []
    endings = f"G-code ends in {', '.join(sorted(GCODE))}, axis values in {AXIS_TABLE}"
    return [f"toolpath.file: {short(path['file'])} is read as CL data by its ending; {endings}"]


def _model(data: dict[str, Any], label: str) -> type[Scene]:
    """The kind of scene, by the surface it wants."""
    surface = data.get("surface")
    kind = surface.get("kind") if isinstance(surface, dict) else None
    if not isinstance(kind, str) or kind not in SCENES:
        if surface is None and "study" in data:
            raise _input_error(label, ["study: this file is a study, no scene; gearsim batch computes it"])
        near = get_close_matches(str(kind), SCENES, n=1, cutoff=0.4)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(SCENES)}"
        raise _input_error(label, [f"surface.kind: {'missing' if kind is None else f'got {kind!r}'}; {hint}"])
    return scene_class(PROGRAM if _own_program(kind, data, label) else SCENES[kind])


def _own_program(kind: str, data: dict[str, Any], label: str) -> bool:
    """Whether the toolpath is a file that scenes of the surface's own kind do not read.

    Raises InputError where a surface is not cut along a toolpath of that kind.
    """
    table = data.get("toolpath")
    if not isinstance(table, dict):
        return False
    file, asked = table.get("file"), table.get("kind")
    programs = kind not in _OF_ONE_MOTION
    known = (*_PLANNED.get(kind, ()), *["program"] * programs)
    if (asked is not None and asked not in known) or (file is not None and not programs):
        raise _input_error(label, [_no_combination(kind, asked, known)])
    gcode = isinstance(file, str) and PurePath(file).suffix.lower() in (*GCODE, AXIS_TABLE)
    return asked == "program" or gcode or (file is not None and kind not in _CL_READERS)


def _no_combination(kind: str, asked: Any, known: Sequence[str]) -> str:
    """Which toolpaths cut a surface, where it is not the one asked for."""
    if not known:
        able = ", ".join(name for name in SCENES if name not in _OF_ONE_MOTION)
        alone = f"toolpath: a surface of kind {kind!r} is made by its scene's own motion alone"
        return f"{alone}; programs from a file cut {able}"
    own = "" if kind in _PLANNED else "its own planner (no kind) or "
    return f"toolpath.kind: got {asked!r}; a surface of kind {kind!r} is cut by {own}{' or '.join(map(repr, known))}"


def _input_error(label: str, problems: list[str]) -> InputError:
    count = "1 mistake" if len(problems) == 1 else f"{len(problems)} mistakes"
    return InputError(f"scene {label}: {count}:" + "".join(f"\n  - {p}" for p in problems))


def _override(data: dict[str, Any], override: str) -> None:
    """Apply one ``table.key=value`` to the tables."""
    key, value = read_override(override)
    parts, table = key.split("."), data
    for part in parts[:-1]:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise InputError(f"--set {override}: {part!r} is a value, not a table")
    table[parts[-1]] = value


def read_override(override: str) -> tuple[str, Any]:
    """Key and value of one ``table.key=value``; the value is read as TOML, else as a string.

    Raises InputError where it is no such assignment.
    """
    key, equals, value = override.partition("=")
    if not equals or "." not in key:
        raise InputError(f"--set {override}: expected table.key=value, for instance metrology.rows=9")
    try:
        parsed = tomllib.loads(f"value = {value}")
    except tomllib.TOMLDecodeError:
        parsed = {"value": value}
    if list(parsed) != ["value"]:
        raise InputError(f"--set {override!r}: expected one value, for instance metrology.rows=9")
    return key.strip(), parsed["value"]


def scene_table(scene: Scene) -> dict[str, Any]:
    """The scene as nested plain tables, defaults filled in, as it goes into the report."""
    return scene.model_dump(exclude_none=True)
