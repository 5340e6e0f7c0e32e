"""Whether it is known where the tool is: asked of programs that are meant to be cut."""

from __future__ import annotations

from collections.abc import Iterable

from gearsim.machines.chain import Machine
from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.lexer import Word
from gearsim.programs.gcode.offsets import Offsets
from gearsim.programs.gcode.settings import ReadSettings

_NO_TOOL = (
    "no tool is in the spindle here; a program that is cut needs T and M6 before, or control.start_tool in its scene"
)


class Placing:
    """Refuses moves of which the tool or its place is not known, where ``ReadSettings.tools`` are given.

    Every move has a tool in the spindle, but for those to machine coordinates and the reference point, on which
    tools are changed. Absolute words count from a work offset that the settings or the program place, and Z from
    the length of the tool in the spindle: the one that H names, or both from ``tool_lengths``. A cut begins where
    all slides have been placed this way since the last move to machine coordinates (Z: since the tool change). Where
    the settings take as zero what nobody states, only the tool is asked for.
    """

    def __init__(self, settings: ReadSettings, machine: Machine):
        self.settings = settings
        self.is_asked = settings.tools is not None
        self._axes = machine.axes
        self._slides = {i for i, joint in enumerate(machine.joints) if not joint.is_rotary}
        self._z = {i for i, axis in enumerate(machine.axes) if axis == "Z"}
        self._tool = settings.start_tool
        self._register: int | None = None
        self._placed: set[int] = set()

    def take_tool(self, number: int) -> None:
        """Another tool is in the spindle."""
        self._tool = number
        self._placed -= self._z

    def compensate(self, number: int | None) -> None:
        """The length of that number is compensated (-1: one that no table holds, None: none)."""
        self._register = number

    def leave(self, columns: Iterable[int]) -> None:
        """These axes go to machine coordinates."""
        self._placed -= set(columns)

    def is_ready(self, offsets: Offsets) -> bool:
        """Whether any move may come."""
        known = self._offset_is_right(offsets) and self._length_is_right() and not self._missing()
        return not self.is_asked or (self._tool != 0 and known)

    def check_move(self, block: Block, word: Word, columns: Iterable[int], absolute: bool, offsets: Offsets) -> None:
        """Refuse a programmed move of these axes whose tool or place is not known."""
        if not self.is_asked:
            return
        if not self._tool:
            raise block.error(word, _NO_TOOL)
        if not absolute:
            return
        if not self._offset_is_right(offsets):
            raise block.error(word, f"{offsets.active} is in force, {self._offset_reason()}")
        moved = self._slides & set(columns)
        if moved & self._z and not self._length_is_right():
            raise block.error(block.axes.get("Z", word), self._length_reason())
        self._placed |= moved

    def check_cut(self, block: Block, word: Word) -> None:
        """Refuse a cut that begins nobody knows where."""
        if not self.is_asked:
            return
        if not self._tool:
            raise block.error(word, _NO_TOOL)
        missing = self._missing()
        if missing:
            axis = self._axes[min(missing)]
            reason = f"where {axis} stands is not known here; move it to an absolute {axis} (G90) before"
            raise block.error(word, f"{reason}, with G43 in force" if axis == "Z" else reason)

    def check_zero(self, block: Block, word: Word, columns: Iterable[int]) -> None:
        """Refuse a zero that is set where the tool stands, if that is not known."""
        missing = sorted(set(columns) & self._missing())
        if self.is_asked and missing:
            axis = self._axes[missing[0]]
            raise block.error(word, f"it sets a zero where the tool stands, and where {axis} stands is not known here")

    def check_table(self, block: Block, word: Word) -> None:
        """Refuse a work offset stated in machine coordinates, if the workpiece is not."""
        if self.is_asked and not self._machine_is_known():
            reason = "it states a work offset in machine coordinates, in which the workpiece's place is not known here"
            raise block.error(word, f"{reason}; take it out")

    def _missing(self) -> set[int]:
        if self.settings.unstated_is_zero:
            return set()
        known = set()
        if self._machine_is_known():
            known = self._slides if self._tool in self.settings.tool_lengths else self._slides - self._z
        return self._slides - self._placed - known

    def _machine_is_known(self) -> bool:
        return self.settings.unstated_is_zero or self.settings.workpiece in self.settings.offsets

    def _offset_is_right(self, offsets: Offsets) -> bool:
        return self.settings.unstated_is_zero or offsets.is_known()

    def _length_is_right(self) -> bool:
        lengths, register = self.settings.tool_lengths, self._register
        if not self._z or register == self._tool or self.settings.unstated_is_zero:
            return True
        return self._tool in lengths and (register is None or register < 0 or register in lengths)

    def _offset_reason(self) -> str:
        there = sorted({self.settings.workpiece, *self.settings.offsets})
        return f"and its place is not known here; known are {', '.join(there)}; a scene says it by control.work_offsets"

    def _length_reason(self) -> str:
        wanted = f"G43 H{self._tool} is missing before" if self._register is None else f"expected H{self._tool}"
        found = "no tool length is compensated" if self._register is None else f"H{self._register} is compensated"
        if self._register is not None and self._register < 0:
            found = "a length of no table is compensated"
        told = f"{found}, T{self._tool} is in the spindle, and how long it is is not known here"
        return f"{told}; {wanted}, or control.tool_lengths_mm in a scene"
