"""What the numbers of a CL file count in: its unit, the tool axis of points without one, its coordinate system."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.programs.cldata.lexer import Statement
from gearsim.programs.cldata.numbers import INCH, numbers

UNIT_AXIS = 1e-4  # how far from 1 the length of a tool axis may be
_MM = Decimal(1)
_UNITS = {
    **dict.fromkeys(("MM", "MILLIMETER", "MILLIMETERS", "MILLIMETRE", "MILLIMETRES"), _MM),
    **dict.fromkeys(("IN", "INCH", "INCHES"), INCH),
}
_UPRIGHT = np.array([0.0, 0.0, 1.0])
_IDENTITY = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0]


class Units:
    """The unit of lengths: millimetres unless UNITS states another, before the first length and for the whole file."""

    def __init__(self) -> None:
        self.unit = _MM
        self.stated: Statement | None = None
        self._used = False

    @property
    def inches(self) -> bool:
        return self.unit == INCH

    def take(self) -> Decimal:
        """The unit [mm], for a number that counts in it."""
        self._used = True
        return self.unit

    def state(self, s: Statement) -> None:
        """UNITS or UNIT. Raises InputError for other units, and for a change behind numbers."""
        name = s.rest.strip("'\" ").upper()
        if name not in _UNITS:
            raise InputError(f"{s.word}/{s.rest}: expected {s.word}/MM or {s.word}/INCHES")
        if self._used and _UNITS[name] != self.unit:
            before = f"line {self.stated.line} states {self.stated}" if self.stated else "they count as millimetres"
            raise InputError(f"{s} behind numbers: {before}; the unit must stand before them, one for the whole file")
        self.unit, self.stated = _UNITS[name], s


class ToolAxis:
    """The axis of points, whether they state it or not: MULTAX lets it stay as it was, MULTAX/OFF stands it upright."""

    def __init__(self) -> None:
        self.now = _UPRIGHT
        self.many: bool | None = None
        self._fixed = False

    def multax(self, rest: str) -> None:
        """MULTAX, MULTAX/ON and MULTAX/OFF."""
        way = rest.upper()
        if way not in ("", "ON", "OFF"):
            raise InputError(f"MULTAX/{rest}: expected MULTAX/ON or MULTAX/OFF")
        self.many = way != "OFF"
        self._require_one()
        if not self.many:
            self.now = _UPRIGHT

    def tlaxis(self, rest: str) -> None:
        """TLAXIS/i,j,k: the axis of points that state none."""
        self.now, self._fixed = _unit(numbers(rest, (3,), "TLAXIS/i,j,k"), rest), True
        self._require_one()

    def _require_one(self) -> None:
        if self.many is False and self._fixed and not np.array_equal(self.now, _UPRIGHT):
            raise InputError(
                f"MULTAX/OFF and a TLAXIS of {_shown(self.now)}: which of them holds is open; expected an axis in each "
                "point, under MULTAX/ON"
            )

    def of(self, stated: list[float]) -> NDArray:
        """The axis of a point that states these three numbers, or none."""
        if stated:
            given = self._given(stated)
            self.now, self._fixed = given, self._fixed and np.array_equal(given, self.now)
        elif self.many is False:
            self.now = _UPRIGHT
        elif self.many is None and not self._fixed and not np.array_equal(self.now, _UPRIGHT):
            raise InputError(
                f"no tool axis, and the last one is {_shown(self.now)}: whether it stays is open without MULTAX/ON or "
                "MULTAX/OFF; expected six numbers"
            )
        return self.now

    def _given(self, stated: list[float]) -> NDArray:
        axis = _unit(stated, ",".join(f"{v:g}" for v in stated))
        if self.many is False and np.abs(axis - _UPRIGHT).max() > UNIT_AXIS:
            raise InputError(
                f"tool axis {_shown(axis)} under MULTAX/OFF, where it is 0,0,1; MULTAX/ON must stand before"
            )
        return axis


def require_identity(rest: str) -> None:
    """CSYS: a coordinate system of its own is refused, for whether the points are in it differs between systems."""
    form = "CSYS of 12 numbers, three rows of a rotation and an offset"
    if numbers(rest, (12,), form) != _IDENTITY:
        raise InputError(
            f"CSYS/{rest} is not the part's own system; export the points in the gear's frame, CSYS {_ROWS}"
        )


_ROWS = ", ".join(f"{v:g}" for v in _IDENTITY)


def _unit(values: list[float], shown: str) -> NDArray:
    return unit_axis(np.array(values), shown)


def unit_axis(axis: NDArray, shown: str = "") -> NDArray:
    """A stated tool axis (3,) as a unit vector. Raises InputError where its length is not 1."""
    length = float(np.linalg.norm(axis))
    if abs(length - 1.0) > UNIT_AXIS:
        shown = shown or ",".join(f"{v:g}" for v in axis)
        raise InputError(f"tool axis {shown} has length {length:.6g}; expected 1")
    return np.asarray(axis / length)


def _shown(axis: NDArray) -> str:
    return ",".join(f"{v:.6g}" for v in axis)
