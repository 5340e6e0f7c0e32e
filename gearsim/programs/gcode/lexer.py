"""One line of a program taken apart: words, comments, assignments."""

from __future__ import annotations

import re
from typing import NamedTuple, Protocol

from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import Line

LINE_LIMIT = 256
VALUE_LIMIT = 1e9

_STRANGE = re.compile(r"[^\x20-\x7e\t]")
_NUMBER_LIKE = re.compile(r"[+\-.0-9]*")
_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)")
_MACRO = re.compile(r"WHILE|GOTO|IF|DO[0-9]|END[0-9]|POPEN|PCLOS|DPRNT|BPRNT|SETVN", re.IGNORECASE)
_EXPRESSION = re.compile(r"[+-]?[ \t]*([#\[]|[A-Z]{2})", re.IGNORECASE)
_MACROS_REFUSED = "macro language is not read in this dialect; expand the macro"


class Word(NamedTuple):
    """A letter with its value, and where it stands in the line (characters from 0)."""

    letter: str
    value: float
    start: int
    end: int


class Statement(NamedTuple):
    """A line's words and comments in their order."""

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


def lex(line: Line, dialect: Dialect, values: Values | None) -> Statement:
    """Take a line apart; ``values`` evaluates expressions where the dialect has them.

    Raises ProgramError for whatever is no word, comment or assignment.
    """
    check_characters(line)
    text, pos = line.text, 0
    found = Statement([], [])
    while pos < len(text):
        char = text[pos]
        if char in " \t":
            pos += 1
        elif char == "(":
            pos = _comment(line, pos, found.comments)
        elif char == ";":
            found.comments.append(text[pos + 1 :].strip())
            pos = len(text)
        elif char.isalpha():
            pos = _word(line, pos, dialect, values, found.words)
        elif char == "#" and values is not None:
            pos = values.assign(line, pos)
        elif char == "/" and not found.words and not text[:pos].strip():
            pos += 2 if text[pos + 1 : pos + 2].isdigit() else 1
        else:
            raise line.error(pos, pos + 1, _reason(char))
    return found


def check_characters(line: Line) -> None:
    """Raise ProgramError for characters that no program has, and for lines that are too long."""
    strange = _STRANGE.search(line.text)
    if strange:
        raise line.error(strange.start(), strange.end(), "a program is written in printable ASCII characters")
    if len(line.text) > LINE_LIMIT:
        raise line.error(
            LINE_LIMIT, LINE_LIMIT, f"the line has {len(line.text)} characters; up to {LINE_LIMIT} are read"
        )


def _reason(char: str) -> str:
    known = {
        "#": _MACROS_REFUSED,
        "[": "an expression stands behind a letter",
        "%": "the sign % stands alone on its line",
        "/": "block delete stands at the start of a line",
        ")": "a comment ends that has not begun",
    }
    if char in known:
        return known[char]
    return "a word begins with a letter" if char in "+-.0123456789" else "this character belongs to no word"


def _comment(line: Line, start: int, comments: list[str]) -> int:
    end, inner = line.text.find(")", start), line.text.find("(", start + 1)
    if end < 0:
        raise line.error(start, len(line.text), "the comment is not finished; ')' is missing")
    if start < inner < end:
        raise line.error(inner, inner + 1, "comments do not nest; close the first one before")
    comments.append(line.text[start + 1 : end].strip())
    return end + 1


def _word(line: Line, start: int, dialect: Dialect, values: Values | None, words: list[Word]) -> int:
    text, letter = line.text, line.text[start].upper()
    macro = None if dialect.parameters else _MACRO.match(text, start)
    if macro:
        raise line.error(start, macro.end(), _MACROS_REFUSED)
    pos = start + 1
    while pos < len(text) and text[pos] in " \t":
        pos += 1
    if letter not in dialect.letters:
        end = number_end(text, pos)
        raise line.error(start, end, f"dialect {dialect.name} has no words with the letter {letter}")
    value, end = _value(line, start, pos, values)
    if abs(value) > VALUE_LIMIT:
        raise line.error(start, end, f"the number is too large; up to {VALUE_LIMIT:.0f} is read")
    words.append(Word(letter, value, start, end))
    return end


def _value(line: Line, start: int, pos: int, values: Values | None) -> tuple[float, int]:
    text = line.text
    if values is not None and _EXPRESSION.match(text, pos):
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
    found = re.search(
        rf"(?i)[{letters}]\s*[+\-.0-9\[#][^A-Z]*", re.sub(r"\([^)]*\)", lambda m: " " * len(m[0]), line.text)
    )
    return (found.start(), found.start() + len(found[0].rstrip())) if found else (0, len(line.text))
