"""CUTTER: the sizes of a tool as a CL file prints them, held against another tool within the printed digits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Decimal
from math import degrees, radians

import numpy as np

from gearsim.cutters.catalogue import apt
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.programs.cldata.numbers import decimals, fields, is_number, numbers

LETTERS = "drefabh"
_FORM = "CUTTER/d, CUTTER/d,r or CUTTER/d,r,e,f,a,b,h"
_LENGTHS = 4  # d, r, e, f and the last, h: scaled by the file's unit; a and b are degrees
_COARSEST, _FINEST = 2, 5  # decimals: fewer are digits left out, more are noise of the seven numbers' own rounding


@dataclass(frozen=True)
class CutterSizes:
    """What CUTTER states: d, or d and r, or all of d, r, e, f [mm], a, b [deg], h [mm] of the APT cutter.

    ``unsure`` [mm, deg]: half a unit of the last printed decimal, from 5e-6 to 0.005 (in the file's unit); ``line`` of
    the file (0: of none).
    """

    sizes: tuple[float, ...]
    unsure: float
    line: int = 0

    def __str__(self) -> str:
        return "CUTTER/" + ", ".join(f"{v:.6g}" for v in self.sizes)

    def differs(self, other: CutterSizes) -> str:
        """The letters of what both state and differ in beyond the printed digits; h, the shank, makes no other tool."""
        room = (self.unsure + other.unsure) * (1.0 + 1e-6)
        pairs = list(zip(LETTERS[:-1], self.sizes, other.sizes, strict=False))
        sharp = len(pairs) > 1 and max(abs(pairs[1][1]), abs(pairs[1][2])) <= room
        return "".join(x for x, a, b in pairs if abs(a - b) > room and not (sharp and x in "ef"))

    @property
    def height(self) -> float | None:
        """h [mm], None where it is not stated."""
        return self.sizes[6] if len(self.sizes) == len(LETTERS) else None


def read_cutter(line: int, rest: str, unit: Decimal) -> CutterSizes:
    """The sizes behind CUTTER of a line, lengths times ``unit``. A comma may dangle behind them.

    Raises InputError, to be told with its line, for other forms and impossible tools.
    """
    rest = rest.removesuffix(",").rstrip()
    given = fields(rest)
    if all(map(is_number, given)) and len(given) == 5:
        raise InputError(f"5 numbers, of which the fifth has no settled meaning; expected {_FORM}")
    sizes = numbers(rest, (1, 2, len(LETTERS)), _FORM, unit, _LENGTHS)
    if len(sizes) == len(LETTERS):
        sizes[-1] = numbers(given[-1], (1,), _FORM, unit, 1)[0]
    printed = min(max(max(map(decimals, given)), _COARSEST), _FINEST)
    stated = CutterSizes(tuple(sizes), 0.5 * 10.0**-printed * float(unit), line)
    _require_possible(stated)
    return stated


def _require_possible(stated: CutterSizes) -> None:
    """Refuse what is no tool, were every number as far off as its last digit allows."""
    if len(stated.sizes) < len(LETTERS):
        if min(stated.sizes) < 0.0 or stated.sizes[0] == 0.0:
            raise InputError(f"impossible {stated}: a diameter must be positive, a corner radius not negative")
        return
    cutter_of(stated)


def cutter_of(stated: CutterSizes) -> Profile:
    """The cutter that all seven numbers state, its corner as much larger as their digits need to meet the flank.

    Raises InputError where fewer are stated, or no tool is.
    """
    if len(stated.sizes) < len(LETTERS):
        raise InputError(f"{stated} states no whole tool; expected CUTTER/{','.join(LETTERS)}")
    try:
        return _apt(stated.sizes)
    except InputError as error:
        d, r, *rest = stated.sizes
        try:
            return _apt((d, r + 4.0 * stated.unsure * (r > 0.0), *rest))
        except InputError:
            raise error from None


def _apt(sizes: Sequence[float]) -> Profile:
    d, r, e, f, alpha, beta, h = sizes
    return apt(d, r, e, f, radians(alpha), radians(beta), h)


def apt_parameters(cutter: Profile | CutterSizes) -> tuple[float, ...]:
    """The APT parameters d, r, e, f [mm], a, b [deg], h [mm] of a cutter with a straight flank, or as CUTTER states."""
    if isinstance(cutter, CutterSizes):
        return cutter.sizes
    side = cutter.elements[cutter.flank]
    lower = cutter.elements[0]
    corner = next((e for e in cutter.elements if e.is_arc), None)
    beta = np.arctan2(side.end[0] - side.start[0], side.end[1] - side.start[1])
    alpha = 0.0 if lower.is_arc else np.arctan2(lower.end[1] - lower.start[1], lower.end[0] - lower.start[0])
    meet = (side.start[0] - side.start[1] * np.tan(beta)) / (1.0 - np.tan(alpha) * np.tan(beta))
    r, (e, f) = (corner.radius, corner.centre) if corner else (0.0, side.start)
    return 2.0 * meet, r, e, f, degrees(alpha), degrees(beta), cutter.height


def is_apt(cutter: Profile) -> bool:
    """Whether the seven numbers say all of a cutter."""
    if cutter.is_ring or not cutter.is_convex:
        return False
    try:
        stated = _apt(apt_parameters(cutter))
    except InputError:
        return False
    if len(stated.elements) != len(cutter.elements):
        return False
    ends = (np.subtract(a.end, b.end) for a, b in zip(stated.elements, cutter.elements, strict=True))
    return bool(np.max(np.abs(list(ends))) < 1e-6)


def sizes_of(cutter: Profile) -> CutterSizes:
    """A cutter with a straight flank as CUTTER would state it, exactly."""
    return CutterSizes(apt_parameters(cutter), 0.0)


def check_cutter(theirs: CutterSizes | None, cutter: Profile, file: str, name: str = "[cutter]") -> tuple[str, ...]:
    """Refuse a CL file made for another cutter than the scene's, which goes by ``name`` there (InputError).

    What could not be compared, in words.
    """
    if theirs is None:
        return ()
    if not is_apt(cutter):
        return (f"{theirs} (line {theirs.line}) was not compared: the scene's {name}, {cutter.name}, is no APT cutter",)
    ours = sizes_of(cutter)
    if letters := theirs.differs(ours):
        where = f"{file} is for {theirs} (line {theirs.line})"
        raise InputError(f"{where}; the scene's {name} is {ours}: {', '.join(letters)} differ")
    if theirs.height is None:
        return (f"{theirs} states no more of the tool; the scene's is {ours}",)
    if abs(theirs.height - cutter.height) > theirs.unsure:
        return (f"{theirs} has its height, the scene's {name} {cutter.height:g} mm; the scene's is cut",)
    return ()
