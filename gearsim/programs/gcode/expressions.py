"""LinuxCNC's expressions on a squeezed line: [ ... ], # parameters, functions. Angles are in degrees.

From the tightest to the loosest: **, then * / MOD, + -, comparisons, AND OR XOR; equals from left to right.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial

import numpy as np

from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.lexer import number
from gearsim.programs.gcode.parameters import CONTROLS_OWN, LAST_NUMBER, NUMBERS, Key, Parameters

EQUAL = 1e-4  # numbers closer than this are EQ
WHOLE = 1e-4  # a number this near to a whole one stands for it
_DEPTH = 30
_LARGEST = 1e300
_LARGEST_ROUND = 2.0**31
_WORD = re.compile(r"[A-Z]+", re.IGNORECASE)
_OPERATOR = re.compile(r"\*\*|\*|/|\+|-|MOD|EQ|NE|GT|GE|LT|LE|AND|OR|XOR", re.IGNORECASE)
_DIGIT = re.compile(r"[0-9.]")
_PI = np.longdouble("3.14159265358979323846264338327950288")


def _of_degrees(function: np.ufunc) -> Callable[[float], float]:
    """LinuxCNC computes in long double, so that SIN[30] is 0.5 and TAN[45] is 1: FIX and FUP see the difference."""
    return lambda x: float(function(np.longdouble(x) * _PI / 180))


def _degrees(angle: float) -> float:
    return float(np.longdouble(angle * 180.0) / _PI)


def _rounded(x: float) -> float:
    """Halves away from zero."""
    if not abs(x) < _LARGEST_ROUND - 1.0:
        raise OverflowError
    return float(int(x + math.copysign(0.5, x)))


def _modulo(a: float, b: float) -> float:
    """Never negative."""
    rest = math.fmod(a, b)
    return rest + abs(b) if rest < 0.0 else rest


_OPERATORS: tuple[dict[str, Callable[[float, float], float]], ...] = (
    {
        "AND": lambda a, b: float(bool(a) and bool(b)),
        "OR": lambda a, b: float(bool(a) or bool(b)),
        "XOR": lambda a, b: float(bool(a) != bool(b)),
    },
    {
        "EQ": lambda a, b: float(abs(a - b) < EQUAL),
        "NE": lambda a, b: float(abs(a - b) >= EQUAL),
        "GT": lambda a, b: float(a > b),
        "GE": lambda a, b: float(a >= b),
        "LT": lambda a, b: float(a < b),
        "LE": lambda a, b: float(a <= b),
    },
    {"+": lambda a, b: a + b, "-": lambda a, b: a - b},
    {"*": lambda a, b: a * b, "/": lambda a, b: a / b, "MOD": _modulo},
    {"**": math.pow},
)
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "ABS": abs,
    "ACOS": lambda x: _degrees(math.acos(x)),
    "ASIN": lambda x: _degrees(math.asin(x)),
    "COS": _of_degrees(np.cos),
    "EXP": math.exp,
    "FIX": lambda x: float(math.floor(x)),
    "FUP": lambda x: float(math.ceil(x)),
    "LN": math.log,
    "ROUND": _rounded,
    "SIN": _of_degrees(np.sin),
    "SQRT": math.sqrt,
    "TAN": _of_degrees(np.tan),
}


class Expressions:
    """Evaluates values at places of a squeezed line, with the parameters in force."""

    def __init__(self, parameters: Parameters):
        self.parameters = parameters

    def value(self, line: Line, start: int) -> tuple[float, int]:
        """The value at ``start`` and where it ends. Raises ProgramError."""
        return self._value(line, start, 0)

    def assign(self, line: Line, start: int) -> int:
        """Take an assignment ``#5=1`` or ``#<name>=[2*3]``; it holds from the next line on.

        A name begins to exist, with the value 0, where its assignment begins.
        """
        key, pos = self._key(line, start, 0)
        if key in CONTROLS_OWN:
            raise line.error(start, pos, "this parameter is the control's own and cannot be set")
        self._check_number(line, start, pos, key)
        self.parameters.declare(key)
        if line.text[pos : pos + 1] != "=":
            raise line.error(start, pos, "a parameter that stands alone is set; = is missing")
        value, end = self._value(line, pos + 1, 0)
        self.parameters.set_later(key, value)
        return end

    def commit(self) -> None:
        """Make the settings of the line."""
        self.parameters.commit()

    def _value(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        text, char = line.text, line.text[start : start + 1]
        if depth > _DEPTH:
            raise line.error(start, start + 1, f"the expression is nested more than {_DEPTH} deep")
        if char == "[":
            return self._bracket(line, start, depth)
        if char == "#":
            return self._parameter(line, start, depth)
        if char in ("+", "-") and not _DIGIT.match(text, start + 1):
            value, end = self._value(line, start + 1, depth + 1)
            return (-value if char == "-" else value), end
        if char.isalpha():
            return self._function(line, start, depth)
        end = _unsigned_end(text, start + 1 if char in ("+", "-") else start)
        if end == start:
            raise line.error(start, start + 1, "expected a number, a parameter, a function or [ ... ]")
        return number(line, start, start, end), end

    def _bracket(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        value, end = self._sum(line, start + 1, depth + 1, 0)
        if line.text[end : end + 1] != "]":
            raise line.error(start, max(end, start + 1), "the expression is not finished; ] or an operator is missing")
        return value, end + 1

    def _sum(self, line: Line, start: int, depth: int, level: int) -> tuple[float, int]:
        """A chain of operators of one level, whose operands are chains of the next."""
        if level == len(_OPERATORS):
            return self._value(line, start, depth)
        value, pos = self._sum(line, start, depth, level + 1)
        while (sign := _OPERATOR.match(line.text, pos)) and sign[0].upper() in _OPERATORS[level]:
            other, end = self._sum(line, sign.end(), depth, level + 1)
            operator, left = _OPERATORS[level][sign[0].upper()], value
            value = _computed(line, sign.start(), sign.end(), partial(operator, left, other))
            pos = end
        return value, pos

    def _function(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        found = _WORD.match(line.text, start)
        name, pos = (found[0].upper(), found.end()) if found else ("", start)
        if name not in _FUNCTIONS and name not in ("ATAN", "EXISTS"):
            raise line.error(start, pos, f"no function of that name; there are {', '.join(sorted(_FUNCTIONS))}, ATAN")
        if line.text[pos : pos + 1] != "[":
            raise line.error(start, pos, f"[ is missing behind {name}")
        if name == "EXISTS":
            return self._exists(line, start, pos + 1, depth)
        argument, end = self._bracket(line, pos, depth)
        if name != "ATAN":
            return _computed(line, start, end, lambda: _FUNCTIONS[name](argument)), end
        if line.text[end : end + 2] != "/[":
            raise line.error(start, end, "ATAN has two arguments: ATAN[y]/[x]")
        other, end = self._bracket(line, end + 1, depth)
        return _degrees(math.atan2(argument, other)), end

    def _exists(self, line: Line, start: int, pos: int, depth: int) -> tuple[float, int]:
        key, end = self._key(line, pos, depth)
        if line.text[end : end + 1] != "]":
            raise line.error(start, end, "EXISTS[#<name>] asks for one parameter; ] is missing")
        return float(key in NUMBERS if isinstance(key, int) else self.parameters.exists(key)), end + 1

    def _parameter(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        key, end = self._key(line, start, depth)
        self._check_number(line, start, end, key)
        value = self.parameters.get(key)
        if value is None and key in CONTROLS_OWN:
            raise line.error(start, end, "what the control says about itself in this parameter is not known here")
        if value is None:
            raise line.error(start, end, "the parameter has no value yet")
        return value, end

    def _key(self, line: Line, start: int, depth: int) -> tuple[Key, int]:
        """The name or number behind #."""
        text = line.text
        if text[start : start + 1] != "#":
            raise line.error(start, start + 1, "expected a parameter, # and a number or a <name>")
        if text[start + 1 : start + 2] == "<":
            end = text.find(">", start)
            name = text[start + 2 : end].lower()
            if end < 0 or not name:
                raise line.error(start, len(text) if end < 0 else end + 1, "the parameter's <name> is not finished")
            return name, end + 1
        value, end = self._value(line, start + 1, depth + 1)
        if abs(value - round(value)) > WHOLE:
            raise line.error(start, end, f"a parameter's number is whole; this is {value:g}")
        return round(value), end

    def _check_number(self, line: Line, start: int, end: int, key: Key) -> None:
        if isinstance(key, int) and not 1 <= key <= LAST_NUMBER:
            reason = f"parameters of the program are #1 to #{LAST_NUMBER}; those of the control are not known here"
            raise line.error(start, end, reason)


def _unsigned_end(text: str, start: int) -> int:
    end = start
    while end < len(text) and (text[end].isdigit() or text[end] == "."):
        end += 1
    return end


def _computed(line: Line, start: int, end: int, compute: Callable[[], float]) -> float:
    try:
        value = compute()
    except (ValueError, ZeroDivisionError, OverflowError):
        value = math.nan
    if not abs(value) < _LARGEST:
        raise line.error(start, end, "this has no value for these numbers")
    return value
