"""Dotted keys of a scene's tables: ``cutter.taper_deg``; ``errors.pivot_um.2``, where a number is a place in a list."""

from __future__ import annotations

from collections.abc import Mapping
from copy import deepcopy
from itertools import pairwise
from typing import Any

from gearsim.errors import InputError


def put(tables: dict[str, Any], key: str, value: Any) -> None:
    """Put a value at a dotted key, in place; tables on the way are made.

    Raises InputError where the key leads through a value or beyond a list's end.
    """
    *way, last = key.split(".")
    at: Any = tables
    for i, part in enumerate(way):
        at = at.setdefault(part, {}) if isinstance(at, dict) else at[_place(at, part, key)]
        if not isinstance(at, dict | list):
            raise InputError(f"{key}: {'.'.join(way[: i + 1])} is a value, not a table")
    at[_place(at, last, key) if isinstance(at, list) else last] = value


def _place(entries: list[Any], part: str, key: str) -> int:
    if not part.isdecimal() or part != str(int(part)) or int(part) >= len(entries):  # "01" would be a second name of 1
        last = len(entries) - 1
        raise InputError(f"{key}: {part} is no place in a list of {len(entries)}; its entries are 0 to {last}")
    return int(part)


def with_lists(tables: Mapping[str, Any], keys: list[str], defaults: Mapping[str, Any]) -> dict[str, Any]:
    """A copy of the tables that has the lists into which keys lead, from ``defaults`` where it lacked them."""
    out = deepcopy(dict(tables))
    for key in keys:
        at, default = out, defaults
        for part, following in pairwise(key.split(".")):
            if not isinstance(at, dict) or not isinstance(default, Mapping) or part not in default:
                break
            if part not in at:
                at[part] = plain(default[part]) if following.isdecimal() else {}
            at, default = at[part], default[part]
    return out


def plain(value: Any) -> Any:
    """A value as a TOML or JSON file would give it back: lists, no tuples."""
    if isinstance(value, Mapping):
        return {key: plain(v) for key, v in value.items()}
    return [plain(v) for v in value] if isinstance(value, list | tuple) else value
