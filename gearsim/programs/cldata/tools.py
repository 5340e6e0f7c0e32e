"""The tools of a CL file: CUTTER states sizes, LOADTL, TOOLNO and LOAD a number, in any order before the moves."""

from __future__ import annotations

from dataclasses import dataclass, replace

from gearsim.errors import InputError
from gearsim.programs.cldata.cutter import CutterSizes
from gearsim.programs.cldata.lexer import Statement
from gearsim.programs.cldata.numbers import decimal, fields, is_number


@dataclass(frozen=True)
class CLTool:
    """A tool as a CL file names it.

    ``number`` is that of LOADTL or its like ("": none), ``sizes`` what CUTTER states (None: nothing), ``line`` where
    the file first names it (0: nowhere).
    """

    number: str = ""
    sizes: CutterSizes | None = None
    line: int = 0

    def __str__(self) -> str:
        sizes = "" if self.sizes is None else f"{self.sizes}"
        return f"tool {self.number}{sizes and f', {sizes}'}" if self.number else sizes or "the tool"

    def is_same(self, other: CLTool) -> bool:
        """Whether both are one tool: by their numbers or, where neither has one, by their sizes."""
        if self.number or other.number:
            return self.number == other.number
        return self.sizes is None or other.sizes is None or not self.sizes.differs(other.sizes)


class ToolChanges:
    """The tools as far as a file has been read, and which of them is in the spindle."""

    def __init__(self) -> None:
        self._used: list[CLTool] = []
        self._now = CLTool()
        self._moved = 0  # line of the first move with the tool that is in the spindle; 0: none yet
        self._restated: CutterSizes | None = None  # CUTTER since that tool's last move

    def moves(self, line: int) -> int:
        """A move is made in this line; the number of the tool that makes it, by which ``used`` holds it."""
        self._restated = None
        if not self._moved:
            self._moved = line
            self._now = self._completed(self._now)
        for i, tool in enumerate(self._used):
            if tool.is_same(self._now):
                return i
        self._used.append(self._now)
        return len(self._used) - 1

    @property
    def used(self) -> tuple[CLTool, ...]:
        """The tools that move, in the order of their first moves; where none does, the one that is named."""
        return tuple(self._used) or (self._now,)

    def takes_sizes(self, statement: Statement, stated: CutterSizes) -> None:
        """CUTTER. Raises InputError where moves before it had a tool that nothing names."""
        now = self._now
        self._restated = stated
        if now.sizes is not None and not stated.differs(now.sizes):
            if len(stated.sizes) > len(now.sizes.sizes):
                self._now = replace(now, sizes=stated)
        elif self._moved:
            self._change(statement, CLTool("", stated, statement.line))
        else:
            self._now = replace(now, sizes=stated, line=now.line or statement.line)

    def takes_number(self, statement: Statement) -> None:
        """LOADTL, TOOLNO, LOAD/TOOL, SELECT/TOOL. Raises InputError where no tool is named or it is not settled which.

        SELECT makes a tool ready in some systems and loads it in others: it may name the one in the spindle alone.
        """
        named = [field for field in fields(statement.rest.upper()) if field != "TOOL"]
        if not named or not named[0]:
            raise InputError(f"{statement} names no tool; expected {statement.word}/number")
        number, now = f"{decimal(named[0]).normalize():f}" if is_number(named[0]) else named[0], self._now
        if number == now.number:
            return
        if statement.word == "SELECT" and (now.number or self._moved):
            raise InputError(
                f"{statement}: whether it loads the tool or makes it ready is not settled; expected LOADTL"
            )
        if self._moved:
            self._change(statement, CLTool(number, self._restated, statement.line))
        elif now.number:
            self._now = CLTool(number, None, statement.line)
        else:
            self._now = replace(now, number=number, line=now.line or statement.line)

    def _change(self, statement: Statement, tool: CLTool) -> None:
        if not self._now.line:
            raise InputError(
                f"{statement} changes the tool behind the move of line {self._moved}, which was made with a tool that "
                "nothing names; LOADTL or CUTTER is missing before it"
            )
        self._now, self._moved = tool, 0

    def _completed(self, tool: CLTool) -> CLTool:
        """The tool with the sizes that were stated of its number before. Raises InputError where they were others."""
        before = next((t for t in self._used if tool.number and t.number == tool.number), None)
        if before is None or before.sizes is None:
            return tool
        if tool.sizes is not None and (letters := tool.sizes.differs(before.sizes)):
            raise InputError(
                f"tool {tool.number} is {tool.sizes} (line {tool.sizes.line}) here and was {before.sizes} (line "
                f"{before.sizes.line}): {', '.join(letters)} differ"
            )
        return before
