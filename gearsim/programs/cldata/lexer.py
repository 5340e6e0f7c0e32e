"""From the lines of a CL file to its statements: comments, continued lines, text words, combined words."""

from __future__ import annotations

import re
from dataclasses import dataclass

from gearsim.errors import InputError
from gearsim.programs.cldata.numbers import fields, is_number
from gearsim.programs.cldata.words import GLUED_TEXT, KNOWN, MOTION, SPACED_TEXT

_TEXT = re.compile(rf"({'|'.join(GLUED_TEXT)})(.*)|({'|'.join(SPACED_TEXT)})(?![A-Z0-9_])(.*)", re.I | re.S)
_STATEMENT = re.compile(rf"(?:{'|'.join(KNOWN)})\s*(?:/|$)|RAPID\s*,", re.I)
_MOVE = "|".join((*MOTION, "RAPID"))
MOVES_WITHIN = re.compile(rf"({_MOVE})\s*/|(?<![A-Z0-9_])({_MOVE})(?![A-Z0-9_])|(RAPID)\s*$", re.I)
_SYSTEM_COMMENT = re.compile(r"->\s*(CSYS|CUTTER)\s*/(.*)", re.I | re.S)
_SHOWN = 30


@dataclass(frozen=True)
class Statement:
    """A ``word`` in capitals, what stands behind it, and the line it begins in.

    ``text``: a text word, its ``rest`` as it stands; ``slash``: one stands between word and rest. A statement that
    begins with no word has it empty.
    """

    line: int
    word: str
    rest: str
    text: bool = False
    slash: bool = True

    def __str__(self) -> str:
        shown = f"{self.word}/{self.rest}" if self.rest else self.word
        return shown if len(shown) <= _SHOWN else f"{shown[:_SHOWN]}..."


def statements(source: str, name: str) -> list[Statement]:
    """The statements of a CL file; ``name`` stands in the messages.

    Comments are dropped, but for those in which a CAM system states CSYS or CUTTER: ``$$-> CSYS / ...``, and rows of a
    matrix behind ``$$``. Raises InputError naming the line of a ``$`` that carries nothing on, or of a move that stands
    in another statement.
    """
    lexer = _Lexer(name)
    for number, line in enumerate(re.split(r"\r\n|\r|\n", source.rstrip("\x1a")), 1):
        lexer.take(number, line.strip("\ufeff \t\f\v\x00"))
    return lexer.finish()


class _Lexer:
    """What is open between two lines: a statement, or a comment, that is carried on."""

    def __init__(self, name: str):
        self.name = name
        self.out: list[Statement] = []
        self.open: list[str] = []
        self.comment: list[str] = []
        self.matrix: list[str] = []
        self.start = 0
        self.comment_start = 0

    def fail(self, line: int, message: str) -> InputError:
        return InputError(f"{self.name}, line {line}: {message}")

    def take(self, number: int, line: str) -> None:
        self._matrix_row(number, line)
        if self.comment and self._carries_comment(number, line):
            return
        if found := _TEXT.fullmatch(line):
            if self.open:
                raise self._carried_on(number)
            word, rest = (found[1], found[2]) if found[1] else (found[3], found[4])
            self.out.append(Statement(number, word.upper(), rest.strip().removeprefix("/").strip(), text=True))
            return
        code, mark, comment = (part.strip() for part in line.partition("$$"))
        if mark and not self.open and not code:
            self._begin_comment(number, comment)
        if code:
            self._take_code(number, code)

    def finish(self) -> list[Statement]:
        self._end_comment()
        if self.open:
            raise self.fail(self.start, "the file ends in a line to be continued ('$')")
        return self.out

    def _take_code(self, number: int, code: str) -> None:
        if self.open and _STATEMENT.match(code):
            raise self._carried_on(number)
        self.start = self.start if self.open else number
        self.open.append(code.removesuffix("$").strip())
        if "$" in self.open[-1]:
            raise self.fail(number, "'$' carries a line on and stands at its end; '$$' begins a comment")
        if not code.endswith("$"):
            self._emit(self.start, " ".join(self.open).strip())
            self.open = []

    def _emit(self, line: int, statement: str) -> None:
        head, slash, rest = (part.strip() for part in statement.partition("/"))
        words = re.split(r"[\s,]+", head.upper(), maxsplit=0 if slash else 1)
        if not slash:
            rest = words[1] if len(words) > 1 else ""
            words = words[:1]
        if words[0] == "RAPID" and len(words) == 2:
            self.out.append(Statement(line, words.pop(0), ""))
        word = " ".join(words) if words[0][:1].isalpha() else ""
        if within := MOVES_WITHIN.search(rest):
            raise self.fail(
                line,
                f"{within[0].strip(' /').upper()} stands within {word or 'numbers'}; a move needs a line of its own",
            )
        self.out.append(Statement(line, word, rest if word else statement, slash=bool(slash)))

    def _carried_on(self, number: int) -> InputError:
        return self.fail(number, f"a statement begins here, but '$' carries on the one of line {self.start}")

    def _begin_comment(self, number: int, comment: str) -> None:
        self.comment, self.comment_start = [comment.removesuffix("$")], number
        if not comment.endswith("$"):
            self._end_comment()

    def _carries_comment(self, number: int, line: str) -> bool:
        """Whether a line belongs to the comment above: the numbers left of it do, a statement does not."""
        if not line or line[0].isalpha() or line.startswith("$"):
            self._end_comment()
            return False
        self.comment.append(line.removesuffix("$"))
        if not line.endswith("$"):
            self._end_comment()
        return True

    def _matrix_row(self, number: int, line: str) -> None:
        """Three comments of four numbers each, one behind the other, are a coordinate system as CATIA states it."""
        row = fields(line[2:].replace(",", " ")) if line.startswith("$$") else []
        self.matrix = [*self.matrix, *row] if len(row) == 4 and all(map(is_number, row)) else []
        if len(self.matrix) == 12:
            self.out.append(Statement(number - 2, "CSYS", ", ".join(self.matrix)))
            self.matrix = []

    def _end_comment(self) -> None:
        comment, self.comment = " ".join(self.comment), []
        if stated := _SYSTEM_COMMENT.match(comment):
            self.out.append(Statement(self.comment_start, stated[1].upper(), stated[2].strip()))
