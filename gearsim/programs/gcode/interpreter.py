"""The modal interpreter: one line after the other changes the state and makes moves.

Within a block the order is: units, feed mode, F, S, T, M6, spindle, plane, tool length, work offset, distance
mode, dwell, what sets zeros or goes home, then the motion, and last the end of the program, wherever the words
stand in the line. LinuxCNC takes F before the units of its block; only beside the first of a program, of which
nobody knows what held before, F counts by the units that are stated.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

from gearsim.machines.chain import Machine
from gearsim.programs.gcode import zeros
from gearsim.programs.gcode.arc_rules import INCH
from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.expressions import Expressions
from gearsim.programs.gcode.journal import Journal
from gearsim.programs.gcode.lexer import Word, lex
from gearsim.programs.gcode.motion_words import arc_words, check_feed, dwell_seconds, feed_word, first_word
from gearsim.programs.gcode.moves import CLOCKWISE, DWELL, FEED, NO_ARC, RAPID, Arc
from gearsim.programs.gcode.parameters import Parameters
from gearsim.programs.gcode.settings import ReadSettings
from gearsim.programs.gcode.state import State
from gearsim.programs.gcode.tooling import Tooling

Emit = Callable[[int, list[float], int, float, Arc], None]
_BLOCK = re.compile(r"(?:\([^)]*\)?|[^;(])*")


class Interpreter:
    """Reads lines in their order; ``emit(line, before, motion, feed, arc)`` takes moves to ``state.position``."""

    def __init__(self, machine: Machine, dialect: Dialect, settings: ReadSettings, journal: Journal, emit: Emit):
        self.dialect, self.settings, self.journal, self.emit = dialect, settings, journal, emit
        self.state = State(machine, dialect, settings)
        self.tooling = Tooling(self.state, settings, journal, self._rapid_to)
        self.values = Expressions(Parameters()) if dialect.parameters else None
        self.ended = False
        self.has_words = False
        self._has_begun = self._has_lines = False
        self.axes = machine.axes

    def line(self, line: Line) -> None:
        """Run a line. Raises ProgramError for what it cannot use."""
        if line.text.strip() == "%":
            self._percent(line)
            return
        self._has_lines = self._has_lines or bool(line.text.strip())
        splits = self.dialect.semicolon_ends_block and ";" in line.text
        for part in _blocks(line) if splits else (line,):
            if not self.ended:
                self._block(part)

    def _block(self, line: Line) -> None:
        if self.settings.block_delete and line.text.lstrip().startswith("/"):
            return
        statement = lex(line, self.dialect, self.values)
        if self.values is not None:
            self.values.commit()
        self.has_words = self.has_words or bool(statement.words)
        block = Block(statement.line, statement.words, self.dialect, self.axes)
        self.journal.note(block, statement.comments, self.state)
        if statement.words:
            self._run(block)

    def _percent(self, line: Line) -> None:
        """The sign % begins and ends a program; LinuxCNC's second one ends only what the first one began."""
        before = self.has_words or (self._has_lines and self.dialect.parameters)
        if before and not self._has_begun and self.dialect.parameters:
            raise line.error(0, len(line.text), "the sign % ends a program that begins with it; this one does not")
        self.ended = before or self._has_begun
        self._has_begun = True

    def _run(self, block: Block) -> None:
        for letter in self.dialect.idle_letters:
            word = None if letter in self.axes else block.take(letter)
            if word is not None and (letter != "N" or not self.dialect.parameters):
                block.whole(word)
            if word is not None and letter == "D":
                self.journal.tell(
                    "D, the number of a tool's radius, is not used: the tool's centre is programmed", block
                )
        self._units_and_feed(block)
        if not self.dialect.parameters:
            self._points(block)
        self.tooling.change(block)
        self._modes(block)
        motion = block.g.get("motion")
        if motion is not None:
            self.state.motion = None if motion[0] == 800 else motion[0] // 10
        machine_coordinates = self._one_block(block)
        if "shift kept" in block.g:
            zeros.shift_kept(block, *block.g["shift kept"], self.state)
        self._motion(block, machine_coordinates)
        block.check_all_taken()
        code, _ = block.m.get("stop", (None, None))
        self.ended = self.ended or code in (2, 30)

    def _units_and_feed(self, block: Block) -> None:
        state = self.state
        feed_scale = state.scale if state.has_units and self.dialect.feed_before_units else None
        if "units" in block.g:
            state.scale, state.has_units = INCH if block.g["units"][0] == 200 else 1.0, True
        if "feed" in block.g:
            mode = block.g["feed"][0] // 10
            kept = mode == state.feed_mode and not self.dialect.feed_mode_clears_feed
            state.feed = state.feed if kept else None
            state.feed_mode = mode
        feed = feed_word(block)
        if feed is not None:
            state.feed, state.feed_scale = feed, feed_scale or state.scale
        speed = block.take("S")
        if speed is not None:
            if speed.value < 0.0:
                raise block.error(speed, "a spindle speed is not negative")
            state.spindle = speed.value

    def _points(self, block: Block) -> None:
        """Numbers without a decimal point: told once, and counted in least increments where the settings say so."""
        increment, bare = self.settings.least_increment, block.without_point()
        if bare:
            self.journal.without_point(block.line.number, increment)
        for letter in bare if increment else ():
            column = self.state.column.get(letter)
            is_length = column is None or not self.state.machine.joints[column].is_rotary
            block.scale(letter, 0.1 * increment if is_length and self.state.scale != 1.0 else increment)

    def _modes(self, block: Block) -> None:
        state = self.state
        along = [self.dialect.along.get(code, "") for code, _ in block.g.values()]
        along += [self.dialect.m_along.get(code, "") for code, _ in block.m.values()]
        for letter in "".join(along):
            block.take(letter)
        for group, (code, word) in block.g.items():
            if group == "plane":
                state.plane = code // 10
            elif group == "distance":
                state.absolute = code == 900
            elif group == "arc distance":
                state.arc_absolute = code == 901
            elif group == "tool length":
                self.tooling.length(block, code, word)
            elif group == "work offset":
                zeros.work_offset(block, code, word, state)
                if not state.offsets.is_known():
                    self.journal.assume(f"{state.offsets.active} has no place in the settings, zero", block)

    def _one_block(self, block: Block) -> Word | None:
        """What holds for one block only, but for the motion; the word of G53, which says how that is meant."""
        owners = [(code, word) for code, word in block.g.values() if code in self.dialect.own_axes]
        motion = block.g.get("motion")
        for code, word in owners:
            if motion is not None and motion[0] != 800 and self.dialect.axis_words_once:
                raise block.error(motion[1], f"G{code / 10:g} and G{motion[0] / 10:g} both want the axis words")
            if code != owners[0][0]:
                reason = f"G{code / 10:g} and G{owners[0][0] / 10:g} both want the axis words; give each its own block"
                raise block.error(word, reason)
        if "one block" not in block.g:
            return None
        code, word = block.g["one block"]
        if code == 530:
            if owners:
                raise block.error(word, f"G53 and G{owners[0][0] / 10:g} both want the axis words")
            return word
        if code == 40:
            self._dwell(block, word)
        elif code == 280:
            self._home(block, word)
        elif code == 520:
            zeros.local(block, word, self.state)
        else:
            self._set_zero(block, word, code)
        return None

    def _set_zero(self, block: Block, word: Word, code: int) -> None:
        state = self.state
        if zeros.is_where_it_stands(block, code, state):
            state.placing.check_zero(block, word, state.stated(block))
        elif state.absolute or not self.dialect.incremental_tables:
            state.placing.check_table(block, word)
        (zeros.shift_here if code == 920 else zeros.table)(block, word, state)

    def _dwell(self, block: Block, word: Word) -> None:
        seconds = dwell_seconds(block, word, self.dialect)
        self.emit(block.line.number, self.state.position, DWELL, seconds, NO_ARC)

    def _home(self, block: Block, word: Word) -> None:
        state = self.state
        zeros.refuse_tip(block, word, state)
        named = state.stated(block)
        if not named and not self.dialect.parameters:
            raise block.error(word, "the axes that go home are missing")
        if named and state.absolute:
            state.placing.check_move(block, word, named, True, state.offsets)
        self._rapid_to(block, state.target(named))
        home = state.offsets.from_machine(state.home)
        chosen = named or range(len(home))
        state.placing.leave(chosen)
        self._rapid_to(block, [home[i] if i in chosen else p for i, p in enumerate(state.position)])

    def _rapid_to(self, block: Block, target: list[float]) -> None:
        before, self.state.position = self.state.position, target
        if target != before:
            self.emit(block.line.number, before, RAPID, 0.0, NO_ARC)

    def _motion(self, block: Block, machine_coordinates: Word | None) -> None:
        """The motion of a block, if it has one: axis words of other codes move nothing."""
        if any(code in self.dialect.own_axes for code, _ in block.g.values()):
            block.take_axes()
            return
        words = block.open_axes or any(block.is_open(letter) for letter in "IJKR")
        explicit = "motion" in block.g and self.state.motion is not None and self.dialect.moves_at_code
        if words or (explicit and self.state.motion != RAPID):
            self._move(block, machine_coordinates)
        elif machine_coordinates is not None:
            raise block.error(machine_coordinates, "axis words are missing")

    def _move(self, block: Block, machine_coordinates: Word | None) -> None:
        state, motion, word = self.state, self.state.motion, first_word(block)
        if motion is None:
            lonely = next(w for letter, w in block.letters.items() if letter in block.axes or letter in "IJKR")
            raise block.error(lonely, "no motion is in force; G0, G1, G2 or G3 is missing")
        if block.axes and not block.open_axes:
            raise block.error(word, "the axis words are taken already; a motion stands in a block of its own")
        arc = arc_words(block, state) if motion >= CLOCKWISE else NO_ARC
        block.take_axes()
        if motion < CLOCKWISE:
            block.check_all_taken()
        if motion >= FEED:
            check_feed(block, state)
        before, columns = state.position, state.stated(block)
        if machine_coordinates is None:
            state.placing.check_move(block, word, columns, state.absolute, state.offsets)
            target = state.target(columns)
        else:
            target = self._machine_target(block, machine_coordinates)
            state.placing.leave(columns)
        if motion >= FEED:
            state.placing.check_cut(block, word)
        if columns or motion >= CLOCKWISE:
            state.position = target
            self.emit(block.line.number, before, motion, state.feed or 0.0, arc)

    def _machine_target(self, block: Block, word: Word) -> list[float]:
        """G53: axis words are machine coordinates of the spindle nose."""
        state = self.state
        zeros.refuse_tip(block, word, state)
        if not state.absolute:
            raise block.error(word, "machine coordinates are absolute; G90 is missing")
        if state.motion not in (RAPID, FEED):
            raise block.error(word, "machine coordinates are for G0 and G1")
        named = state.stated(block)
        there = state.offsets.from_machine([named.get(i, 0.0) for i in range(len(self.axes))])
        return [there[i] if i in named else p for i, p in enumerate(state.position)]


def _blocks(line: Line) -> Iterator[Line]:
    """The blocks of a line between semicolons outside of comments; columns stay, what is not theirs is blank."""
    text, at = line.text, 0
    while at <= len(text):
        found = _BLOCK.match(text, at)
        end = found.end() if found else len(text)
        if at == 0 or text[at:end].strip():
            yield Line(line.source, line.number, " " * at + text[at:end])
        at = end + 1
