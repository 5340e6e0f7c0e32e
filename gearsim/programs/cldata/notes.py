"""What a person must be told of a CL file that was read, with counts and lines."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearsim.programs.cldata.frame import Units
from gearsim.programs.cldata.lexer import Statement
from gearsim.programs.cldata.program import CLPath
from gearsim.programs.cldata.tools import CLTool

_LARGE_TOOL = 100.0  # mm: tools and paths above are rather millimetres under UNITS/INCHES
_LARGE_PATH = 1500.0


class Notes:
    """Remarks by what they say, with the lines they are about."""

    def __init__(self) -> None:
        self._lines: dict[str, list[int]] = {}
        self._said: list[str] = []
        self._fed_late: list[int] = []

    def behind_the_end(self, s: Statement) -> None:
        self._add("text behind END or FINI is not read", s)

    def for_the_machine(self, s: Statement) -> None:
        self._add(f"{s.word}: text for the machine's program, not read; what it moves there is not cut", s)

    def not_used(self, s: Statement) -> None:
        self._add(f"{s.word} is not used; CUTTER and the scene say what is cut", s)

    def move_in_text(self, s: Statement) -> None:
        self._add(f"the text of {s.word} holds a motion word, which is text there and moves nothing", s)

    def no_pass_name(self, s: Statement) -> None:
        self._add(f"{s.word} {s.rest!r} names no pass; expected PPRINT PASS and one word", s)

    def set_elsewhere(self, s: Statement) -> None:
        self._add("FROM sets the tool elsewhere than where it was; nothing is cut between", s)

    def inverse(self, s: Statement) -> None:
        self._add("FEDRAT of INVERS: read as inverse time, moves a minute", s)

    def without_feed(self, s: Statement) -> None:
        self._fed_late.append(s.line)

    def units(self, units: Units, paths: Sequence[CLPath], tools: Sequence[CLTool]) -> None:
        """Told: no unit, or inches, and those that look like millimetres."""
        if units.stated is None:
            self._said.append("no UNITS: lengths are read as millimetres")
        if not units.inches:
            return
        assert units.stated is not None
        reach = max(float(np.abs(path.tips).max()) for path in paths)
        large = reach > _LARGE_PATH or any(t.sizes is not None and t.sizes.sizes[0] > _LARGE_TOOL for t in tools)
        doubt = "; so large, the numbers look like millimetres, but the file says inches" if large else ""
        converted = f"converted to millimetres, tips lie up to {reach:.4g} mm off"
        self._said.append(f"{units.stated} (line {units.stated.line}): {converted}{doubt}")

    def told(self, feed: float | None) -> tuple[str, ...]:
        """All remarks; ``feed`` is the program's."""
        counted = [f"{text} ({_lines(at)})" for text, at in self._lines.items()]
        if self._fed_late and feed is not None:
            counted.append(f"cutting moves before the first FEDRAT state no feed ({_lines(self._fed_late)})")
        return (*self._said, *counted)

    def _add(self, text: str, s: Statement) -> None:
        self._lines.setdefault(text, []).append(s.line)


def _lines(at: list[int]) -> str:
    return f"{len(at)} times, first in line {at[0]}" if len(at) > 1 else f"line {at[0]}"
