"""Runs through a program's lines: plain ones in vector form, all others one by one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearsim.machines.chain import Machine
from gearsim.programs.blocks import Blocks
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import ProgramError
from gearsim.programs.gcode.flow import Flow, has_flow
from gearsim.programs.gcode.interpreter import Interpreter
from gearsim.programs.gcode.journal import Journal
from gearsim.programs.gcode.moves import RAPID, Arc
from gearsim.programs.gcode.plain import PlainRun
from gearsim.programs.gcode.recorder import Recorder
from gearsim.programs.gcode.scan import Scan, Scanner
from gearsim.programs.gcode.settings import ReadSettings
from gearsim.programs.gcode.text import Text, as_line

SHORT = 32  # runs up to this length are faster line by line
_FIRST_WIDTH = 256  # lines tried at once behind a line that was not plain


class Reader:
    """One reading of one program."""

    def __init__(
        self, text: Text, machine: Machine, dialect: Dialect, settings: ReadSettings,
        progress: Callable[[int], None] | None,
    ):  # fmt: skip
        self.text, self.progress = text, progress
        self.journal = Journal()
        self.scanner = Scanner(machine.axes, dialect)
        rules = dialect.arcs.with_centre(settings.arc_tolerance)
        self.recorder = Recorder(machine, rules, dialect.feed_of_all_axes, text.line)
        self.interpreter = Interpreter(machine, dialect, settings, self.journal, self._emit)

    def read(self) -> tuple[Blocks, Journal]:
        """The program's blocks. Raises ProgramError for the first error in it."""
        start = self.interpreter.state.position
        try:
            self._run()
        except ProgramError:
            self.recorder.flush()  # an earlier move may be wrong, too: then this raises
            raise
        if not self.interpreter.has_words:
            raise ProgramError(self.text.name, 1, 1, "", "the program is empty; expected at least one word")
        self.journal.has_end = self.interpreter.ended or not self.interpreter.dialect.parameters
        return self.recorder.blocks(start), self.journal

    def _run(self) -> None:
        expressions = self.interpreter.values
        if expressions is not None and has_flow(self.text.data):
            Flow(self.text.lines(), self.interpreter, expressions, self.interpreter.settings.block_limit).run()
        else:
            self._run_pieces()

    def _run_pieces(self) -> None:
        number = 1
        for piece in self.text.pieces():
            scan = self.scanner.scan(piece)
            if self.interpreter.settings.least_increment:
                scan.special[:] |= scan.bare
            self._piece(scan, number)
            number += len(scan.special)
            if self.progress is not None:
                self.progress(len(scan.special))
            if self.interpreter.ended:
                break

    def _piece(self, scan: Scan, number: int) -> None:
        """Run the lines of a scan, the first of which has the given number."""
        special = np.append(np.flatnonzero(scan.special), len(scan.special))
        i, width = 0, _FIRST_WIDTH
        while i < len(scan.special) and not self.interpreter.ended:
            stop = int(special[np.searchsorted(special, i)])
            singles = stop + 1 - i
            if singles > SHORT:
                done = self._plain(scan, number, i, min(stop, i + width))
                complete = i + done == min(stop, i + width)
                i, width = i + done, 2 * width if complete else _FIRST_WIDTH
                singles = 0 if complete else 1 if done > SHORT else SHORT
            for k in range(i, min(i + singles, len(scan.special))):
                self.interpreter.line(as_line(self.text.name, number + k, scan.raw(k)))
                i = k + 1
                if self.interpreter.ended:
                    break

    def _plain(self, scan: Scan, number: int, first: int, last: int) -> int:
        """Run plain lines in vector form; how many could be."""
        run = PlainRun(scan, self.scanner.column, self.interpreter.state, first, last)
        bare = np.flatnonzero(scan.bare[first : first + run.count])
        if len(bare):
            self.journal.without_point(number + first + int(bare[0]), 0.0)
        moves = run.moves(number + first)
        if moves is not None:
            self.journal.move(bool((moves.motion != RAPID).any()))
            self.recorder.take(moves)
        self.interpreter.has_words = self.interpreter.has_words or bool(
            scan.present[:, first : first + run.count].any()
        )
        return run.count

    def _emit(self, line: int, before: list[float], motion: int, feed: float, arc: Arc) -> None:
        state = self.interpreter.state
        self.journal.move(motion != RAPID)
        self.recorder.add(state.mode, before, state.position, motion, feed, arc, line)
