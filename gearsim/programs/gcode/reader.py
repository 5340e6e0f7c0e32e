"""Runs through a program's lines: plain ones in vector form, all others one by one."""

from __future__ import annotations

from collections.abc import Callable

from gearsim.machines.chain import Machine
from gearsim.programs.blocks import Blocks
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import ProgramError
from gearsim.programs.gcode.interpreter import Arc, Interpreter
from gearsim.programs.gcode.journal import Journal
from gearsim.programs.gcode.moves import RAPID
from gearsim.programs.gcode.recorder import Recorder
from gearsim.programs.gcode.settings import ReadSettings
from gearsim.programs.gcode.text import Text


class Reader:
    """One reading of one program."""

    def __init__(
        self, text: Text, machine: Machine, dialect: Dialect, settings: ReadSettings,
        progress: Callable[[int], None] | None,
    ):  # fmt: skip
        self.text, self.progress = text, progress
        self.journal = Journal()
        self.recorder = Recorder(machine, settings.arc_tolerance, dialect.feed_of_all_axes, text.line)
        self.interpreter = Interpreter(machine, dialect, settings, self.journal, self._emit)

    def read(self) -> tuple[Blocks, Journal]:
        """The program's blocks. Raises ProgramError for the first error in it."""
        start = self.interpreter.state.position
        try:
            self._run()
        except ProgramError:
            self.recorder.flush()  # an earlier move may be wrong, too: then this raises
            raise
        if not self.interpreter.begun:
            raise ProgramError(self.text.name, 1, 1, "", "the program is empty; expected at least one word")
        return self.recorder.blocks(start), self.journal

    def _run(self) -> None:
        for line in self.text.lines():
            if self.interpreter.ended:
                break
            self.interpreter.line(line)

    def _emit(self, line: int, before: list[float], motion: int, feed: float, arc: Arc) -> None:
        state = self.interpreter.state
        self.journal.move(motion != RAPID)
        self.recorder.add(state.mode, before, state.position, motion, feed, arc, line)
