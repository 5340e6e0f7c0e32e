"""Many lines at once: finds the plain ones and puts their numbers into columns, without a Python object a line.

A line is plain if it has nothing but well-formed words for axes, N, F, I, J, K, R and the G codes of motion,
distance and feed mode, none of them twice. Everything else is left to the interpreter, errors included.
"""

from __future__ import annotations

import warnings
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.programs.gcode.dialect import FANUC, Dialect
from gearsim.programs.gcode.lexer import VALUE_LIMIT

_OTHER, _LETTER, _DIGIT, _POINT, _SIGN, _BLANK, _FEED, _SEMICOLON, _RETURN = range(9)
_ENDS = (_BLANK, _FEED, _SEMICOLON, _RETURN)
_FOLLOWERS = {
    _LETTER: (_DIGIT, _POINT, _SIGN),
    _DIGIT: (_LETTER, _DIGIT, _POINT, *_ENDS),
    _POINT: (_LETTER, _DIGIT, *_ENDS),
    _SIGN: (_DIGIT, _POINT),
    _BLANK: (_LETTER, *_ENDS),
    _FEED: (_LETTER, *_ENDS),
    _SEMICOLON: (_FEED, _RETURN),
    _RETURN: (_FEED,),
}
_WRONG, _LEADING_POINT = 1, 2
_G_COLUMNS = {**dict.fromkeys((0, 10, 20, 30), "motion"), **dict.fromkeys((900, 910), "distance"),
              **dict.fromkeys((930, 940, 950), "feed mode")}  # fmt: skip
_NUMBERS = bytes(c if chr(c) in "+-.0123456789" else 32 for c in range(256))


class Scan(NamedTuple):
    """Lines taken apart: line i is ``text[ends[i] + 1 : ends[i + 1]]``; ``special`` (n,) marks those not plain.

    ``values`` and ``present`` (columns, n): the numbers as written, a column a letter or group. ``bare`` (n,) marks
    lines in which a length or an angle other than zero has no decimal point, where the dialect's controls mind it.
    """

    text: bytes
    ends: NDArray[np.integer]
    special: NDArray[np.bool_]
    values: NDArray[np.floating]
    present: NDArray[np.bool_]
    bare: NDArray[np.bool_]

    def raw(self, i: int) -> bytes:
        """A line's bytes."""
        return self.text[self.ends[i] + 1 : self.ends[i + 1]]


class Scanner:
    """Scans text of a dialect for a machine with the given axis letters."""

    def __init__(self, axes: tuple[str, ...], dialect: Dialect = FANUC):
        self.dialect = dialect
        names = [*axes, *"FIJKRN", "motion", "distance", "feed mode", "other G"]
        self.column = {name: i for i, name in enumerate(names)}
        letters = {**self.column, "G": self.column["other G"]}
        self._lengths = np.isin(names, [*axes, *"IJKR"])
        self._columns = _table({c: letters[c] + 1 for c in letters if len(c) == 1})
        self._classes = _classes([c for c in letters if len(c) == 1])
        self._g_columns = np.full(1000, self.column["other G"])
        for code, group in _G_COLUMNS.items():
            self._g_columns[code] = self.column[group]

    def scan(self, piece: bytes) -> Scan:
        """Take whole lines apart; ``piece`` ends with a line feed."""
        text = b"\n" + piece
        classes = np.frombuffer(text.translate(self._classes), np.uint8)
        ends = np.flatnonzero(classes == _FEED)
        special = np.diff(ends) > self.dialect.line_limit + 1
        special[np.searchsorted(ends, _wrong(classes)) - 1] = True
        cleaned = _blanked(text, ends, special)
        marks = np.frombuffer(cleaned.translate(self._columns), np.uint8)
        at = np.flatnonzero(marks != 0)
        numbers = _numbers(cleaned, len(at))
        count = len(special)
        values = np.zeros((len(self.column), count))
        present, bare = np.zeros((len(self.column), count), dtype=bool), np.zeros(count, dtype=bool)
        if numbers is None:
            return Scan(text, ends, np.ones(count, dtype=bool), values, present, bare)
        words = np.diff(np.searchsorted(at, ends))
        lines = np.repeat(np.arange(count), words)
        columns = self._sorted(marks[at].astype(np.intp) - 1, numbers)
        cells = columns * count + lines
        values.reshape(-1)[cells] = numbers
        present.reshape(-1)[cells] = True
        special[lines[np.abs(numbers) > VALUE_LIMIT]] = True
        if not self.dialect.parameters:
            bare[lines[self._lengths[columns] & (numbers != 0.0) & ~_with_point(classes, at)]] = True
        else:  # the line number stands first
            special[lines[1:][(columns[1:] == self.column["N"]) & (lines[1:] == lines[:-1])]] = True
        number = values[self.column["N"]]
        special |= (present.sum(axis=0) != words) | present[self.column["other G"]]
        special |= (number < 0.0) | (number != np.floor(number)) | (number > 99_999_999)
        return Scan(text, ends, special, values, present, bare)

    def _sorted(self, columns: NDArray, numbers: NDArray) -> NDArray:
        """The columns with G words sorted into their groups; the numbers of G words become whole codes."""
        words = np.flatnonzero(columns == self.column["other G"])
        given = 10.0 * numbers[words]
        codes = np.clip(np.rint(given), 0.0, 999.0)
        known = np.abs(codes - given) < 1e-6
        columns[words] = np.where(known, self._g_columns[codes.astype(np.intp)], self.column["other G"])
        return columns


