"""The scenes that are shipped, by name, and the text of a scene by name or path."""

from __future__ import annotations

import tomllib
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path

from gearsim.errors import InputError, is_file, is_folder, read_input


def scene_names() -> dict[str, str]:
    """Built-in scenes and their one-line summaries."""
    return {name: tomllib.loads(_built_in_text(name))["scene"]["summary"] for name in built_in()}


def built_in() -> list[str]:
    """The names of the built-in scenes."""
    names = (entry.name for entry in files("gearsim.scenes").iterdir())
    return sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml"))


def _built_in_text(name: str) -> str:
    return files("gearsim.scenes").joinpath(f"{name}.toml").read_text("utf-8")


def scene_text(name_or_path: str, beside: Path | None = None) -> tuple[str, str, Path]:
    """TOML text of a built-in scene or file, the name to use in messages, and its folder.

    ``beside``: the folder in which relative paths begin, if it is not the working directory.
    """
    path = (beside or Path()) / name_or_path
    if name_or_path in built_in():
        return _built_in_text(name_or_path), name_or_path, Path()
    if is_file(path) or (name_or_path and is_folder(path)):
        return read_input(path, "scene"), str(path), path.parent
    near = get_close_matches(name_or_path, [*_scene_files(path.parent), *built_in()], n=1, cutoff=0.4)
    hint = f"; did you mean {near[0]!r}?" if near else "."
    if path.suffix == ".toml":
        raise InputError(f"cannot read scene {name_or_path!r}: there is no such file{hint}")
    raise InputError(
        f"no scene named {name_or_path!r}{hint} Built-in scenes: {', '.join(built_in())}. "
        "Or give the path of a .toml file."
    )


def scene_beside(name: str) -> Path | None:
    """A file that may be meant by the name of a built-in scene, which is what the name stands for."""
    if name not in built_in():
        return None
    return next((path for path in (Path(f"{name}.toml"), Path(name)) if is_file(path)), None)


def _scene_files(folder: Path) -> list[str]:
    """The .toml files of a folder, none where it cannot be looked into."""
    try:
        return sorted(str(file) for file in folder.glob("*.toml"))
    except (OSError, ValueError):
        return []
