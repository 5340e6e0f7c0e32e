"""A commented scene to start from: a built-in one under another name, without what is printed of it."""

from __future__ import annotations

import re
from contextlib import suppress
from pathlib import Path

from gearsim.errors import InputError
from gearsim.scene.built_in import scene_names, scene_text
from gearsim.scene.loading import load_scene
from gearsim.scene.printed import without_reference
from gearsim.scene.sculptured import GougeExampleScene
from gearsim.scene.tables import file_name

_SUMMARY = 'summary = ""  # what it shows, in a line; the report begins with it'


def write_new(name: str, like: str) -> Path:
    """Write the built-in scene ``like`` as NAME.toml; returns its path.

    Raises InputError for names that no file has or that others have, and where the file cannot be written.
    """
    target = _new_file(name)
    if like not in scene_names():
        raise InputError(f"--like {like}: no such built-in scene; there are {', '.join(scene_names())}")
    try:
        with target.open("x", encoding="utf-8") as file:
            file.write(_text(like, target.stem))
    except FileExistsError:
        raise InputError(f"{target} exists already; choose another name") from None
    except OSError as error:
        with suppress(OSError):
            target.unlink()
        raise InputError(f"cannot write {target}: {error.strerror}") from error
    return target


def _text(like: str, name: str) -> str:
    """The built-in scene's text with a name of its own, and no summary.

    Its printed figures stay only where they are all that it is about.
    """
    text = scene_text(like)[0].replace(f'name = "{like}"', f'name = "{name}"', 1)
    text = re.sub(r"^summary = .*$", _SUMMARY, text, count=1, flags=re.MULTILINE)
    return text if isinstance(load_scene(like)[0], GougeExampleScene) else without_reference(text)


def _new_file(name: str) -> Path:
    """Where a scene of that name is written. Raises InputError for names that no file has or that others have."""
    target = Path(f"{name.removesuffix('.toml')}.toml")
    try:
        file_name(target.stem if name else "")
    except ValueError as error:
        raise InputError(f"new {name!r}: {error}") from None
    if target.stem in scene_names():
        raise InputError(f"new {name}: a built-in scene has that name; choose another")
    return target
