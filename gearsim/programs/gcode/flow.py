"""Runs a LinuxCNC program with O words: subroutines, branches and loops, line by line."""

from __future__ import annotations

import re
from collections.abc import Callable

from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.expressions import Expressions, skip
from gearsim.programs.gcode.interpreter import Interpreter
from gearsim.programs.gcode.lexer import check_characters
from gearsim.programs.gcode.structure import Group, OWord, Structure

_CALLS = 20
_HAS_O_WORD = re.compile(rb"^[ \t/]*(n[ \t]*[0-9]+[ \t]*)?o", re.IGNORECASE | re.MULTILINE)


def has_flow(data: bytes) -> bool:
    """Whether a program has lines that begin with an O word."""
    return _HAS_O_WORD.search(data) is not None


class Flow:
    """Executes lines in the order the O words ask for."""

    def __init__(self, lines: list[Line], interpreter: Interpreter, expressions: Expressions, limit: int):
        self.lines, self.interpreter, self.expressions, self.limit = lines, interpreter, expressions, limit
        self.structure = Structure(lines)
        self._returns: list[int] = []
        self._rounds: list[dict[Group, int]] = [{}]
        actions: dict[str, Callable[[int, OWord], int]] = {
            "SUB": self._past, "ENDSUB": self._return, "RETURN": self._return, "CALL": self._call,
            "IF": self._branch, "ELSEIF": self._past, "ELSE": self._past, "ENDIF": self._next,
            "WHILE": self._while, "ENDWHILE": self._again, "DO": self._next,
            "REPEAT": self._repeat, "ENDREPEAT": self._again, "BREAK": self._past, "CONTINUE": self._again,
        }  # fmt: skip
        self._actions = actions

    def run(self) -> None:
        """Run the program. Raises ProgramError for what it cannot use, and for loops that do not end."""
        at, done = 0, 0
        while at < len(self.lines) and not self.interpreter.ended:
            line, word = self.lines[at], self.structure.words.get(at)
            done += 1
            if done > self.limit:
                raise line.error(0, len(line.text), f"after {self.limit} lines run the program has not ended")
            if word is None:
                self.interpreter.line(line)
                at += 1
            else:
                check_characters(line)
                self.interpreter.has_words = True
                at = at + 1 if self._deleted(line) else self._actions[word.keyword](at, word)

    def _deleted(self, line: Line) -> bool:
        return self.interpreter.settings.block_delete and line.text.lstrip().startswith("/")

    def _next(self, at: int, word: OWord) -> int:
        return at + 1

    def _past(self, at: int, word: OWord) -> int:
        return self.structure.groups[at].last + 1

    def _again(self, at: int, word: OWord) -> int:
        group = self.structure.groups[at]
        if word.keyword == "ENDREPEAT":
            self._rounds[-1][group] -= 1
            return group.first + 1 if self._rounds[-1][group] > 0 else at + 1
        return group.first if group.word.keyword == "WHILE" else group.last

    def _branch(self, at: int, word: OWord) -> int:
        group = self.structure.groups[at]
        for i in (at, *group.between):
            if self.structure.words[i].keyword == "ELSE" or self._number(i):
                return i + 1
        return group.last + 1

    def _while(self, at: int, word: OWord) -> int:
        group = self.structure.groups[at]
        if group.word.keyword == "DO":
            return group.first + 1 if self._number(at) else at + 1
        return at + 1 if self._number(at) else group.last + 1

    def _repeat(self, at: int, word: OWord) -> int:
        group, rounds = self.structure.groups[at], int(self._number(at))
        self._rounds[-1][group] = rounds
        return at + 1 if rounds > 0 else group.last + 1

    def _call(self, at: int, word: OWord) -> int:
        line, sub = self.lines[at], self.structure.subs.get(word.label)
        if sub is None:
            raise line.error(word.start, word.end, f"no subroutine O{word.label} in this program")
        if len(self._returns) >= _CALLS:
            raise line.error(word.start, word.end, f"subroutines call each other more than {_CALLS} deep")
        arguments = self._arguments(line, word)
        self._returns.append(at + 1)
        self._rounds.append({})
        self.expressions.parameters.enter(arguments)
        return sub.first + 1

    def _return(self, at: int, word: OWord) -> int:
        result = self._arguments(self.lines[at], word)
        self.expressions.parameters.leave()
        self._rounds.pop()
        if result:
            self.expressions.parameters.shared["_value"] = result[0]
        return self._returns.pop()

    def _number(self, at: int) -> float:
        """The one value behind an O word."""
        line, word = self.lines[at], self.structure.words[at]
        values = self._arguments(line, word)
        if len(values) != 1:
            raise line.error(word.start, word.end, f"{word.keyword} is followed by one value in [ ]")
        return values[0]

    def _arguments(self, line: Line, word: OWord) -> list[float]:
        """The values in brackets behind an O word; comments may follow."""
        values, pos = [], skip(line.text, word.end)
        while line.text[pos : pos + 1] == "[":
            value, pos = self.expressions.value(line, pos)
            values.append(value)
            pos = skip(line.text, pos)
        if pos < len(line.text) and line.text[pos] not in "(;":
            raise line.error(pos, len(line.text), f"only values in [ ] follow {word.keyword}")
        return values
