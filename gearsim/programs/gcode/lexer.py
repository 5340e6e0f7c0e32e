"""One line of a program taken apart: words, comments, assignments."""

from __future__ import annotations

import re
from typing import NamedTuple, Protocol

from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.squeeze import Squeezed, squeezed
from gearsim.programs.gcode.structure import o_word

VALUE_LIMIT = 1e9

_NUMBER_LIKE = re.compile(r"[+\-.0-9]*")
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)")
_LINE_NUMBER = re.compile(r"N([0-9]+)(?:\.[0-9]+)?", re.IGNORECASE)
_VALUE = re.compile(r"[+-]*([#\[.0-9]|[A-Z]{2})", re.IGNORECASE)
_SPLIT = re.compile(r"[-+.0-9][ \t]+([-+.0-9]+)")
_COMMENT = re.compile(r"\([^)]*\)")
_MACRO = re.compile(r"WHILE|GOTO|IF|DO[0-9]|END[0-9]|POPEN|PCLOS|DPRNT|BPRNT|SETVN", re.IGNORECASE)
_MACROS_REFUSED = "macro language is not read in this dialect; expand the macro"
_ORDERS = {"abort,": "this comment stops the control", "py,": "this comment runs Python in the control",
           "pyrun,": "this comment runs Python in the control"}  # fmt: skip


class Word(NamedTuple):
    """A letter with its value, and where it stands in the squeezed line (characters from 0)."""

    letter: str
    value: float
    start: int
    end: int


class Statement(NamedTuple):
    """A line's words and comments in their order; ``line`` is the one that the words' places count in."""

    line: Squeezed
    words: list[Word]
    comments: list[str]


class Values(Protocol):
    """Evaluates what is no plain number: expressions and parameters."""

    def value(self, line: Line, start: int) -> tuple[float, int]:
        """The value of the expression at ``start`` and where it ends."""
        ...

    def assign(self, line: Line, start: int) -> int:
        """Take the assignment ``#...=...`` at ``start``; where it ends."""
        ...

    def commit(self) -> None:
        """Make the assignments of a line that has been read."""
        ...


def lex(whole: Line, dialect: Dialect, values: Values | None) -> Statement:
    """Take a line apart; ``values`` evaluates expressions where the dialect has them.

    Raises ProgramError for whatever is no word, comment or assignment.
    """
    line = squeezed(whole, dialect.line_limit)
    if not dialect.parameters:
        _check_blanks(whole)
    text, found = line.text, Statement(line, [], [])
    pos = _head(line, dialect, found.words)
    while pos < len(text):
        char = text[pos]
        if char == "(":
            start, pos = pos, text.index(")", pos) + 1
            found.comments.append(text[start + 1 : pos - 1].strip())
            if dialect.parameters and "(" not in text[pos:].partition(";")[0]:
                _check_order(line, start, pos)
        elif char == ";":
            found.comments.append(text[pos + 1 :].strip())
            pos = len(text)
        elif char.isalpha():
            pos = _word(line, pos, dialect, values, found.words)
        elif char == "#" and values is not None:
            pos = values.assign(line, pos)
        else:
            raise line.error(pos, pos + 1, _reason(char))
    return found


def _check_blanks(line: Line) -> None:
    """Refuse a blank inside a number: LinuxCNC is known to pass over it, other controls are not."""
    split = _SPLIT.search(_without_comments(line.text))
    if split:
        raise line.error(split.start(1), split.end(1), "a word begins with a letter; a blank ends a number")


def _head(line: Squeezed, dialect: Dialect, words: list[Word]) -> int:
    """Where the words begin: behind the sign of block delete, and in LinuxCNC behind line number and a lonely label."""
    text = line.text
    start = int(text.startswith("/"))
    if not dialect.parameters:
        return start + int(start == 1 and text[1:2].isdigit())
    number = _LINE_NUMBER.match(text, start)
    if number:
        words.append(Word("N", float(number[1]), start, number.end()))
        start = number.end()
    label = o_word(line)
    if label is None:
        return start
    if label.label.isdigit():
        words.append(Word("O", float(label.label), label.start, label.end))
    return label.end


def _check_order(line: Squeezed, start: int, end: int) -> None:
    """Refuse the line's last comment where LinuxCNC takes it for more than a comment."""
    told = line.text[start + 1 : end - 1].lstrip().lower()
    for order, what in _ORDERS.items():
        if told.startswith(order):
            raise line.error(start, end, f"{what}; what the program does then is not known here")


def _reason(char: str) -> str:
    known = {
        "#": _MACROS_REFUSED,
        "[": "an expression stands behind a letter",
        "%": "the sign % stands alone on its line",
        "/": "block delete stands at the start of a line",
        ")": "a comment ends that has not begun",
        "@": "polar coordinates are not read; write X and Y",
        "^": "polar coordinates are not read; write X and Y",
        "$": "the number of a spindle is not read; there is one",
    }
    if char in known:
        return known[char]
    return "a word begins with a letter" if char in "+-.0123456789" else "this character belongs to no word"


def _word(line: Line, start: int, dialect: Dialect, values: Values | None, words: list[Word]) -> int:
    text, letter = line.text, line.text[start].upper()
    macro = None if dialect.parameters else _MACRO.match(text, start)
    if macro:
        raise line.error(start, macro.end(), _MACROS_REFUSED)
    pos = start + 1
    if letter not in dialect.letters:
        end = number_end(text, pos)
        raise line.error(start, end, f"dialect {dialect.name} has no words with the letter {letter}")
    if letter == "N" and dialect.parameters:
        raise line.error(start, number_end(text, pos), "a line number is digits, and stands first in its line")
    value, end = _value(line, start, pos, values)
    if abs(value) > VALUE_LIMIT:
        raise line.error(start, end, f"the number is too large; up to {VALUE_LIMIT:.0f} is read")
    words.append(Word(letter, value, start, end))
    return end


def _value(line: Line, start: int, pos: int, values: Values | None) -> tuple[float, int]:
    text = line.text
    if values is not None and _VALUE.match(text, pos):
        return values.value(line, pos)
    if text[pos : pos + 1] in ("#", "["):
        raise line.error(start, pos + 1, _MACROS_REFUSED)
    end = number_end(text, pos)
    if end == pos:
        raise line.error(start, start + 1, f"a number is missing behind {text[start].upper()}")
    return number(line, start, pos, end), end


def number_end(text: str, pos: int) -> int:
    """Where the characters that numbers are made of end."""
    found = _NUMBER_LIKE.match(text, pos)
    return found.end() if found else pos


def number(line: Line, start: int, pos: int, end: int) -> float:
    """The number from ``pos`` to ``end``; an error names everything from ``start`` on."""
    if not _NUMBER.fullmatch(line.text, pos, end):
        raise line.error(start, end, f"{line.text[pos:end]} is not a number; expected a form like -12.345")
    return float(line.text[pos:end])


def find_word(line: Line, letters: str) -> tuple[int, int]:
    """Where the first word with one of the letters stands, else the whole line."""
    found = re.search(rf"(?i)[{letters}]\s*[+\-.0-9\[#][^A-Z]*", _without_comments(line.text))
    return (found.start(), found.start() + len(found[0].rstrip())) if found else (0, len(line.text))


def _without_comments(text: str) -> str:
    """The text with blanks in the place of comments in brackets."""
    return _COMMENT.sub(lambda found: " " * len(found[0]), text)
