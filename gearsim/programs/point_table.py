"""The CSV of point lists: one line of column names, then one point a line, as every reader takes it.

Behind the six numbers stand ``sign``, ``axis`` and ``flank``, where known, the same in every line, and for a grid in
row-major order ``row`` and ``column``, from 0. By hand, and in older files, lines ``# key: value`` above say the same:
``units``, ``sign``, ``axis``, ``flank``, ``rows``, ``columns``. Names that end in ``_mm`` say the units, too.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping
from difflib import get_close_matches

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError

COLUMNS = ("x_mm", "y_mm", "z_mm", "nx", "ny", "nz")
KEYS = ("units", "axis", "flank", "sign", "rows", "columns")
_SAME = ("sign", "axis", "flank")
_PLACE = ("row", "column")


def format_table(values: NDArray, header: Mapping[str, str], shape: tuple[int, int] | None) -> str:
    """Numbers (n, 6) with what ``header`` says of all of them, and with their places in a grid of some shape."""
    names = [key for key in _SAME if header[key]]
    same = [header[key] for key in names]
    places = [[]] * len(values) if shape is None else np.argwhere(np.ones(shape, dtype=bool)).tolist()
    text = io.StringIO()
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*COLUMNS, *names, *(_PLACE if shape else ())])
    table.writerows([*map(repr, row), *same, *place] for row, place in zip(values.tolist(), places, strict=True))
    return text.getvalue()


def parse_table(text: str, name: str) -> tuple[NDArray, dict[str, str], list[str]]:
    """Numbers (n, 6), the keys that are stated, and where each row stands; ``name`` stands in the messages.

    Raises InputError naming line and column for anything that cannot be used.
    """
    header: dict[str, str] = {}
    rows: list[tuple[int, list[str]]] = []
    for number, line in enumerate(text.removeprefix("\ufeff").splitlines(), 1):
        line = line.strip()
        if line.startswith("#"):
            _take_key(line[1:], header, f"{name}, line {number}")
        elif line:
            rows.append((number, _fields(line)))
    names = list(COLUMNS)
    if rows and not _is_number(rows[0][1][0]):
        names = _names(rows.pop(0), name)
        if names[: len(COLUMNS)] == list(COLUMNS):
            header.setdefault("units", "mm")
    values = _numbers(rows, names, name)
    _take_columns(rows, names, header, name)
    return values, header, [f"line {number}" for number, _ in rows]


def _take_key(comment: str, header: dict[str, str], place: str) -> None:
    """Add a key of the header; refuse one that is misspelt or contradicts another. Other comments are free."""
    key, colon, value = (part.strip() for part in comment.partition(":"))
    key = key.lower()
    if not colon:
        return
    if key not in KEYS:
        if near := get_close_matches(key, KEYS, n=1, cutoff=0.8):
            raise InputError(f"{place}: unknown key {key!r}; did you mean {near[0]!r}?")
    elif header.setdefault(key, value) != value:
        raise InputError(f"{place}: {key} {value!r} contradicts {header[key]!r} above")


def _fields(line: str) -> list[str]:
    if '"' in line:
        return [field.strip() for field in next(csv.reader([line], skipinitialspace=True))]
    separator = "," if "," in line else ";" if ";" in line else None
    return [field.strip() for field in line.split(separator)]


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _names(row: tuple[int, list[str]], name: str) -> list[str]:
    """The columns: the six numbers and any of those that may stand behind them."""
    number, found = row
    names = [field.lower() for field in found]
    plain = [field.removesuffix("_mm") for field in names]
    more = names[len(COLUMNS) :]
    known = set(more) <= {*_SAME, *_PLACE} and len(set(more)) == len(more)
    if plain[: len(COLUMNS)] != [c.removesuffix("_mm") for c in COLUMNS] or not known:
        behind = f" and behind them any of {', '.join((*_SAME, *_PLACE))}"
        raise InputError(f"{name}, line {number}: columns {', '.join(found)}; expected {', '.join(COLUMNS)}{behind}")
    return names


def _numbers(rows: list[tuple[int, list[str]]], names: list[str], name: str) -> NDArray:
    """The numbers, shape (n, 6)."""
    for number, fields in rows:
        if len(fields) != len(names):
            count = f"{len(fields)} columns; expected {len(names)}"
            raise InputError(f"{name}, line {number}: {count}: {', '.join((*COLUMNS, *names[len(COLUMNS) :]))}")
    six = [(number, fields[: len(COLUMNS)]) for number, fields in rows]
    try:
        return np.array([fields for _, fields in six], dtype=float).reshape(-1, 6)
    except ValueError:
        number, column, field = next(
            (number, k, f) for number, fields in six for k, f in enumerate(fields) if not _is_number(f)
        )
        place = f"{name}, line {number}, column {column + 1} ({COLUMNS[column]})"
        raise InputError(f"{place}: {field!r} is not a number") from None


def _take_columns(rows: list[tuple[int, list[str]]], names: list[str], header: dict[str, str], name: str) -> None:
    """Add what stands behind the numbers to the keys: words that are the same in every line, and places in a grid."""
    for key in _SAME:
        for number, fields in rows if key in names else ():
            value = fields[names.index(key)]
            if header.setdefault(key, value) != value:
                raise InputError(f"{name}, line {number}, {key} {value!r} contradicts {header[key]!r} above")
    if not set(_PLACE) <= set(names):
        if set(_PLACE) & set(names):
            raise InputError(f"{name}: a grid needs both columns, row and column")
        return
    row, column = (names.index(key) for key in _PLACE)
    places = [(number, fields[row], fields[column]) for number, fields in rows]
    across = len({j for _, _, j in places})
    for k, (number, i, j) in enumerate(places):
        if (i, j) != (str(k // across), str(k % across)):
            at = f"row {i!r}, column {j!r}"
            raise InputError(f"{name}, line {number}: {at}; expected {k // across}, {k % across}: row by row, from 0")
    for key, count in (("rows", len(places) // max(across, 1)), ("columns", across)):
        if header.setdefault(key, str(count)) != str(count):
            raise InputError(f"{name}: {count} {key} by the columns, {header[key]} by its header")
