"""FEDRAT and SPINDL: feeds of every unit as mm/min, exact."""

from __future__ import annotations

from dataclasses import dataclass
from decimal import Decimal
from math import nan
from typing import Literal

from gearsim.errors import InputError
from gearsim.programs.cldata.numbers import EXACT, INCH, decimal, fields, is_number, times

Kind = Literal["minute", "revolution", "inverse"]

# Of one of a unit: what it is a feed per, and how many mm (None: the file's unit).
_UNITS: dict[str, tuple[Kind, Decimal | None]] = {
    "MMPM": ("minute", Decimal(1)),
    "IPM": ("minute", INCH),
    "PERMIN": ("minute", None),
    "MMPR": ("revolution", Decimal(1)),
    "IPR": ("revolution", INCH),
    "PERREV": ("revolution", None),
    "INVERS": ("inverse", Decimal(1)),
}
_FORM = f"FEDRAT/number, with one of {', '.join(_UNITS)} before or behind it"
_WAYS = {"CLW", "CCLW", "ON", "RPM", "REV"}
_OWN_NUMBER = {"MAXRPM", "RADIUS", "RANGE"}


@dataclass(frozen=True)
class Feed:
    """A feed of ``amount`` mm a minute, mm a revolution, or moves a minute (``inverse``); ``line`` states it."""

    line: int
    kind: Kind
    amount: Decimal
    unit: str

    @property
    def in_file_unit(self) -> bool:
        """Whether the file's unit of length is in it."""
        return _UNITS.get(self.unit, ("minute", None))[1] is None

    def mm_min(self, length: float, spindle: Spindle) -> float:
        """The feed [mm/min] in a move of ``length`` mm. Raises InputError without a spindle speed that it needs."""
        if self.kind == "minute":
            return times(self.amount)
        if self.kind == "inverse":
            return float(self.amount) * length
        if spindle.rpm is None:
            raise InputError(f"{self.unit} is a feed per revolution, and {spindle.why_none}; SPINDL/number states it")
        return times(self.amount, spindle.rpm)

    def seconds(self, length: float, spindle: Spindle) -> float:
        """How long a move of ``length`` mm takes; nan where the tip stands still and the feed is the tip's."""
        if self.kind == "inverse":
            return 60.0 / float(self.amount)
        return 60.0 * length / self.mm_min(length, spindle) if length > 0.0 else nan


def read_feed(line: int, rest: str, unit: Decimal, before: Feed | None) -> Feed:
    """The feed behind FEDRAT, ``unit`` the file's in mm; ``before``: the last feed stated.

    Raises InputError, to be told with its line, for other words than the units, or where it is open which unit a bare
    number has.
    """
    given = fields(rest.upper())
    values = [field for field in given if is_number(field)]
    units = [field for field in given if field in _UNITS]
    if strange := next((f for f in given if f not in values and f not in units), None):
        raise InputError(f"FEDRAT: {strange!r} is neither a number nor a unit; expected {_FORM}")
    if len(values) != 1 or len(units) > 1 or "" in given:
        raise InputError(f"FEDRAT/{rest}: {len(values)} numbers and {len(units)} units; expected {_FORM}")
    if decimal(values[0]) <= 0:
        raise InputError(f"FEDRAT/{rest}: a feed must be positive")
    name = units[0] if units else ""
    feed = _feed(line, values[0], name, unit)
    if not name and before is not None and before.unit:
        modal = _feed(line, values[0], before.unit, unit)
        if (modal.kind, modal.amount) != (feed.kind, feed.amount):
            raise InputError(
                f"FEDRAT/{rest} states no unit, and line {before.line} states {before.unit}: whether that still holds "
                f"is open; expected {_FORM}"
            )
    return feed


def _feed(line: int, value: str, name: str, unit: Decimal) -> Feed:
    kind, size = _UNITS.get(name, ("minute", None))
    return Feed(line, kind, EXACT.multiply(decimal(value), unit if size is None else size), name)


@dataclass(frozen=True)
class Spindle:
    """The spindle's speed [1/min]; None where it is not known: ``why_none``. ``last``: what ON takes up again."""

    rpm: Decimal | None = None
    why_none: str = "no SPINDL states a spindle speed"
    last: Decimal | None = None


def read_spindle(line: int, rest: str, before: Spindle) -> Spindle:
    """The speed behind SPINDL: number and RPM in any order, with CLW or CCLW; ON and OFF; what else, is no speed."""
    given = fields(rest.upper())
    words = [field for field in given if not is_number(field)]
    values = [
        field for i, field in enumerate(given) if is_number(field) and not (i and given[i - 1] in _OWN_NUMBER)
    ]  # fmt: skip
    if "OFF" in words:
        return Spindle(None, f"line {line} stops the spindle", before.last)
    if strange := [w for w in words if w and w not in _WAYS | _OWN_NUMBER | {"LOW", "MEDIUM", "HIGH"}]:
        return Spindle(None, f"SPINDL of line {line} states no speed ({', '.join(strange)})")
    if not values:
        return Spindle(before.last, before.why_none, before.last)
    if len(values) > 1 or decimal(values[0]) <= 0:
        return Spindle(None, f"SPINDL/{rest} of line {line} states no one positive speed")
    return Spindle(decimal(values[0]), "", decimal(values[0]))
