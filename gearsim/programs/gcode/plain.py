"""Runs of plain lines in vector form: modal words filled forward, positions, one batch of moves."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from gearsim.programs.gcode.arcs import OFFSET_LETTERS
from gearsim.programs.gcode.motion_words import LEAST_FEED
from gearsim.programs.gcode.moves import CLOCKWISE, FEED, Moves
from gearsim.programs.gcode.scan import Scan
from gearsim.programs.gcode.state import State


class PlainRun:
    """The lines from ``first`` to ``last`` of a scan, for the state before them."""

    def __init__(self, scan: Scan, column: dict[str, int], state: State, first: int, last: int):
        self.state, self.column = state, column
        part = slice(first, last)
        self.values, self.present = scan.values[:, part], scan.present[:, part]
        self.motion = _filled(*self._word("motion"), -1.0 if state.motion is None else float(state.motion))
        self.feed = _filled(*self._word("F"), np.nan if state.feed is None else state.feed)
        self.moving = self._any(state.machine.axes)
        wrong = self._not_plain()
        self.count = int(np.argmax(wrong)) if wrong.any() else last - first

    def _word(self, name: str) -> tuple[NDArray, NDArray]:
        return self.values[self.column[name]], self.present[self.column[name]]

    def _not_plain(self) -> NDArray[np.bool_]:
        """Lines that change the mode all lines of a run share, or that only the interpreter may judge."""
        state = self.state
        feed, has_feed = self._word("F")
        wrong = has_feed & ((feed < LEAST_FEED) | (state.feed_scale != state.scale))
        for name, code in (("distance", 90 if state.absolute else 91), ("feed mode", state.feed_mode)):
            given, stated = self._word(name)
            wrong |= stated & (given != code)
        if state.dialect.feed_mode_clears_feed and state.feed_mode != 93:
            wrong |= self._word("feed mode")[1]
        wrong |= self._bare_motion() | (
            self.moving & ((self.motion < 0.0) | (not state.placing.is_ready(state.offsets)))
        )
        cutting = self.moving & (self.motion >= FEED)
        self._arcs = self._find_arcs()
        if self._arcs is not None:
            words, judged = self._arcs
            wrong |= judged
            cutting |= words & (self.motion >= FEED)
            self.moving = self.moving | words
        wrong |= cutting & (~has_feed if state.feed_mode == 93 else np.isnan(self.feed))
        if state.feed_mode == 95 and state.spindle == 0.0:
            wrong |= cutting
        return wrong

    def _any(self, letters: Iterable[str]) -> NDArray[np.bool_]:
        """Lines that have a word with one of the letters."""
        return np.asarray(self.present[[self.column[letter] for letter in letters]].any(axis=0))

    def _bare_motion(self) -> NDArray[np.bool_]:
        """Lines with a code of motion alone, where the dialect judges it."""
        judges = self.state.dialect.moves_at_code
        return self._word("motion")[1] & ~self.moving & (self.motion != 0.0) & judges

    def _find_arcs(self) -> tuple[NDArray, NDArray] | None:
        """Lines with words of an arc, and those that are wrong as arcs; None where there are no arcs."""
        state = self.state
        turning = self.motion >= CLOCKWISE
        some = self._any("IJKR")
        if not some.any() and not turning.any():
            return None
        allowed = OFFSET_LETTERS[state.plane]
        other = self._any(letter for letter in "IJK" if letter not in allowed)
        judged = (some & ~turning) | (turning & (other | (self._any(allowed) & self._any("R"))))
        judged |= turning & self.moving & ~some
        if state.arc_absolute:
            judged |= (
                turning & ~self.present[[self.column[letter] for letter in allowed]].all(axis=0) & ~self._word("R")[1]
            )
        if state.tip or state.machine.axes[:3] != ("X", "Y", "Z"):
            judged |= turning & (self.moving | some)
        return some, judged

    def moves(self, line: int) -> Moves | None:
        """The moves of the run's first ``count`` lines, ``line`` the first one's number; the state goes along."""
        state, rows = self.state, np.flatnonzero(self.moving[: self.count])
        if self.count:
            motion, feed = self.motion[self.count - 1], self.feed[self.count - 1]
            state.motion = None if motion < 0.0 else int(motion)
            state.feed = None if np.isnan(feed) else float(feed)
        if not len(rows):
            return None
        ends = np.stack([self._axis(i) for i in range(len(state.machine.axes))], axis=-1)
        start, state.position = np.array(state.position), ends[-1].tolist()
        motion = self.motion[rows].astype(np.int8)
        arcs = self._arc_words(rows, motion) if (motion >= CLOCKWISE).any() else None
        return Moves(state.mode, start, ends[rows], motion, self.feed[rows], arcs, line + rows)

    def _axis(self, i: int) -> NDArray[np.floating]:
        """One axis after each line: the same sums and products as the interpreter's."""
        state, stated = self.state, self.present[i, : self.count]
        words = self.values[i, : self.count] * state.factor(i)
        if state.absolute:
            return _filled(words + state.shift[i], stated, state.position[i])
        return np.cumsum(np.concatenate([[state.position[i]], np.where(stated, words, 0.0)]))[1:]

    def _arc_words(self, rows: NDArray, motion: NDArray) -> NDArray[np.floating]:
        """I, J, K, R [mm] of the moves, nan where absent, and one turn."""
        state, columns = self.state, [self.column[letter] for letter in "IJKR"]
        words = np.where(self.present[columns], self.values[columns] * state.scale, np.nan)[:, rows].T
        if state.arc_absolute:
            words[:, :3] += state.shift[:3]
        words[motion < CLOCKWISE] = np.nan
        return np.column_stack([words, np.ones(len(rows))])


def _filled(values: NDArray, present: NDArray, before: float) -> NDArray[np.floating]:
    """The values where present, else the last one, at first ``before``."""
    if not present.any():
        return np.full(len(values), before)
    if present.all():
        return values
    last = np.maximum.accumulate(np.where(present, np.arange(1, len(values) + 1), 0))
    return np.concatenate([[before], values])[last]
