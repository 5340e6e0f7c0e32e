"""Studies by built-in name or path."""

from __future__ import annotations

import tomllib
from difflib import get_close_matches
from importlib.resources import files
from pathlib import Path
from typing import Any

from gearsim.errors import InputError, is_file, is_folder, read_input
from gearsim.scene.loading import toml_tables


def study_names() -> dict[str, str]:
    """Built-in studies and their one-line summaries."""
    return {name: tomllib.loads(_built_in_text(name))["study"]["summary"] for name in _built_in()}


def _built_in() -> list[str]:
    names = (entry.name for entry in files("gearsim.scenes").joinpath("studies").iterdir())
    return sorted(name.removesuffix(".toml") for name in names if name.endswith(".toml"))


def _built_in_text(name: str) -> str:
    return files("gearsim.scenes").joinpath("studies", f"{name}.toml").read_text("utf-8")


def study_tables(name_or_path: str) -> tuple[dict[str, Any], str, Path]:
    """The tables of a built-in study or a file, the name to use in messages, and the file's folder.

    Raises InputError where there is none, and for text that is no TOML.
    """
    path = Path(name_or_path)
    if name_or_path in _built_in():
        return toml_tables(_built_in_text(name_or_path), f"study {name_or_path}"), name_or_path, Path()
    if not is_file(path) and not (name_or_path and is_folder(path)):
        near = get_close_matches(name_or_path, _built_in(), n=1, cutoff=0.4)
        hint = f"; did you mean {near[0]!r}?" if near else "."
        raise InputError(
            f"no study named {name_or_path!r}{hint} Built-in studies: {', '.join(_built_in())}. "
            "Or give the path of a .toml file."
        )
    tables = toml_tables(read_input(path, "study"), f"study {path}")
    if "study" not in tables and "surface" in tables:
        raise InputError(
            f"study {path}: it is a scene, one job: gearsim run {path}; a study names its scene in [study] and what "
            "varies in [[vary]]"
        )
    return tables, str(path), path.parent
