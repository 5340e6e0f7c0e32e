"""What is wrong with a scene's tables, in words: the field, what came, what would be right."""

from __future__ import annotations

from collections.abc import Sequence
from difflib import get_close_matches
from math import degrees, isfinite
from typing import Any, get_args

from pydantic import ValidationError

from gearsim.scene.tables import Table

_ALIKE = 0.6  # least likeness of a key to the one that may be meant
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


def explained(error: ValidationError, data: dict[str, Any], model: type[Table]) -> list[str]:
    """The mistakes that a validation of tables found, one line each."""
    return [_explain(e, data, model) for e in _first_causes(error.errors())]


def _first_causes(errors: Sequence[Any]) -> list[Any]:
    """Errors but those of lists that are too short for want of the entries whose own mistakes are told."""
    places = [e["loc"] for e in errors]
    return [
        e for e in errors
        if e["type"] != "too_short" or not any(p != e["loc"] and p[: len(e["loc"])] == e["loc"] for p in places)
    ]  # fmt: skip


def _explain(error: Any, data: dict[str, Any], model: type[Table]) -> str:
    """One validation error in words: the field, what came, what would be right."""
    where = _without_tags(error["loc"], data)
    field = ".".join(str(p) for p in where)
    kind, got, context = error["type"], error["input"], error.get("ctx", {})
    if kind == "extra_forbidden":
        known = list(_table_at(where[:-1], data, model).model_fields)
        near = get_close_matches(str(where[-1]), known, n=1, cutoff=_ALIKE)
        return f"{field}: unknown key" + (f"; did you mean {near[0]!r}?" if near else f"; known: {', '.join(known)}")
    if kind == "missing" and isinstance(where[-1], int):
        return f"{'.'.join(str(p) for p in where[:-1])}: got {short(got)}; expected {where[-1] + 1} or more entries"
    if kind == "missing":
        return f"{field}: missing"
    if kind == "union_tag_invalid":
        return f"{field}.kind: got {context['tag']}; expected {context['expected_tags']}"
    if kind == "union_tag_not_found":
        return f"{field}.kind: missing; it says which tool, motion or machine the table describes"
    if kind == "value_error":
        return f"{field}: {context['error']}" if field else str(context["error"])
    wanted = _WANTED[kind].format(**context) if kind in _WANTED else f"{error['msg'][0].lower()}{error['msg'][1:]}"
    return f"{field}: got {short(got)}; {wanted}" + _unit_hint(field, got)


def short(got: Any) -> str:
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
    choices = [table]
    for part in where:
        data = data[part]
        if isinstance(part, str) and part in table.model_fields:  # else it is a name that the scene's author chose
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
    if not isinstance(got, int | float) or isinstance(got, bool) or not isfinite(got):
        return ""
    if field.endswith("_deg") and 0.0 < got < 1.6:
        return f" (angles are in degrees; {got:g} rad would be {degrees(got):.4g})"
    if field.endswith("_mm") and got >= 1e5:
        return f" (lengths are in mm; {got:g} um would be {got / 1e3:g})"
    return ""
