"""Runs a LinuxCNC program with O words: subroutines, branches and loops, line by line.

Some of it is what the control does rather than what one expects: conditions of branches behind the one taken are
evaluated, a subroutine's return values already where it is defined; a BREAK in WHILE, be it only passed over,
lets the next DO loop run once, a CONTINUE in DO turns the next BREAK of a WHILE into a CONTINUE and runs a REPEAT
twice; a REPEAT that a RETURN leaves goes on with its count in the next call.
"""

from __future__ import annotations

import re
from collections.abc import Callable

from gearsim.programs.gcode.errors import Line, ProgramError
from gearsim.programs.gcode.expressions import Expressions
from gearsim.programs.gcode.interpreter import Interpreter
from gearsim.programs.gcode.parameters import LOCAL_NUMBERS
from gearsim.programs.gcode.squeeze import squeezed
from gearsim.programs.gcode.structure import Group, OWord, Structure

_CALLS = 9
_HAS_O_WORD = re.compile(rb"^[ \t/]*(n[ \t0-9.]*)?o[ \t]*(<[^>\n]*>|[0-9][0-9 \t]*)[ \t]*[a-z]", re.I | re.M)


def has_flow(data: bytes) -> bool:
    """Whether a program has lines that begin with an O word that is more than a label."""
    return _HAS_O_WORD.search(data) is not None


