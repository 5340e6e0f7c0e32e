"""Scenes by name or path: TOML read, checked, and every mistake told at once."""

from __future__ import annotations

import tomllib
from collections.abc import Sequence
from difflib import get_close_matches
from importlib.resources import files
from math import degrees
from pathlib import Path, PurePath
from typing import Any, get_args

from pydantic import ValidationError

from gearsim.errors import InputError, is_file, read_input
from gearsim.scene.any_program import AXIS_TABLE, GCODE, ProgramScene
from gearsim.scene.cylindrical import CylindricalGearScene
from gearsim.scene.flank_milling import FlankMillingScene
from gearsim.scene.generated import EnvelopeScene, FaceMillingScene, HypoidScene
from gearsim.scene.sculptured import GougeExampleScene, SculpturedScene
from gearsim.scene.tables import Scene, Table

SCENES: dict[str, type[Scene]] = {
    "ruled-bevel": FlankMillingScene,
    "face-milled-flank": FlankMillingScene,
    "envelope": EnvelopeScene,
    "face-milled": FaceMillingScene,
    "hypoid-pinion": HypoidScene,
    "cylindrical-gear": CylindricalGearScene,
    "nurbs": SculpturedScene,
    "gouge-example": GougeExampleScene,
}

_LONGEST = 80  # characters of a value in a message
_WANTED = {
    "tuple_type": "expected a list",
    "model_type": "expected a table",
    "model_attributes_type": "expected a table",
    "dict_type": "expected a table",
    "int_type": "expected a whole number",
    "float_type": "expected a number",
    "bool_type": "expected true or false",
    "string_type": "expected text",
    "too_short": "expected {min_length} or more entries",
    "too_long": "expected no more than {max_length} entries",
}
_CL_READERS = ("ruled-bevel", "face-milled-flank")
_PLANNED = {"nurbs": ("contact", "drop")}  # what toolpath.kind names beside "program"; other planners have one kind
_OF_ONE_MOTION = ("envelope", "gouge-example")  # surfaces that are nothing without their scene's own motion


def scene_names() -> dict[str, str]:
    """Built-in scenes and their one-line summaries."""
    return {name: tomllib.loads(_built_in_text(name))["scene"]["summary"] for name in _built_in()}


def _built_in() -> list[str]:
    names = (entry.name for entry in files("gearsim.scenes").iterdir())
    return sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml"))


def _built_in_text(name: str) -> str:
    return files("gearsim.scenes").joinpath(f"{name}.toml").read_text("utf-8")


def scene_text(name_or_path: str) -> tuple[str, str, Path]:
    """TOML text of a built-in scene or file, the name to use in messages, and its folder."""
    path = Path(name_or_path)
    if name_or_path in _built_in():
        return _built_in_text(name_or_path), name_or_path, Path()
    if is_file(path):
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
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"scene {label}: not valid TOML: {error}") from error
    for override in overrides:
        _override(data, override)
    return check_scene(data, label), folder


def check_scene(data: dict[str, Any], label: str) -> Scene:
    """Validate a scene given as nested tables. Raises InputError that lists every mistake found."""
    model = _model(data, label)
    try:
        scene = model.model_validate(data)
    except ValidationError as error:
        raise _input_error(label, [_explain(e, data, model) for e in error.errors()]) from None
    problems = []
    for build in scene.builders():
        try:
            build()
        except InputError as error:
            problems.append(str(error))
    if problems:
        raise _input_error(label, problems)
    return scene


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
    """Apply one ``table.key=value`` to the tables; the value is read as TOML, else as a string."""
    key, equals, value = override.partition("=")
    parts = key.strip().split(".")
    if not equals or len(parts) < 2:
        raise InputError(f"--set {override}: expected table.key=value, for instance metrology.rows=9")
    try:
        parsed = tomllib.loads(f"value = {value}")
    except tomllib.TOMLDecodeError:
        parsed = {"value": value}
    if list(parsed) != ["value"]:
        raise InputError(f"--set {override!r}: expected one value, for instance metrology.rows=9")
    table = data
    for part in parts[:-1]:
        table = table.setdefault(part, {})
        if not isinstance(table, dict):
            raise InputError(f"--set {override}: {part!r} is a value, not a table")
    table[parts[-1]] = parsed["value"]


def _explain(error: Any, data: dict[str, Any], model: type[Scene]) -> str:
    """One validation error in words: the field, what came, what would be right."""
    where = _without_tags(error["loc"], data)
    field = ".".join(str(p) for p in where)
    kind, got, context = error["type"], error["input"], error.get("ctx", {})
    if kind == "extra_forbidden":
        known = list(_table_at(where[:-1], data, model).model_fields)
        near = get_close_matches(str(where[-1]), known, n=1, cutoff=0.3)
        return f"{field}: unknown key" + (f"; did you mean {near[0]!r}?" if near else f"; known: {', '.join(known)}")
    if kind == "missing":
        return f"{field}: missing"
    if kind == "union_tag_invalid":
        return f"{field}.kind: got {context['tag']}; expected {context['expected_tags']}"
    if kind == "union_tag_not_found":
        return f"{field}.kind: missing; it says which tool, motion or machine the table describes"
    if kind == "value_error":
        return f"{field}: {context['error']}"
    wanted = _WANTED[kind].format(**context) if kind in _WANTED else f"{error['msg'][0].lower()}{error['msg'][1:]}"
    return f"{field}: got {_short(got)}; {wanted}" + _unit_hint(field, got)


def _short(got: Any) -> str:
    """A value as a scene's file would have it, cut short."""
    text = repr(list(got) if isinstance(got, tuple) else got)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _without_tags(where: Sequence[Any], data: Any) -> list[Any]:
    """The place of an error as it stands in the file: the validator names a table's kind as if it were a key."""
    out: list[Any] = []
    for part in where:
        if isinstance(data, dict) and part == data.get("kind") and part not in data:
            continue
        out.append(part)
        if isinstance(data, dict):
            data = data.get(part)
        elif isinstance(data, list) and isinstance(part, int) and part < len(data):
            data = data[part]
    return out


def _table_at(where: Sequence[Any], data: Any, table: type[Table]) -> type[Table]:
    """The table that a place in a scene must follow."""
    for part in where:
        data = data[part]
        if isinstance(part, str):
            choices = _tables_in(table.model_fields[part].annotation)
            kind = data.get("kind") if isinstance(data, dict) else None
            table = next((c for c in choices if kind in get_args(_kind_of(c))), choices[0])
    return table


def _kind_of(table: type[Table]) -> Any:
    return table.model_fields["kind"].annotation if "kind" in table.model_fields else None


def _tables_in(annotation: Any) -> list[type[Table]]:
    """The tables a field's annotation allows."""
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return [annotation]
    return [t for a in get_args(annotation) for t in _tables_in(a)]


def _unit_hint(field: str, got: Any) -> str:
    """A remark where a value looks as if it were in another unit."""
    if not isinstance(got, int | float) or isinstance(got, bool):
        return ""
    if field.endswith("_deg") and 0.0 < got < 1.6:
        return f" (angles are in degrees; {got:g} rad would be {degrees(got):.4g})"
    if field.endswith("_mm") and got >= 1e5:
        return f" (lengths are in mm; {got:g} um would be {got / 1e3:g})"
    return ""


def scene_table(scene: Scene) -> dict[str, Any]:
    """The scene as nested plain tables, defaults filled in, as it goes into the report."""
    return scene.model_dump(exclude_none=True)
