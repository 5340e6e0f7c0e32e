"""Tool changes and the compensation of tool lengths."""

from __future__ import annotations

from collections.abc import Callable

from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.finish import MoveError
from gearsim.programs.gcode.journal import Journal
from gearsim.programs.gcode.lexer import Word
from gearsim.programs.gcode.settings import ReadSettings
from gearsim.programs.gcode.state import State

RapidTo = Callable[[Block, list[float]], None]


class Tooling:
    """Runs T, M6, G43 and its like, and G49; ``rapid_to`` makes the rapid of a longer or shorter tool's tip."""

    def __init__(self, state: State, settings: ReadSettings, journal: Journal, rapid_to: RapidTo):
        self.state, self.settings, self.journal, self.rapid_to = state, settings, journal, rapid_to

    def change(self, block: Block) -> None:
        """T calls a tool, M6 takes it."""
        state, offsets, word = self.state, self.state.offsets, block.take("T")
        if word is not None:
            state.next_tool = block.whole(word)
            self._check_there(block, word, state.next_tool)
        if "tool change" not in block.m:
            return
        change = block.m["tool change"][1]
        if state.next_tool is None:
            raise block.error(change, "no tool is called; T is missing")
        if state.tip:
            raise block.error(change, "tool centre point control is on; switch it off by G49 before")
        length = self._length(block, word or change, state.next_tool)
        state.tool = state.next_tool
        self.journal.tool_change(block, state)
        state.placing.take_tool(state.tool)
        if length != offsets.length:
            before = offsets.excess
            offsets.length = length
            if "Z" in state.column:
                state.refer()
                target = state.position[:]
                target[state.column["Z"]] += offsets.excess - before
                self.rapid_to(block, target)

    def length(self, block: Block, code: int, word: Word) -> None:
        """G43 and its like, and G49."""
        state = self.state
        if code == 490:
            register = block.take("H") if "H" in state.dialect.length_off_letters else None
            if register is not None:
                block.whole(register)
            self._compensate(block, word, 0.0, None, False)
            return
        if "Z" not in state.column:
            raise block.error(word, "the machine has no axis Z that a tool length could be compensated by")
        if code == 431:
            self._stated(block, word)
            return
        if code == 432 and block.axes:
            raise block.error(next(iter(block.axes.values())), "G43.2 takes H or axis words, not both; H is read")
        slides = sum(not joint.is_rotary for joint in state.machine.joints)
        if code == 434 and (state.machine.axes[:3] != ("X", "Y", "Z") or slides != 3):
            there = ", ".join(state.machine.axes)
            raise block.error(word, f"tool centre point control needs slides X, Y, Z; there are {there}")
        number, register = self._register(block, code, word)
        length = self._length(block, register, number)
        if number and state.tool and number != state.tool:
            self.journal.tell(f"H{number} is compensated while T{state.tool} is in the spindle", block)
        if code == 432:
            length, number = length + state.offsets.compensated, -1
        self._compensate(block, word, length, number, code == 434)

    def _register(self, block: Block, code: int, word: Word) -> tuple[int, Word]:
        """The number whose length is taken, and the word that says so."""
        of_tool = self.state.dialect.tool_length_of_tool and code == 430
        register = block.take("H") if of_tool else block.need("H", word, "the number of the tool length")
        number = 0 if register is None else block.whole(register)
        return (self.state.tool if of_tool and number == 0 else number), (register or word)

    def _stated(self, block: Block, word: Word) -> None:
        """G43.1: the length itself, behind Z; its axis words move nothing."""
        other = next((axis for letter, axis in block.axes.items() if letter != "Z"), None)
        if other is not None and other.value != 0.0:
            raise block.error(other, "a tool offset beside its length is not read; program the tool's centre")
        length = self.state.offsets.compensated
        if "Z" in block.axes:
            length = block.axes["Z"].value * self.state.scale
        self._compensate(block, word, length, -1, False)

    def _compensate(self, block: Block, word: Word, length: float, number: int | None, tip: bool) -> None:
        try:
            self.state.compensate(length, tip)
        except MoveError as error:
            raise block.error(word, error.reason) from error
        self.state.placing.compensate(number)

    def _check_there(self, block: Block, word: Word, number: int) -> None:
        tools = self.settings.tools
        if tools is not None and number and number not in tools:
            known = ", ".join(f"T{n}" for n in sorted(tools))
            raise block.error(word, f"tool T{number} is not among the tools there are: {known}")
        if self.state.dialect.tool_length_of_tool:
            self._length(block, word, number)

    def _length(self, block: Block, word: Word, number: int) -> float:
        lengths, free = self.settings.tool_lengths, self.settings.unstated_is_zero
        if free and number and number not in lengths:
            self.journal.assume(f"nobody states the length of H{number}, zero", block)
        elif lengths and number and number not in lengths:
            known = ", ".join(str(n) for n in sorted(lengths))
            raise block.error(word, f"the settings have no length for tool {number}; they have {known}")
        return lengths.get(number, 0.0) if number else 0.0
