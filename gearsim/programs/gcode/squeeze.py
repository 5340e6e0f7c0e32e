"""The characters of a line that count: a control passes over blanks outside of comments, even inside a number."""

from __future__ import annotations

import re
from dataclasses import dataclass

from gearsim.programs.gcode.errors import Line, ProgramError

_BLANKS = " \t"
_NO_BLANKS = str.maketrans("", "", _BLANKS)
_COMMENTS = re.compile(r"(\([^)]*\)?|;.*)", re.DOTALL)
_STRANGE = re.compile(r"[^\x21-\x7e]")


@dataclass(frozen=True, slots=True)
class Squeezed(Line):
    """A line without blanks outside of comments; its errors speak of the ``whole`` line."""

    whole: Line

    def error(self, start: int, end: int, reason: str) -> ProgramError:
        """An error at the characters from ``start`` to ``end`` of the squeezed text."""
        places = [*_places(self.whole.text.rstrip("\r")), len(self.whole.text.rstrip())]
        first = places[min(start, len(places) - 1)]
        last = places[min(end, len(places)) - 1] + 1 if end > start else first
        return self.whole.error(first, last, reason)


def squeezed(line: Line, limit: int) -> Squeezed:
    """The line as a control reads it. Raises ProgramError for comments that nest or do not end, for characters that
    no program has (comments may have any), and for lines of more than ``limit`` characters."""
    text = line.text.rstrip("\r")
    if len(line.text) > limit:
        raise line.error(limit, limit, f"the line has {len(line.text)} characters; up to {limit} are read")
    if "(" not in text and ";" not in text:
        kept = text.translate(_NO_BLANKS)
        found = Squeezed(line.source, line.number, kept, line)
        _check(found, kept, 0)
        return found
    parts = [part if i % 2 else part.translate(_NO_BLANKS) for i, part in enumerate(_COMMENTS.split(text))]
    found, pos = Squeezed(line.source, line.number, "".join(parts), line), 0
    for i, part in enumerate(parts):
        (_check_comment if i % 2 else _check)(found, part, pos)
        pos += len(part)
    return found


def _check(line: Squeezed, part: str, pos: int) -> None:
    strange = _STRANGE.search(part)
    if strange:
        at = pos + strange.start()
        raise line.error(at, at + 1, "outside of comments a program is written in printable ASCII characters")


def _check_comment(line: Squeezed, part: str, pos: int) -> None:
    inner = part.find("(", 1)
    returns = part.find("\r")
    if returns >= 0:
        raise line.error(pos + returns, pos + returns + 1, "a carriage return ends no line; a line feed does")
    if part[0] == "(" and not part.endswith(")"):
        raise line.error(pos, pos + len(part), "the comment is not finished; ')' is missing")
    if part[0] == "(" and inner > 0:
        raise line.error(pos + inner, pos + inner + 1, "comments do not nest; close the first one before")


def _places(text: str) -> list[int]:
    """Where the characters that are kept stand in the whole line."""
    places, pos = [], 0
    for i, part in enumerate(_COMMENTS.split(text)):
        places += [pos + k for k, char in enumerate(part) if i % 2 or char not in _BLANKS]
        pos += len(part)
    return places
