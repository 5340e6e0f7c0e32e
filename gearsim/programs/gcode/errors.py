"""Errors in a program: which file, line, column and word."""

from __future__ import annotations

from dataclasses import dataclass

from gearsim.errors import InputError

_SHOWN = 40


class ProgramError(InputError):
    """A program that cannot be read; ``source`` names it, ``line`` and ``column`` count from 1, ``word`` as written."""

    def __init__(self, source: str, line: int, column: int, word: str, reason: str):
        shown = word if len(word) <= _SHOWN else word[:_SHOWN] + "..."
        shown = shown if shown.isascii() and shown.isprintable() else ascii(shown)
        where = f"{source}, line {line}, column {column}"
        super().__init__(f"{where}, {shown}: {reason}" if word else f"{where}: {reason}")
        self.source, self.line, self.column, self.word = source, line, column, word


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a program: its text without the line's end, ``number`` from 1."""

    source: str
    number: int
    text: str

    def error(self, start: int, end: int, reason: str) -> ProgramError:
        """An error at the characters from ``start`` to ``end``, counted from 0."""
        return ProgramError(self.source, self.number, start + 1, self.text[start:end].strip(), reason)
