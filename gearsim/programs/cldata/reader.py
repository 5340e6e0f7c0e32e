"""CL data read: the modal language, statement by statement, into paths."""

from __future__ import annotations

import re
from collections.abc import Callable
from math import nan
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, read_input_bytes
from gearsim.programs.cldata.cutter import read_cutter
from gearsim.programs.cldata.feed import Feed, Spindle, read_feed, read_spindle
from gearsim.programs.cldata.frame import ToolAxis, Units, require_identity
from gearsim.programs.cldata.lexer import MOVES_WITHIN, Statement, statements
from gearsim.programs.cldata.notes import Notes
from gearsim.programs.cldata.numbers import numbers
from gearsim.programs.cldata.program import RAPID, UNNAMED, CLPath, CLProgram
from gearsim.programs.cldata.tools import ToolChanges
from gearsim.programs.cldata.words import FOR_THE_MACHINE, MOTION, TOOL_DATA, is_read, supported, unknown_words

_PASS = re.compile(r"['\"]?PASS\s+([A-Z0-9_.-]+)['\"]?", re.I)
_LIKE_PASS = re.compile(r"['\"]?PASS\b", re.I)
_POINT = "x,y,z or {}/x,y,z,i,j,k"


def read_cl_text(file: Path) -> str:
    """The text of a CL file; comments may be in any encoding. Raises InputError where it cannot be read."""
    data = read_input_bytes(file, "CL file")
    try:
        return data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def parse_cl(text: str, name: str = "CL data") -> CLProgram:
    """Read CL data; ``name`` stands in the messages.

    Lengths and feeds in inches are converted. Raises InputError naming line and word for anything it cannot use; all
    words that are not read are told at once.
    """
    reader = _Reader(name)
    found = statements(text, name)
    reader.require_known(found)
    for statement in found:
        try:
            reader.take(statement)
        except InputError as error:
            raise InputError(f"{name}, line {statement.line}: {error}") from error
    return reader.program()


