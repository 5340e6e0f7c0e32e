"""Whose printed figures a scene bears: those of a built-in scene are for its geometry and toolpath and no other."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from gearsim.errors import is_file
from gearsim.scene.base import Scene
from gearsim.scene.built_in import built_in, scene_text
from gearsim.scene.loading import scene_of, scene_table

_GEOMETRY = ("surface", "cutter", "larger", "printed", "tools", "holder")
_PLACES = "profile_offsets_mm"
_PATHS = {  # by kind of surface, what makes the toolpath that is printed; worked examples of gouging print none
    "ruled-bevel": ("toolpath.file",),
    "face-milled-flank": ("toolpath.file",),
    "cylindrical-gear": ("program.file", "toolpath"),
}


def printed_elsewhere(scene: Scene, folder: Path) -> str:
    """Why the scene's [reference] is not for what it cuts; empty where it is, where it has none, or brought its own.

    Figures of a toolpath stand beside no other one: a bevel flank's are the continuous motion's, whatever its points, a
    cylindrical gear's (hours, roughness, traces of gears that were cut) those of all settings of its operations.

    Printed figures are known by their source, worked examples by their sections; ``folder`` is where the scene's files
    are looked up.
    """
    whole = scene_table(scene)
    given, mine = whole.get("reference"), _geometry(whole)
    if given is None or mine["surface"]["kind"] == "gouge-example":
        return ""
    bearers = _bearers(given, whole)
    if not bearers:
        return "" if "source" in given else "[reference] is left out: no built-in scene has these worked examples"
    differ = {name: _differing(mine, _geometry(table)) for name, table in bearers.items()}
    nearest = min(bearers, key=lambda name: len(differ[name]))
    shape = mine.get("surface", {}).get("file")
    tables = differ[nearest] or (["surface.file"] if shape and is_file(folder / shape) else [])
    if not tables:
        return ""
    of = "toolpath" if set(tables) <= set(_PATHS.get(mine["surface"]["kind"], ())) else "geometry"
    return (
        f"[reference] is left out: it is printed for the {of} of the built-in scene {nearest}, and "
        f"{', '.join(tables)} {'differ' if len(tables) > 1 else 'differs'} here"
    )


def without_reference(text: str) -> str:
    """A scene's TOML text without its table [reference] and the tables below it."""
    kept, out = True, []
    for line in text.splitlines(keepends=True):
        if line.startswith("["):
            kept = not line.lstrip("[").startswith("reference")
        if kept:
            out.append(line)
    return "".join(out).rstrip("\n") + "\n"


def _bearers(given: dict[str, Any], whole: dict[str, Any]) -> dict[str, dict[str, Any]]:
    """The built-in scenes that quote a print, as plain tables: that of the same name alone where it is the scene."""
    name = whole["scene"]["name"]
    if name in built_in() and (table := _whole(name, _tables(name))) == whole:
        return {name: table}
    tables = {name: _tables(name) for name in built_in()}
    quoting = {name: _whole(name, own) for name, own in tables.items() if _same(given, own.get("reference"))}
    return {name: table for name, table in quoting.items() if table["reference"] == given} or quoting


def _tables(name: str) -> dict[str, Any]:
    """A built-in scene as it stands in its file."""
    return tomllib.loads(scene_text(name)[0])


def _whole(name: str, tables: dict[str, Any]) -> dict[str, Any]:
    """The same with its defaults, no geometry built: the tests build that of every built-in scene."""
    return scene_table(scene_of(tables, name))


def _same(given: dict[str, Any], other: dict[str, Any] | None) -> bool:
    """Whether two tables [reference] quote the same print."""
    if other is None:
        return False
    if "source" in given:
        return bool(given["source"] == other.get("source"))
    return list(given["sections"]) == other.get("sections")


def _geometry(table: dict[str, Any]) -> dict[str, Any]:
    """What the print is of: surface and tools, where they are measured, and what makes a toolpath that is printed."""
    places = (*_PATHS.get(table.get("surface", {}).get("kind", ""), ()), f"metrology.{_PLACES}")
    return {name: table[name] for name in _GEOMETRY if name in table} | {name: _at(table, name) for name in places}


def _at(table: Any, place: str) -> Any:
    """What stands at a place of nested tables, names joined by dots; None where nothing does."""
    for name in place.split("."):
        table = (table or {}).get(name)
    return table


def _differing(one: dict[str, Any], other: dict[str, Any]) -> list[str]:
    return [name for name in {**one, **other} if one.get(name) != other.get(name)]
