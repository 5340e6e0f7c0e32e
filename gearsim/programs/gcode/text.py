"""The text of a program: where it comes from, its lines, and pieces of many lines for the fast road."""

from __future__ import annotations

import codecs
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from gearsim.errors import read_input_bytes
from gearsim.programs.gcode.errors import Line

_PIECE = 1 << 20


@dataclass(frozen=True)
class Text:
    """A program as bytes; ``name`` stands in messages."""

    name: str
    data: bytes

    def pieces(self) -> Iterator[bytes]:
        """The text in pieces of about a megabyte; each ends with a line's end."""
        start, data = 0, self.data
        while start < len(data):
            end = data.find(b"\n", min(start + _PIECE, len(data)))
            end = len(data) if end < 0 else end + 1
            piece = data[start:end]
            yield piece if piece.endswith(b"\n") else piece + b"\n"
            start = end

    def line(self, number: int) -> Line:
        """A line by its number from 1."""
        start = 0
        for _ in range(number - 1):
            start = self.data.find(b"\n", start) + 1
        end = self.data.find(b"\n", start)
        return as_line(self.name, number, self.data[start : len(self.data) if end < 0 else end])

    def lines(self) -> list[Line]:
        """All lines."""
        return [as_line(self.name, i, raw) for i, raw in enumerate(self.data.split(b"\n"), 1)]


def as_line(name: str, number: int, raw: bytes) -> Line:
    """A line from its bytes without the line feed: UTF-8, or else Latin-1, which has a character for every byte."""
    try:
        return Line(name, number, raw.decode("utf-8"))
    except UnicodeDecodeError:
        return Line(name, number, raw.decode("latin-1"))


def open_text(source: str | Path) -> Text:
    """A program from its text or from a file; byte-order marks are taken off, UTF-16 is known by its mark.

    Raises InputError where the file cannot be read.
    """
    if isinstance(source, str):
        return Text("program", source.removeprefix("\ufeff").encode("utf-8", "replace"))
    data = read_input_bytes(source, "program")
    if data.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        data = data.decode("utf-16", "replace").encode("utf-8", "replace")
    return Text(str(source), data.removeprefix(codecs.BOM_UTF8))
