"""Scenes by name or path: TOML read, checked, and every mistake told at once."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path, PurePath
from re import search
from typing import Any

from pydantic import ValidationError

from gearsim.errors import InputError, is_file, is_folder, read_input
from gearsim.scene.any_program import AXIS_TABLE, GCODE, ProgramScene
from gearsim.scene.base import Scene
from gearsim.scene.cylindrical import CylindricalGearScene
from gearsim.scene.faced_part import FacedScene
from gearsim.scene.flank_milling import FlankMillingScene
from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, HypoidScene
from gearsim.scene.mistakes import explained, short
from gearsim.scene.sculptured import GougeExampleScene, SculpturedScene
from gearsim.scene.solid_part import SolidScene

SCENES: dict[str, type[Scene]] = {
    "ruled-bevel": FlankMillingScene,
    "face-milled-flank": FlankMillingScene,
    "envelope": EnvelopeScene,
    "face-milled": FaceMillingScene,
    "hypoid-pinion": HypoidScene,
    "cylindrical-gear": CylindricalGearScene,
    "nurbs": SculpturedScene,
    "gouge-example": GougeExampleScene,
    "solid-part": SolidScene,
    "faced-part": FacedScene,
}

_CL_READERS = ("ruled-bevel", "face-milled-flank")
_PLANNED = {"nurbs": ("contact", "drop")}  # what toolpath.kind names beside "program"; other planners have one kind
_OF_ONE_MOTION = (
    "envelope",
    "gouge-example",
    "solid-part",
    "faced-part",
)  # surfaces that are cut by what stands in their scene alone


def scene_names() -> dict[str, str]:
    """Built-in scenes and their one-line summaries."""
    return {name: tomllib.loads(_built_in_text(name))["scene"]["summary"] for name in _built_in()}


def _built_in() -> list[str]:
    names = (entry.name for entry in files("gearsim.scenes").iterdir())
    return sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml"))


def _built_in_text(name: str) -> str:
    return files("gearsim.scenes").joinpath(f"{name}.toml").read_text("utf-8")


def scene_text(name_or_path: str, beside: Path | None = None) -> tuple[str, str, Path]:
    """TOML text of a built-in scene or file, the name to use in messages, and its folder.

    ``beside``: the folder in which relative paths begin, if it is not the working directory.
    """
    path = (beside or Path()) / name_or_path
    if name_or_path in _built_in():
        return _built_in_text(name_or_path), name_or_path, Path()
    if is_file(path) or (name_or_path and is_folder(path)):
        return read_input(path, "scene"), str(path), path.parent
    near = get_close_matches(name_or_path, [*_scene_files(path.parent), *_built_in()], n=1, cutoff=0.4)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    if path.suffix == ".toml":
        raise InputError(f"cannot read scene {name_or_path!r}: there is no such file{hint}")
    raise InputError(
        f"no scene named {name_or_path!r}{hint} Built-in scenes: {', '.join(_built_in())}. "
        "Or give the path of a .toml file."
    )


def scene_beside(name: str) -> Path | None:
    """A file that may be meant by the name of a built-in scene, which is what the name stands for."""
    if name not in _built_in():
        return None
    return next((path for path in (Path(f"{name}.toml"), Path(name)) if is_file(path)), None)


def _scene_files(folder: Path) -> list[str]:
    """The .toml files of a folder, none where it cannot be looked into."""
    try:
        return sorted(str(file) for file in folder.glob("*.toml"))
    except (OSError, ValueError):
        return []


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
    path = data.get("toolpath")
    if model is not FlankMillingScene or not isinstance(path, dict) or not isinstance(path.get("file"), str):
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
        near = get_close_matches(str(kind), SCENES, n=1, cutoff=0.4)
        hint = f"did you mean {near[0]!r}?" if near else f"there are {', '.join(SCENES)}"
        raise _input_error(label, [f"surface.kind: {'missing' if kind is None else f'got {kind!r}'}; {hint}"])
    return ProgramScene if _own_program(kind, data, label) else SCENES[kind]


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
