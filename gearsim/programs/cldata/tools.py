"""One tool a file: every word that changes or loads another one is refused with its line."""

from __future__ import annotations

from gearsim.errors import InputError
from gearsim.programs.cldata.cutter import CutterSizes
from gearsim.programs.cldata.lexer import Statement
from gearsim.programs.cldata.numbers import decimal, fields, is_number

_REMEDY = "one tool a file is cut: split it, a file for every tool"


class OneTool:
    """The tool of a program, as far as it has been read: its sizes, its number, and where the moves began."""

    def __init__(self) -> None:
        self.cutter: CutterSizes | None = None
        self._number = ""
        self._loaded: Statement | None = None
        self._moved = 0

    def moves(self, line: int) -> None:
        """A move is made with it."""
        self._moved = self._moved or line

    def takes_sizes(self, statement: Statement, stated: CutterSizes) -> None:
        """CUTTER. Raises InputError where it states another tool, or the first one behind moves."""
        if self.cutter is None:
            self._none_moved(statement)
        elif letters := stated.differs(self.cutter):
            raise InputError(
                f"{stated} is another tool than that of line {self.cutter.line}, {self.cutter} ({', '.join(letters)} "
                f"differ); {_REMEDY}"
            )
        if self.cutter is None or len(stated.sizes) > len(self.cutter.sizes):
            self.cutter = stated

    def takes_number(self, statement: Statement) -> None:
        """LOADTL, TOOLNO, LOAD/TOOL, SELECT/TOOL. Raises InputError for a second number, or a first behind moves."""
        named = [field for field in fields(statement.rest.upper()) if field != "TOOL"]
        if not named or not named[0]:
            raise InputError(f"{statement} names no tool; expected {statement.word}/number")
        number = str(decimal(named[0]).normalize()) if is_number(named[0]) else named[0]
        if self._loaded is None:
            self._none_moved(statement)
            self._number, self._loaded = number, statement
        elif number != self._number:
            raise InputError(
                f"{statement} is another tool than that of line {self._loaded.line}, {self._loaded}; {_REMEDY}"
            )

    def _none_moved(self, statement: Statement) -> None:
        if self._moved:
            raise InputError(f"{statement} changes the tool behind the move of line {self._moved}; {_REMEDY}")
