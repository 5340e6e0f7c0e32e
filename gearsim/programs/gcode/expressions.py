"""LinuxCNC's expressions: [ ... ], # parameters, functions. Angles are in degrees.

From the tightest to the loosest: **, then * / MOD, + -, comparisons, AND OR XOR; equals from left to right.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from functools import partial

from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.lexer import number
from gearsim.programs.gcode.parameters import LAST_NUMBER, Key, Parameters

_DEPTH = 30
_LARGEST = 1e300
_WORD = re.compile(r"[A-Z]+", re.IGNORECASE)
_OPERATOR = re.compile(r"\*\*|\*|/|\+|-|MOD|EQ|NE|GT|GE|LT|LE|AND|OR|XOR", re.IGNORECASE)

_OPERATORS: tuple[dict[str, Callable[[float, float], float]], ...] = (
    {
        "AND": lambda a, b: float(bool(a) and bool(b)),
        "OR": lambda a, b: float(bool(a) or bool(b)),
        "XOR": lambda a, b: float(bool(a) != bool(b)),
    },
    {
        "EQ": lambda a, b: float(a == b),
        "NE": lambda a, b: float(a != b),
        "GT": lambda a, b: float(a > b),
        "GE": lambda a, b: float(a >= b),
        "LT": lambda a, b: float(a < b),
        "LE": lambda a, b: float(a <= b),
    },
    {"+": lambda a, b: a + b, "-": lambda a, b: a - b},
    {"*": lambda a, b: a * b, "/": lambda a, b: a / b, "MOD": lambda a, b: a % abs(b)},
    {"**": math.pow},
)
_FUNCTIONS: dict[str, Callable[[float], float]] = {
    "ABS": abs,
    "ACOS": lambda x: math.degrees(math.acos(x)),
    "ASIN": lambda x: math.degrees(math.asin(x)),
    "COS": lambda x: math.cos(math.radians(x)),
    "EXP": math.exp,
    "FIX": lambda x: float(math.floor(x)),
    "FUP": lambda x: float(math.ceil(x)),
    "LN": math.log,
    "ROUND": lambda x: float(math.floor(x + 0.5)),
    "SIN": lambda x: math.sin(math.radians(x)),
    "SQRT": math.sqrt,
    "TAN": lambda x: math.tan(math.radians(x)),
}


class Expressions:
    """Evaluates values at places of a line, with the parameters in force."""

    def __init__(self, parameters: Parameters):
        self.parameters = parameters

    def value(self, line: Line, start: int) -> tuple[float, int]:
        """The value at ``start`` and where it ends. Raises ProgramError."""
        return self._value(line, start, 0)

    def assign(self, line: Line, start: int) -> int:
        """Take an assignment ``#5 = 1`` or ``#<name> = [2 * 3]``; it holds from the next line on."""
        key, pos = self._key(line, start, 0)
        pos = skip(line.text, pos)
        if line.text[pos : pos + 1] != "=":
            raise line.error(start, pos, "a parameter that stands alone is set; = is missing")
        value, end = self._value(line, skip(line.text, pos + 1), 0)
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
        if char in ("+", "-") and not re.match(r"[0-9.]", text[start + 1 : start + 2]):
            value, end = self._value(line, skip(text, start + 1), depth + 1)
            return (-value if char == "-" else value), end
        if char.isalpha():
            return self._function(line, start, depth)
        end = _unsigned_end(text, start + 1 if char in ("+", "-") else start)
        if end == start:
            raise line.error(start, start + 1, "expected a number, a parameter, a function or [ ... ]")
        return number(line, start, start, end), end

    def _bracket(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        value, end = self._sum(line, skip(line.text, start + 1), depth + 1, 0)
        if line.text[end : end + 1] != "]":
            raise line.error(start, max(end, start + 1), "the expression is not finished; ] or an operator is missing")
        return value, end + 1

    def _sum(self, line: Line, start: int, depth: int, level: int) -> tuple[float, int]:
        """A chain of operators of one level, whose operands are chains of the next."""
        if level == len(_OPERATORS):
            value, end = self._value(line, start, depth)
            return value, skip(line.text, end)
        value, pos = self._sum(line, start, depth, level + 1)
        while (sign := _OPERATOR.match(line.text, pos)) and sign[0].upper() in _OPERATORS[level]:
            other, end = self._sum(line, skip(line.text, sign.end()), depth, level + 1)
            operator, left = _OPERATORS[level][sign[0].upper()], value
            value = _computed(line, sign.start(), sign.end(), partial(operator, left, other))
            pos = end
        return value, pos

    def _function(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        found = _WORD.match(line.text, start)
        name, pos = (found[0].upper(), skip(line.text, found.end())) if found else ("", start)
        if name not in _FUNCTIONS and name not in ("ATAN", "EXISTS"):
            raise line.error(start, pos, f"no function of that name; there are {', '.join(sorted(_FUNCTIONS))}, ATAN")
        if line.text[pos : pos + 1] != "[":
            raise line.error(start, pos, f"[ is missing behind {name}")
        if name == "EXISTS":
            return self._exists(line, start, skip(line.text, pos + 1), depth)
        argument, end = self._bracket(line, pos, depth)
        if name != "ATAN":
            return _computed(line, start, end, lambda: _FUNCTIONS[name](argument)), end
        pos = skip(line.text, end)
        if line.text[pos : pos + 1] != "/" or line.text[skip(line.text, pos + 1) :][:1] != "[":
            raise line.error(start, end, "ATAN has two arguments: ATAN[y]/[x]")
        other, end = self._bracket(line, skip(line.text, pos + 1), depth)
        return math.degrees(math.atan2(argument, other)), end

    def _exists(self, line: Line, start: int, pos: int, depth: int) -> tuple[float, int]:
        key, end = self._key(line, pos, depth)
        end = skip(line.text, end)
        if line.text[end : end + 1] != "]":
            raise line.error(start, end, "EXISTS[#<name>] asks for one parameter; ] is missing")
        return float(isinstance(key, int) or self.parameters.get(key) is not None), end + 1

    def _parameter(self, line: Line, start: int, depth: int) -> tuple[float, int]:
        key, end = self._key(line, start, depth)
        value = self.parameters.get(key)
        if value is None:
            raise line.error(start, end, "the parameter has no value yet")
        return value, end

    def _key(self, line: Line, start: int, depth: int) -> tuple[Key, int]:
        """The name or number behind #."""
        text = line.text
        if text[start : start + 1] != "#":
            raise line.error(start, start + 1, "expected a parameter, # and a number or a <name>")
        pos = skip(text, start + 1)
        if text[pos : pos + 1] == "<":
            end = text.find(">", pos)
            name = "".join(text[pos + 1 : end].split()).lower()
            if end < 0 or not name:
                raise line.error(start, len(text) if end < 0 else end + 1, "the parameter's <name> is not finished")
            return name, end + 1
        value, end = self._value(line, pos, depth + 1)
        if abs(value - round(value)) > 1e-6 or not 1 <= round(value) <= LAST_NUMBER:
            reason = f"parameters of the program are #1 to #{LAST_NUMBER}; those of the control are not known here"
            raise line.error(start, end, reason)
        return round(value), end


def skip(text: str, pos: int) -> int:
    """The next character that is no blank."""
    while pos < len(text) and text[pos] in " \t":
        pos += 1
    return pos


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
