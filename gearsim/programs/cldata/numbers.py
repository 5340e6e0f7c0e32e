"""Fields of a statement: separated by commas or blanks, and numbers as they are printed, exact."""

from __future__ import annotations

import re
from collections.abc import Sequence
from decimal import Context, Decimal
from math import isfinite

from gearsim.errors import InputError

INCH = Decimal("25.4")
FARTHEST_MM = 1e6
EXACT = Context(prec=400)
_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[EeDd][+-]?\d{1,4})?", re.ASCII)


def fields(text: str) -> list[str]:
    """What commas and blanks separate; an empty string where nothing stands between two commas."""
    return [word for part in text.split(",") for word in (part.split() or [""])]


def is_number(field: str) -> bool:
    """Whether a field is a number of any spelling: ``3.``, ``.9625``, ``-0``, ``1.5E-3``."""
    return _NUMBER.fullmatch(field) is not None


def decimal(field: str) -> Decimal:
    """A field that is a number, exactly as printed."""
    return Decimal(field.upper().replace("D", "E"))


def decimals(field: str) -> int:
    """How many digits behind the point a number is printed with (negative: a positive exponent)."""
    exponent = decimal(field).as_tuple().exponent
    assert isinstance(exponent, int)
    return -exponent


def times(*factors: Decimal) -> float:
    """A product, rounded once."""
    product = Decimal(1)
    for factor in factors:
        product = EXACT.multiply(product, factor)
    return float(product)


def _no_number(field: str) -> str:
    if not field:
        return "nothing stands where a number should"
    if field.lower().lstrip("+-") in ("nan", "inf", "infinity"):
        return f"{field} is not a finite number"
    return f"{field!r} is not a number"


def numbers(rest: str, counts: Sequence[int], form: str, unit: Decimal = Decimal(1), scaled: int = 0) -> list[float]:
    """The numbers of a statement, the first ``scaled`` of them times ``unit``.

    Raises InputError, to be told with its line, unless there are as many as one of ``counts`` and all are finite.
    """
    out = []
    for i, field in enumerate(fields(rest)):
        if not is_number(field):
            raise InputError(f"{_no_number(field)}; expected {form}")
        inches = unit != 1 and i < scaled
        value = times(decimal(field), unit) if inches else float(field.upper().replace("D", "E"))
        if not isfinite(value):
            raise InputError(f"{field} is not a finite number; expected {form}")
        if i < scaled and abs(value) > FARTHEST_MM:
            raise InputError(f"{field} is farther than {FARTHEST_MM:g} mm, where no number holds a nanometre any more")
        out.append(value)
    if len(out) not in counts:
        raise InputError(f"{len(out)} numbers; expected {form}")
    return out