def _with_point(classes: NDArray, at: NDArray) -> NDArray[np.bool_]:
    """Of words that begin at places of the text: whether a decimal point stands before the next one."""
    points = np.flatnonzero(classes == _POINT)
    before = np.searchsorted(points, np.append(at, len(classes)))
    return before[1:] > before[:-1]


def _wrong(classes: NDArray) -> NDArray[np.integer]:
    """Characters that their followers show to be part of no plain line."""
    pairs = (classes[:-1] << 4) | classes[1:]
    found = np.flatnonzero(np.frombuffer(pairs.tobytes().translate(_JUDGEMENTS), np.uint8) != 0)
    if not len(found):
        return found
    verdict = np.frombuffer(_JUDGEMENTS, np.uint8)[pairs[found]]
    after = classes[np.minimum(found + 2, len(classes) - 1)]
    found = found[(verdict == _WRONG) | (after != _DIGIT)]
    return found + (classes[found] == _FEED)


def _blanked(text: bytes, ends: NDArray, special: NDArray) -> bytes | bytearray:
    """The text with special lines made blank."""
    rows = np.flatnonzero(special)
    if not len(rows):
        return text
    cleaned = bytearray(text)
    for start, end in zip((ends[rows] + 1).tolist(), ends[rows + 1].tolist(), strict=True):
        cleaned[start:end] = b" " * (end - start)
    return cleaned


def _numbers(text: bytes | bytearray, count: int) -> NDArray[np.floating] | None:
    """The numbers of the text as ``float`` reads them; None where there are not ``count`` of them."""
    if count == 0:
        return np.zeros(0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        try:
            numbers = np.fromstring(bytes(text.translate(_NUMBERS)), sep=" ")
        except ValueError:
            return None
    return numbers if len(numbers) == count else None


def _table(entries: dict[str, int]) -> bytes:
    """A translation of bytes, upper and lower case alike; all others become 0."""
    table = bytearray(256)
    for char, entry in entries.items():
        table[ord(char)] = table[ord(char.lower())] = entry
    return bytes(table)


def _classes(letters: list[str]) -> bytes:
    """The class of every byte."""
    kinds = {" \t": _BLANK, "\n": _FEED, ";": _SEMICOLON, "\r": _RETURN, ".": _POINT, "+-": _SIGN,
             "0123456789": _DIGIT, "".join(letters): _LETTER}  # fmt: skip
    return _table({char: kind for chars, kind in kinds.items() for char in chars})


def _judge(first: int, second: int) -> int:
    if second not in _FOLLOWERS.get(first, ()):
        return _WRONG
    return _LEADING_POINT if second == _POINT and first != _DIGIT else 0


_JUDGEMENTS = bytes(_judge(pair >> 4, pair & 15) for pair in range(256))