class Flow:
    """Executes lines in the order the O words ask for."""

    def __init__(self, lines: list[Line], interpreter: Interpreter, expressions: Expressions, limit: int):
        self.lines, self.interpreter, self.expressions, self.limit = lines, interpreter, expressions, limit
        self._width = interpreter.dialect.line_limit
        deleted = interpreter.settings.block_delete
        kept = [Line(line.source, line.number, "") if deleted and _is_deleted(line) else line for line in lines]
        self.structure = Structure(kept, self._width)
        self._returns: list[int] = []
        self._met: set[str] = set()
        self._passed: set[tuple[int, int]] = set()
        self._rounds: dict[Group, int] = {}
        self._breaks = self._continues = False
        self._actions: dict[str, Callable[[int, OWord], int]] = {
            "": self._next, "SUB": self._define, "ENDSUB": self._return, "RETURN": self._return, "CALL": self._call,
            "IF": self._branch, "ELSEIF": self._end_branch, "ELSE": self._end_branch, "ENDIF": self._next,
            "WHILE": self._while, "ENDWHILE": self._end_while, "DO": self._next, "REPEAT": self._repeat,
            "ENDREPEAT": self._end_repeat, "BREAK": self._break, "CONTINUE": self._continue,
        }  # fmt: skip

    def run(self) -> None:
        """Run the program. Raises ProgramError for what it cannot use, and for loops that do not end."""
        at, done = 0, 0
        while at < len(self.lines) and not self.interpreter.ended:
            line, word = self.lines[at], self.structure.words.get(at)
            done += 1
            if done > self.limit:
                raise line.error(0, len(line.text), f"after {self.limit} lines run the program has not ended")
            if word is None or not word.keyword:
                self.interpreter.line(line)
                at += 1
            else:
                self.interpreter.has_words = True
                at = self._actions[word.keyword](at, word)

    def _next(self, at: int, word: OWord) -> int:
        self._nothing(at)
        return at + 1

    def _skip(self, at: int, to: int) -> int:
        """Pass over lines, which the control reads for their comments all the same."""
        if (at, to) in self._passed:
            return to
        self._passed.add((at, to))
        for line in self.lines[at + 1 : to]:
            if squeezed(line, self._width).text == "%":
                raise line.error(0, 1, "the program ends inside of what is passed over here")
        return to

    def _define(self, at: int, word: OWord) -> int:
        self._nothing(at)
        if word.label in self._met:
            reason = f"subroutine O{word.label} was called before the program came here; let the program end before it"
            raise self.lines[at].error(0, len(self.lines[at].text), reason)
        self._met.add(word.label)
        for leave in self.structure.leaves[word.label]:
            self._take_result(leave, defining=True)
        return self._skip(at, self.structure.groups[at].last + 1)

    def _call(self, at: int, word: OWord) -> int:
        line, sub = self.structure.lines[at], self.structure.subs.get(word.label)
        if sub is None:
            raise line.error(word.start, word.end, f"no subroutine O{word.label} in this program")
        if len(self._returns) >= _CALLS:
            raise line.error(word.start, word.end, f"subroutines call each other more than {_CALLS} deep")
        arguments = self._arguments(at, between=True)
        if len(arguments) > LOCAL_NUMBERS:
            reason = f"a subroutine takes up to {LOCAL_NUMBERS} values; these are {len(arguments)}"
            raise line.error(word.start, word.end, reason)
        if word.label not in self._met:
            if sub.first < at:
                reason = f"the program has not come to subroutine O{word.label} yet, and it is not behind this line"
                raise line.error(word.start, word.end, reason)
            self._skip(at, sub.first)
            self._met.add(word.label)
        self._nothing(sub.first)
        self._returns.append(at + 1)
        self.expressions.parameters.enter(arguments)
        return sub.first + 1

    def _return(self, at: int, word: OWord) -> int:
        self._take_result(at, defining=False)
        self.expressions.parameters.leave()
        return self._returns.pop()

    def _take_result(self, at: int, defining: bool) -> None:
        """What a subroutine returns; where it is being defined, names of its own have no value yet."""
        try:
            result = self._arguments(at)
        except ProgramError:
            if defining and "<" in self.structure.lines[at].text[self.structure.words[at].end :]:
                return
            raise
        if len(result) > 1:
            self._refuse(at, "a subroutine returns one value")
        self.expressions.parameters.result = result[0] if result else None

    def _branch(self, at: int, word: OWord) -> int:
        group = self.structure.groups[at]
        for i in (at, *group.between):
            if self.structure.words[i].keyword == "ELSE":
                self._nothing(i)
                return self._skip(at, i + 1)
            if self._number(i):
                return self._skip(at, i + 1)
        return self._skip(at, group.last)

    def _end_branch(self, at: int, word: OWord) -> int:
        group = self.structure.groups[at]
        for i in group.between[group.between.index(at) :]:
            if self.structure.words[i].keyword == "ELSEIF":
                self._number(i)
            else:
                self._nothing(i)
        return self._skip(at, group.last)

    def _while(self, at: int, word: OWord) -> int:
        group, goes_on = self.structure.groups[at], self._number(at) != 0.0
        if group.word.keyword == "DO":
            again = goes_on and not self._breaks
            self._breaks = self._breaks and again
            return group.first if again else at + 1
        if goes_on:
            return at + 1
        self._nothing(group.last)
        self._pass_breaks(at, group)
        self._continues = False
        return self._skip(at, group.last + 1)

    def _end_while(self, at: int, word: OWord) -> int:
        self._nothing(at)
        return self.structure.groups[at].first

    def _repeat(self, at: int, word: OWord) -> int:
        group, count = self.structure.groups[at], round(self._number(at))
        left = self._rounds.get(group, -1)
        left = count if left == -1 else left
        if left > 0:
            self._rounds[group] = left - 1
            return at + 1
        self._rounds[group] = -1
        self._nothing(group.last)
        again, self._continues = self._continues, False
        return at if again else self._skip(at, group.last + 1)

    def _end_repeat(self, at: int, word: OWord) -> int:
        self._nothing(at)
        return self.structure.groups[at].first

    def _break(self, at: int, word: OWord) -> int:
        self._breaks = True
        return self._leave_round(at)

    def _continue(self, at: int, word: OWord) -> int:
        self._continues = True
        return self._leave_round(at)

    def _leave_round(self, at: int) -> int:
        """To the end of the loop; at the end of WHILE a CONTINUE goes on, be it an old one."""
        self._nothing(at)
        group = self.structure.groups[at]
        self._pass_breaks(at, group)
        self._skip(at, group.last)
        if group.word.keyword == "DO":
            return group.last
        self._nothing(group.last)
        again, self._continues = self._continues, False
        return group.first if again else group.last + 1

    def _pass_breaks(self, at: int, group: Group) -> None:
        """The control, on its way to a loop's end, takes note of the loop's own BREAKs."""
        words = self.structure.words
        self._breaks = self._breaks or any(words[i].keyword == "BREAK" for i in group.between if i > at)

    def _number(self, at: int) -> float:
        """The one value behind an O word."""
        values = self._arguments(at)
        if len(values) != 1:
            self._refuse(at, f"{self.structure.words[at].keyword} is followed by one value in [ ]")
        return values[0]

    def _nothing(self, at: int) -> None:
        if self._arguments(at):
            self._refuse(at, f"no value follows {self.structure.words[at].keyword}")

    def _refuse(self, at: int, reason: str) -> None:
        word = self.structure.words[at]
        raise self.structure.lines[at].error(word.start, word.end, reason)

    def _arguments(self, at: int, between: bool = False) -> list[float]:
        """The values in brackets behind an O word; comments may follow, or stand ``between`` them."""
        line, word = self.structure.lines[at], self.structure.words[at]
        values, pos, text = [], word.end, line.text
        while text[pos : pos + 1] == "[" or (between and text[pos : pos + 1] == "("):
            if text[pos] == "(":
                pos = text.index(")", pos) + 1
                continue
            value, pos = self.expressions.value(line, pos)
            values.append(value)
        while text[pos : pos + 1] == "(":
            pos = text.index(")", pos) + 1
        if pos < len(text) and text[pos] != ";":
            raise line.error(pos, len(text), f"only values in [ ] follow {word.keyword}")
        return values


def _is_deleted(line: Line) -> bool:
    return line.text.lstrip().startswith("/")
