"""What a program tells beside its moves: number, title, tools, operations, notes."""

from __future__ import annotations

from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.state import State

_SMOOTHING = ("look-ahead", "path control")


class Journal:
    """Collects names; an operation begins at a tool change and at a line of a number and a comment alone.

    Such a beginning before the operation in force has cut anything renames it (a header, then its tool change).
    """

    def __init__(self) -> None:
        self.number: int | None = None
        self.title = ""
        self.tools: list[int] = []
        self.operations: list[str] = []
        self.ignored: dict[str, int] = {}
        self.assumed: dict[str, int] = {}
        self.told: dict[str, int] = {}
        self.has_end = True
        self._comment = ""
        self._has_cut = False

    def note(self, block: Block, comments: list[str], state: State) -> None:
        """Take a line's comments, program number and codes without influence on the path."""
        told = next((text for text in comments if text), "")
        if "O" in block.letters and self.number is None:
            self.number = block.whole(block.letters["O"])
            self.title = told
        elif told:
            self.title = self.title or ("" if self.operations else told)
            self._comment = told
            if set(block.letters) == {"N"} and not block.g and not block.m:
                self._begin(told, state)
        for group, (code, _) in block.g.items():
            if group in _SMOOTHING:
                self.ignored.setdefault(f"G{code / 10:g}", block.line.number)

    def tool_change(self, block: Block, state: State) -> None:
        """A tool comes into the spindle."""
        if state.tool and state.tool not in self.tools:
            self.tools.append(state.tool)
        if self._has_cut or not self.operations:
            number = block.letters.get("N")
            self._begin(self._comment or (f"N{number.value:.0f}" if number else f"T{state.tool}"), state)

    def move(self, cuts: bool) -> None:
        """A move is made: there is an operation from now on, and what was told before belongs to it."""
        self._has_cut = self._has_cut or cuts
        if not self.operations:
            self.operations.append(self.title or "start")
        if cuts:
            self._comment = ""

    def notes(self) -> tuple[str, ...]:
        """What a person should know about the reading."""
        smoothed = (
            f"{code} (line {line} first): the control's smoothing of corners is not simulated"
            for code, line in self.ignored.items()
        )
        assumed = (f"{what} is assumed (line {line} first)" for what, line in self.assumed.items())
        told = (f"{what} (line {line} first)" for what, line in self.told.items())
        cut_off = "the program is cut off: LinuxCNC expects M2, M30 or a second % at its end"
        return (*smoothed, *assumed, *told, *(() if self.has_end else (cut_off,)))

    def assume(self, what: str, block: Block) -> None:
        """The reading takes something for granted that nobody has stated."""
        self.assumed.setdefault(what, block.line.number)

    def tell(self, what: str, block: Block) -> None:
        """The program says something that a person may not have meant, or that has no use here."""
        self.told.setdefault(what, block.line.number)

    def without_point(self, line: int, increment: float) -> None:
        """A length or an angle other than zero has no decimal point."""
        if increment:
            what = f"numbers without a decimal point count least increments, {increment:g} mm or deg"
        else:
            what = (
                "numbers without a decimal point are read as those with one: X100 is 100 mm; a control that counts "
                "least increments reads 0.1 mm: control.least_increment_mm in a scene"
            )
        self.told[what] = min(line, self.told.get(what, line))

    def _begin(self, name: str, state: State) -> None:
        if self.operations and not self._has_cut:
            self.operations[-1] = name
        else:
            self.operations.append(name)
        state.operation = len(self.operations) - 1
        self._has_cut = False
