"""Columns of tables and channels of maps with what they mean, and a key to every code in them."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.envelope.crossings import Kind
from gearsim.gouging.attribution import Cause
from gearsim.gouging.compare import Decision
from gearsim.metrology.deviation import Crossing
from gearsim.simulation.operation import Operation, Variant

_UNITS = {"_per_mm": "1/mm", "_um": "um", "_mm": "mm", "_deg": "deg"}

CROSSINGS: dict[IntEnum, str] = {
    Crossing.MEASURED: "the machined surface was found within the measuring window",
    Crossing.UNCUT: "no cut within the window: at least as much material is left",
    Crossing.THROUGH: "the cut goes past the window: at least as much material is missing",
    Crossing.ABSENT: "not asked: the intended surface does not exist here, or its own motion trims it",
}
CLASSES: dict[IntEnum, str] = {
    Kind.ENVELOPE: "the envelope of a profile element",
    Kind.JOINT: "the tool as it stands where two moves meet",
    Kind.PATH_END: "the tool as it stands where the motion begins or ends",
    Kind.EDGE: "the sweep of a sharp edge of the profile",
}
CAUSES: dict[IntEnum, str] = {
    Cause.NONE: "no overcut beyond the tolerance",
    Cause.LOCAL: "local gouging, as the curvatures predict",
    Cause.TIE: "overcut where the curvatures tie",
    Cause.GLOBAL: "another part of the tool hits (global gouging)",
    Cause.UNPREDICTED: "overcut where nothing is predicted to gouge",
    Cause.UNKNOWN: "cut through the measuring window",
}
DECISIONS: dict[IntEnum, str] = {
    Decision.FREE: "the part curves less than the tool in every direction",
    Decision.TIE: "the curvatures are equal in some direction",
    Decision.GOUGES: "the part curves more than the tool in some direction",
}
YES_NO = {"0": "no", "1": "yes"}


class Column(NamedTuple):
    """Values of any shape with their ``meaning``; masked, or not finite: there is none.

    ``key``: what codes mean, in several tables by surface where they differ.
    """

    values: NDArray[Any]
    meaning: str
    key: Mapping[str, Any] = {}


def unit_of(name: str) -> str:
    """The unit that a column's or channel's name ends in: ``um``, ``mm``, ``deg``, ``1/mm``; empty where none."""
    plain = name.replace(".", "_")
    return next((unit for ending, unit in _UNITS.items() if plain.endswith(ending)), "")


def about(name: str, column: Column) -> dict[str, Any]:
    """What a file says of a column or channel: its meaning, and unit and key where it has them."""
    told = {"unit": unit_of(name), "meaning": column.meaning, "key": dict(column.key)}
    return {k: v for k, v in told.items() if v}


def known(codes: ArrayLike) -> NDArray[Any]:
    """Numbers of rows or places with those below zero masked: there is none."""
    return np.ma.masked_less(codes, 0)


def words(key: Mapping[IntEnum, str], codes: NDArray[np.integer]) -> NDArray[Any]:
    """Codes as their names in small letters; masked where they are not in the key."""
    names = np.full(max(key) + 1, "", dtype=object)
    for code in key:
        names[code] = code.name.lower()
    found = names[np.where(np.isin(codes, list(key)), codes, 0)]
    return np.ma.masked_array(found, ~np.isin(codes, list(key)))


def key_of_words(key: Mapping[IntEnum, str]) -> dict[str, str]:
    """What the names of codes mean."""
    return {code.name.lower(): meaning for code, meaning in key.items()}


def key_of_numbers(key: Mapping[IntEnum, str]) -> dict[str, str]:
    """What the numbers of codes mean."""
    return {str(int(code)): f"{code.name.lower()}: {meaning}" for code, meaning in key.items()}


def segment_key(variant: Variant) -> dict[str, str]:
    """Whose the rows of a variant's motion are: runs of rows by operation, and heading or motion in it."""
    key, first = {}, 0
    for operation in variant.operations:
        part = _parts(operation)
        starts = [0, *(np.flatnonzero(np.diff(part)) + 1), len(operation)]
        for start, end in pairwise(starts):
            key[f"{first + start}-{first + end - 1}"] = _part_name(operation, int(part[start]))
        first += len(operation)
    return key


def row_names(variant: Variant) -> NDArray[Any]:
    """Of every row of a variant's motion the operation, and heading or motion in it, as in ``segment_key``."""
    names = []
    for operation in variant.operations:
        parts, which = np.unique(_parts(operation), return_inverse=True)
        known = np.array([_part_name(operation, int(part)) for part in parts], dtype=object)
        names.append(known[which])
    return np.concatenate(names)


def row_lines(variant: Variant) -> NDArray[np.integer]:
    """Of every row of a variant's motion the line of the program that states it, from 1; 0: none is known."""
    return np.concatenate([operation.line for operation in variant.operations])


def _parts(operation: Operation) -> NDArray[np.integer]:
    return operation.section if operation.headings else operation.table.path


def _part_name(operation: Operation, part: int) -> str:
    if operation.headings:
        return f"{operation.name}, {operation.headings[part]}"
    several = len(operation.sources) > 1
    return f"{operation.name}, motion {part + 1} of {len(operation.sources)}" if several else operation.name
