"""Outcomes as rows of a table: which columns there are, of which type, what is said of each."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from numbers import Integral, Real
from typing import Any

import numpy as np
import pyarrow as pa

from gearsim.output.columns import unit_of
from gearsim.studies.records import Outcome, Parameter, Study, Value

_TYPES = (pa.null(), pa.int64(), pa.float64(), pa.string())  # each holds what those before it hold
_FIXED = {
    "verdict": (pa.string(), "pass, fail, unchecked, or error: the job could not be done"),
    "status": (pa.string(), "OK, or what forbids trust; null where the job could not be done"),
    "error": (pa.string(), "why the job could not be done"),
    "cross_checked": (pa.bool_(), "whether both roads were computed and had to agree"),
}
_MEANINGS = {
    "within_tolerance": "whether nothing that was measured is beyond tolerance, other judged motions and collisions "
    "among it where cross_checked; null where nothing was measured"
}
_FIRST = {"job": (pa.int64(), "number of the job, from 0")}
KEYS = (*_FIRST, *_FIXED)


def table_of(study: Study, types: Mapping[str, pa.DataType], outcomes: Sequence[Outcome]) -> pa.Table:
    """Outcomes as rows: job, parameters of these ``types``, verdict and what goes with it, figures as they are met.

    What does not exist, or is not finite, is null.
    """
    columns: dict[str, pa.Array] = {"job": pa.array([o.job for o in outcomes], pa.int64())}
    for p in study.parameters:
        kind = types[p.key]
        columns[p.key] = pa.array([as_type(p.values[o.job], kind) for o in outcomes], kind)
    for name, (kind, _) in _FIXED.items():
        columns[name] = pa.array([_said(o, name) for o in outcomes], kind)
    for name in dict.fromkeys(name for o in outcomes for name in o.figures):
        if name in columns:
            raise ValueError(f"{name} is the name of a figure and of a parameter")
        values = [_plain(o.figures.get(name)) for o in outcomes]
        kind = widest(_type(v) for v in values)
        columns[name] = pa.array([as_type(v, kind) for v in values], kind)
    return pa.table(columns)


def schema_of(study: Study, figures: Mapping[str, pa.DataType], notes: Mapping[str, str]) -> pa.Schema:
    """The schema of the whole table, with each column's unit and meaning; ``notes`` under ``gearsim.``."""
    told: dict[str, tuple[pa.DataType, str, str]] = {k: (kind, "", text) for k, (kind, text) in _FIRST.items()}
    told |= {p.key: (parameter_type(p), p.unit, "parameter: a key of the scene") for p in study.parameters}
    told |= {k: (kind, "", text) for k, (kind, text) in _FIXED.items()}
    told |= {k: (kind, unit_of(k), _MEANINGS.get(k, "figure")) for k, kind in figures.items()}
    about = {k: {"unit": unit, "meaning": text} if unit else {"meaning": text} for k, (_, unit, text) in told.items()}
    fields = [pa.field(k, kind, metadata=about[k]) for k, (kind, *_) in told.items()]
    notes = {**notes, "columns": json.dumps(about, ensure_ascii=False)}
    return pa.schema(fields, {f"gearsim.{k}": text for k, text in notes.items()})


def figure_types(study: Study, schemas: Iterable[pa.Schema]) -> dict[str, pa.DataType]:
    """The types of all figures of several tables, in the order in which they are met; numbers where all are null."""
    known, found = {*KEYS, *(p.key for p in study.parameters)}, dict[str, pa.DataType]()
    for schema in schemas:
        for field in schema:
            if field.name not in known:
                found[field.name] = widest((found.get(field.name, pa.null()), field.type))
    return {name: pa.float64() if kind == pa.null() else kind for name, kind in found.items()}


def cast(table: pa.Table, schema: pa.Schema) -> pa.Table:
    """A table of rows with all columns of a schema, those that it lacks null."""
    columns = [
        table.column(f.name).cast(f.type) if f.name in table.column_names else pa.nulls(len(table), f.type)
        for f in schema
    ]
    return pa.Table.from_arrays(columns, schema=schema)


def parameter_type(parameter: Parameter) -> pa.DataType:
    """The type of a parameter's column."""
    return widest(_type(v) for v in parameter.values)


def parameter_types(study: Study) -> dict[str, pa.DataType]:
    """The types of all parameters by their keys."""
    return {p.key: parameter_type(p) for p in study.parameters}


def widest(kinds: Iterable[pa.DataType]) -> pa.DataType:
    """The least of the types that holds all of them; where some are true or false and others not, words."""
    found = set(kinds) - {pa.null()}
    if pa.bool_() in found:
        return pa.bool_() if len(found) == 1 else pa.string()
    return _TYPES[max((_TYPES.index(kind) for kind in found), default=0)]


def as_type(value: Value | None, kind: pa.DataType) -> Any:
    """A value as a column of that type takes it; as words, numbers are what a cast of their whole column gives."""
    if value is None or isinstance(value, str):
        return value
    if kind == pa.string():
        return str(value) if _type(value) == pa.string() else pa.scalar(value, _type(value)).cast(kind).as_py()
    return float(value) if kind == pa.float64() else value


def _type(value: Any) -> pa.DataType:
    if value is None:
        return pa.null()
    if isinstance(value, bool):
        return pa.bool_()
    if isinstance(value, Integral):
        return pa.int64() if -(2**63) <= int(value) < 2**63 else pa.string()
    return pa.float64() if isinstance(value, Real) else pa.string()


def _plain(value: Any) -> Any:
    if isinstance(value, bool | np.bool_):
        return bool(value)
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, Real):
        return float(value) if isfinite(value) else None
    return value


def _said(outcome: Outcome, name: str) -> Any:
    if name == "error":
        return outcome.error or None
    if name == "status" and outcome.verdict == "error" and outcome.status == "OK":
        return None  # of a job that was not done nothing is ok
    return getattr(outcome, name)
