"""The modal interpreter: one line after the other changes the state and makes moves.

Within a block the order is: units, feed mode, F, S, T, M6, spindle, plane, tool length, work offset, distance
mode, then dwell, offsets or motion, and last the end of the program, wherever the words stand in the line.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi

from gearsim.machines.chain import Machine
from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.expressions import Expressions
from gearsim.programs.gcode.finish import MoveError
from gearsim.programs.gcode.journal import Journal
from gearsim.programs.gcode.lexer import Word, lex
from gearsim.programs.gcode.motion_words import Arc, arc_words, check_feed
from gearsim.programs.gcode.moves import CLOCKWISE, DWELL, FEED, NO_ARC, RAPID
from gearsim.programs.gcode.parameters import Parameters
from gearsim.programs.gcode.settings import ReadSettings
from gearsim.programs.gcode.state import INCH, State

DEGREE = pi / 180.0
LEAST_FEED = 1e-6
Emit = Callable[[int, list[float], int, float, Arc], None]


class Interpreter:
    """Reads lines in their order; ``emit(line, before, motion, feed, arc)`` takes moves to ``state.position``."""

    def __init__(self, machine: Machine, dialect: Dialect, settings: ReadSettings, journal: Journal, emit: Emit):
        self.dialect, self.settings, self.journal, self.emit = dialect, settings, journal, emit
        self.state = State(machine, dialect, settings)
        self.values = Expressions(Parameters()) if dialect.parameters else None
        self.ended = False
        self.has_words = False
        self._has_begun = False
        self.axes = machine.axes
        self._column = {name: i for i, name in enumerate(machine.axes)}
        self._rotary = [joint.is_rotary for joint in machine.joints]

    def line(self, line: Line) -> None:
        """Run a line. Raises ProgramError for what it cannot use."""
        if line.text.strip() == "%":
            self.ended = self.has_words or self._has_begun
            self._has_begun = True
            return
        if self.settings.block_delete and line.text.lstrip().startswith("/"):
            return
        statement = lex(line, self.dialect, self.values)
        if self.values is not None:
            self.values.commit()
        self.has_words = self.has_words or bool(statement.words)
        block = Block(line, statement.words, self.dialect, self.axes)
        self.journal.note(block, statement.comments, self.state)
        if statement.words:
            self._run(block)

    def _run(self, block: Block) -> None:
        for letter in "NOD":
            word = None if letter in self.axes else block.take(letter)
            if word is not None:
                block.whole(word)
        self._units_and_feed(block)
        self._tool(block)
        self._modes(block)
        code, word = block.g.get("one block", (None, None))
        moves = {40: self._dwell, 280: self._home, 520: self._local, 920: self._shift_here, 921: self._shift_back}
        motion = block.g.get("motion")
        if motion is not None:
            self.state.motion = None if motion[0] == 800 else motion[0] // 10
        if word is not None and code is not None and code != 530:
            if motion is not None and block.axes and self.dialect.axis_words_once:
                raise block.error(motion[1], f"G{code / 10:g} and G{motion[0] / 10:g} both want the axis words")
            moves[code](block, word)
        elif block.axes or any(letter in block.letters for letter in "IJKR"):
            self._move(block, word)
        elif word is not None:
            raise block.error(word, "axis words are missing")
        block.check_all_taken()
        code, word = block.m.get("stop", (None, None))
        self.ended = self.ended or code in (2, 30)

    def _units_and_feed(self, block: Block) -> None:
        state = self.state
        if "units" in block.g:
            state.scale = INCH if block.g["units"][0] == 200 else 1.0
        if "feed" in block.g:
            mode = block.g["feed"][0] // 10
            state.feed = state.feed if mode == state.feed_mode else None
            state.feed_mode = mode
        feed = block.take("F")
        if feed is not None:
            if feed.value < LEAST_FEED:
                raise block.error(feed, "a feed is above 0")
            state.feed = feed.value
        speed = block.take("S")
        if speed is not None:
            if speed.value < 0.0:
                raise block.error(speed, "a spindle speed is not negative")
            state.spindle = speed.value

    def _tool(self, block: Block) -> None:
        state, offsets, word = self.state, self.state.offsets, block.take("T")
        if word is not None:
            state.next_tool = block.whole(word)
        if "tool change" not in block.m:
            return
        change = block.m["tool change"][1]
        if state.next_tool is None:
            raise block.error(change, "no tool is called; T is missing")
        if state.tip:
            raise block.error(change, "tool centre point control is on; switch it off by G49 before")
        length = self._length(block, change if word is None else word, state.next_tool)
        state.tool = state.next_tool
        self.journal.tool_change(block, state)
        if length != offsets.length:
            before = offsets.excess
            offsets.length = length
            if "Z" in self._column:
                state.refer()
                target = state.position[:]
                target[self._column["Z"]] += offsets.excess - before
                self._rapid_to(block, target)

    def _length(self, block: Block, word: Word, number: int) -> float:
        lengths = self.settings.tool_lengths
        if lengths and number and number not in lengths:
            known = ", ".join(str(n) for n in sorted(lengths))
            raise block.error(word, f"the settings have no length for tool {number}; they have {known}")
        return lengths.get(number, 0.0) if number else 0.0

    def _modes(self, block: Block) -> None:
        state = self.state
        for group, (code, word) in block.g.items():
            for letter in self.dialect.along.get(code, ""):
                block.take(letter)
            if group == "plane":
                state.plane = code // 10
            elif group == "distance":
                state.absolute = code == 900
            elif group == "arc distance":
                state.arc_absolute = code == 901
            elif group == "tool length":
                self._tool_length(block, code, word)
            elif group == "work offset":
                self._work_offset(block, code, word)

    def _tool_length(self, block: Block, code: int, word: Word) -> None:
        state = self.state
        if code == 490:
            register = block.take("H")
            if register is not None:
                block.whole(register)
            self._compensate(block, word, 0.0, False)
            return
        if "Z" not in self._column:
            raise block.error(word, "the machine has no axis Z that a tool length could be compensated by")
        if code == 434 and (self.axes[:3] != ("X", "Y", "Z") or sum(self._rotary) != len(self.axes) - 3):
            raise block.error(word, f"tool centre point control needs slides X, Y, Z; there are {', '.join(self.axes)}")
        by_tool = self.dialect.tool_length_of_tool and "H" not in block.letters
        register = word if by_tool else block.need("H", word, "the number of the tool length")
        number = state.tool if by_tool else block.whole(register)
        self._compensate(block, word, self._length(block, register, number), code == 434)

    def _compensate(self, block: Block, word: Word, length: float, tip: bool) -> None:
        try:
            self.state.compensate(length, tip)
        except MoveError as error:
            raise block.error(word, error.reason) from error

    def _work_offset(self, block: Block, code: int, word: Word) -> None:
        name = f"G{code / 10:g}"
        if code == 541:
            number = block.need("P", word, "the number of the work offset")
            if not 1 <= block.whole(number) <= 300:
                raise block.error(number, "additional work offsets are P1 to P300")
            name += f" P{int(number.value)}"
        self.state.offsets.active = name
        self.state.refer()

    def _dwell(self, block: Block, word: Word) -> None:
        letters = "XP" if self.dialect.dwell_unit < 1.0 else "P"
        found = [time for time in map(block.take, letters) if time is not None]
        if len(found) != 1:
            raise block.error(word, f"one time to wait is expected, behind {' or '.join(letters)}")
        unit = self.dialect.dwell_unit if found[0].letter == "P" else 1.0
        others = [axis for letter, axis in block.axes.items() if letter != found[0].letter]
        if others:
            raise block.error(others[0], "G4 moves no axis")
        if found[0].value < 0.0:
            raise block.error(found[0], "a time to wait is not negative")
        self.emit(block.line.number, self.state.position, DWELL, found[0].value * unit, NO_ARC)

    def _home(self, block: Block, word: Word) -> None:
        state = self.state
        self._refuse_tip(block, word)
        named = [self._column[letter] for letter in block.axes]
        if not named and not self.dialect.parameters:
            raise block.error(word, "the axes that go home are missing")
        self._rapid_to(block, self._target(block))
        home = state.offsets.from_machine(state.home)
        chosen = named or range(len(home))
        self._rapid_to(block, [home[i] if i in chosen else p for i, p in enumerate(state.position)])

    def _rapid_to(self, block: Block, target: list[float]) -> None:
        before, self.state.position = self.state.position, target
        if target != before:
            self.emit(block.line.number, before, RAPID, 0.0, NO_ARC)

    def _local(self, block: Block, word: Word) -> None:
        """G52: a zero of the program's own, seen from the work offset."""
        self._refuse_tip(block, word)
        if not block.axes:
            raise block.error(word, "axis words are missing")
        for letter, axis in block.axes.items():
            i = self._column[letter]
            self.state.offsets.local[i] = axis.value * self._factor(i)
        self.state.refer()

    def _shift_here(self, block: Block, word: Word) -> None:
        """G92: the place where the tool stands gets the programmed values."""
        state = self.state
        self._refuse_tip(block, word)
        if not block.axes:
            raise block.error(word, "axis words are missing")
        for letter, axis in block.axes.items():
            i = self._column[letter]
            state.offsets.shifted[i] += state.position[i] - (axis.value * self._factor(i) + state.shift[i])
        state.refer()

    def _shift_back(self, block: Block, word: Word) -> None:
        self._refuse_tip(block, word)
        self.state.offsets.shifted = [0.0] * len(self.axes)
        self.state.refer()

    def _refuse_tip(self, block: Block, word: Word) -> None:
        if self.state.tip:
            raise block.error(word, "tool centre point control is on; switch it off by G49 before")

    def _move(self, block: Block, machine_coordinates: Word | None) -> None:
        state, motion = self.state, self.state.motion
        first = next(iter(block.axes.values()), None)
        if motion is None:
            lonely = first or next(block.letters[letter] for letter in "IJKR" if letter in block.letters)
            raise block.error(lonely, "no motion is in force; G0, G1, G2 or G3 is missing")
        arc = arc_words(block, state) if motion >= CLOCKWISE else NO_ARC
        if first is None and motion < CLOCKWISE:
            block.check_all_taken()
        if motion >= FEED:
            check_feed(block, state)
        before, word = state.position, machine_coordinates
        state.position = self._target(block) if word is None else self._machine_target(block, word)
        self.emit(block.line.number, before, motion, state.feed or 0.0, arc)

    def _machine_target(self, block: Block, word: Word) -> list[float]:
        """G53: axis words are machine coordinates of the spindle nose."""
        self._refuse_tip(block, word)
        state = self.state
        if not state.absolute:
            raise block.error(word, "machine coordinates are absolute; G90 is missing")
        if state.motion not in (RAPID, FEED):
            raise block.error(word, "machine coordinates are for G0 and G1")
        stated = [0.0] * len(self.axes)
        for letter, axis in block.axes.items():
            stated[self._column[letter]] = axis.value * self._factor(self._column[letter])
        there = state.offsets.from_machine(stated)
        return [there[i] if name in block.axes else state.position[i] for i, name in enumerate(self.axes)]

    def _target(self, block: Block) -> list[float]:
        """Where the axis words lead, from the position in force."""
        state, target = self.state, self.state.position[:]
        for letter, axis in block.axes.items():
            i = self._column[letter]
            target[i] = axis.value * self._factor(i) + (state.shift[i] if state.absolute else target[i])
        return target

    def _factor(self, column: int) -> float:
        return DEGREE if self._rotary[column] else self.state.scale