class _Reader:
    """State of the modal CL language while it is read."""

    def __init__(self, name: str):
        self.name = name
        self.units, self.axis, self.tool, self.notes = Units(), ToolAxis(), ToolChanges(), Notes()
        self.rapid = False
        self.label = UNNAMED
        self.named: dict[str, int] = {}
        self.stated: Feed | None = None
        self.spindle = Spindle()
        self.feeds: list[float] = []
        self.at: tuple[NDArray, NDArray] | None = None
        self.line = 0  # where ``at`` is stated
        self.moves: list[tuple[tuple[str, int], list[NDArray], list[NDArray], list[int], list[float], list[float]]] = []
        self.ended: Statement | None = None
        self._take: dict[str, Callable[[Statement], None]] = {
            "GOTO": self._goto, "FROM": self._goto, "GODLTA": self._by, "RAPID": self._rapid,
            "FEDRAT": self._fedrat, "SPINDL": self._spindl, "UNITS": self._units, "UNIT": self._units,
            "MULTAX": lambda s: self.axis.multax(s.rest), "TLAXIS": lambda s: self.axis.tlaxis(s.rest),
            "CSYS": lambda s: require_identity(s.rest), "CUTTER": self._cutter, "END": self._end, "FINI": self._end,
            **dict.fromkeys(("LOADTL", "TOOLNO", "LOAD", "SELECT"), lambda s: self.tool.takes_number(s)),
        }  # fmt: skip

    def require_known(self, found: list[Statement]) -> None:
        """Refuse words that are not read, all at once. What stands behind the end without a slash is told only."""
        strange, ended = [], False
        for s in found:
            ended = ended or s.word in ("END", "FINI")
            if s.text or is_read(s.word, s.rest):
                continue
            if ended and not s.slash:
                self.notes.behind_the_end(s)
            else:
                strange.append((s.word or str(s).removeprefix("/"), s.line))
        if strange:
            raise InputError(f"{self.name}, {unknown_words(strange)}; supported are {supported()}")

    def take(self, s: Statement) -> None:
        if s.text:
            self._text(s)
        elif s.word in self._take:
            if self.ended and s.word in (*MOTION, "RAPID"):
                raise InputError(f"{s} behind {self.ended.word} of line {self.ended.line}, where the program ends")
            self._take[s.word](s)
        elif "/" in s.rest:
            raise InputError(f"{s}: a second '/'; each statement needs a line of its own")
        elif s.word in TOOL_DATA:
            self.notes.not_used(s)

    def _text(self, s: Statement) -> None:
        if s.word in FOR_THE_MACHINE:
            self.notes.for_the_machine(s)
        if MOVES_WITHIN.search(s.rest):
            self.notes.move_in_text(s)
        if s.word != "PPRINT" or not _LIKE_PASS.match(s.rest):
            return
        if named := _PASS.fullmatch(s.rest):
            self.label = named[1].lower()
            if self.label == RAPID:
                raise InputError("a pass cannot be called 'rapid'; that names moves at rapid rate")
            self.named.setdefault(self.label, s.line)
        else:
            self.notes.no_pass_name(s)

    def _end(self, s: Statement) -> None:
        self.ended = s

    def _rapid(self, s: Statement) -> None:
        if s.rest:
            raise InputError(f"{s}: which way such a rapid move takes is not known; expected RAPID alone")
        self.rapid = True

    def _units(self, s: Statement) -> None:
        self.units.state(s)

    def _cutter(self, s: Statement) -> None:
        self.tool.takes_sizes(s, read_cutter(s.line, s.rest, self.units.take()))

    def _fedrat(self, s: Statement) -> None:
        self.stated = read_feed(s.line, s.rest, self.units.unit, self.stated)
        if self.stated.in_file_unit:
            self.units.take()
        if self.stated.kind == "inverse":
            self.notes.inverse(s)

    def _spindl(self, s: Statement) -> None:
        self.spindle = read_spindle(s.line, s.rest, self.spindle)

    def _goto(self, s: Statement) -> None:
        form = f"{s.word}/" + _POINT.format(s.word)
        values = numbers(s.rest, (3, 6), form, self.units.take(), 3)
        self._reach(s, np.array(values[:3]), self.axis.of(values[3:]))

    def _by(self, s: Statement) -> None:
        if self.at is None:
            raise InputError(f"{s} before the first point; GOTO or FROM states it")
        change = numbers(s.rest, (3,), "GODLTA/x,y,z", self.units.take(), 3)
        self._reach(s, self.at[0] + change, self.axis.of([]))

    def _reach(self, s: Statement, tip: NDArray, axis: NDArray) -> None:
        if s.word != "FROM":
            tool = self.tool.moves(s.line)
            if self.at is not None:
                self._move(s, tip, axis, tool)
            self.rapid = False
        elif self.at is not None and not (np.array_equal(tip, self.at[0]) and np.array_equal(axis, self.at[1])):
            self.notes.set_elsewhere(s)
        self.at, self.line = (tip, axis), s.line

    def _move(self, s: Statement, tip: NDArray, axis: NDArray, tool: int) -> None:
        assert self.at is not None
        if np.array_equal(tip, self.at[0]) and np.array_equal(axis, self.at[1]):
            return
        label = (RAPID if self.rapid else self.label, tool)
        if not (self.moves and self.moves[-1][0] == label and self._at_end_of(*self.moves[-1][1:3])):
            self.moves.append((label, [self.at[0]], [self.at[1]], [self.line], [nan], []))
        _, tips, axes, lines, seconds, feeds = self.moves[-1]
        tips.append(tip)
        axes.append(axis)
        lines.append(s.line)
        took, feed = (nan, 0.0) if self.rapid else self._feed_in(s, tip - self.at[0])
        seconds.append(took)
        feeds += [feed] * (feed > 0.0)

    def _at_end_of(self, tips: list[NDArray], axes: list[NDArray]) -> bool:
        assert self.at is not None
        return np.array_equal(tips[-1], self.at[0]) and np.array_equal(axes[-1], self.at[1])

    def _feed_in(self, s: Statement, way: NDArray) -> tuple[float, float]:
        """Take note of the feed in a cutting move; how long [s] it takes (nan: no feed says it), and the feed [mm/min].

        Where the tip stands still, its speed says nothing: 0.
        """
        if self.stated is None:
            self.notes.without_feed(s)
            return nan, 0.0
        length = float(np.linalg.norm(way))
        feed = self.stated.mm_min(length, self.spindle)
        if feed > 0.0:
            self.feeds = [min(feed, *self.feeds), max(feed, *self.feeds)] if self.feeds else [feed, feed]
        return self.stated.seconds(length, self.spindle), feed

    def program(self) -> CLProgram:
        if not any(name != RAPID for (name, _), *_ in self.moves):
            raise InputError(f"{self.name}: no cutting moves; a path needs at least two GOTO points")
        paths = tuple(
            CLPath(name, np.array(tips), np.array(axes), k, tuple(lines), tuple(seconds), min(feeds, default=None))
            for (name, k), tips, axes, lines, seconds, feeds in self.moves
        )
        self.notes.units(self.units, paths, self.tool.used)
        slowest, fastest = self.feeds or (None, None)
        speed = None if self.spindle.last is None else float(self.spindle.last)
        notes = self.notes.told(slowest)
        return CLProgram(paths, self.tool.used, slowest, fastest, speed, tuple(self.named.items()), notes)
