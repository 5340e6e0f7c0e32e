"""LinuxCNC's O words: finds them in a program's lines and matches those that belong together."""

from __future__ import annotations

import re
from typing import NamedTuple

from gearsim.programs.gcode.errors import Line
from gearsim.programs.gcode.squeeze import Squeezed, squeezed

# As the control looks for them, the first that fits.
KEYWORDS = ("SUB", "ENDSUB", "CALL", "DO", "WHILE", "REPEAT", "IF", "ELSEIF", "ELSE", "ENDIF", "BREAK", "CONTINUE",
            "ENDWHILE", "ENDREPEAT", "RETURN")  # fmt: skip
_LOOPS = ("WHILE", "DO")
_BEGIN = re.compile(r"[ \t]*/?[ \t]*(?:N[ \t0-9.]*)?O", re.IGNORECASE)
_O_WORD = re.compile(r"/?(?:N[0-9]+(?:\.[0-9]+)?)?(O)", re.IGNORECASE)
_LABEL = re.compile(r"<([^<>]+)>|[0-9]+")
_KEYWORD = re.compile("|".join(KEYWORDS), re.IGNORECASE)
_CLOSED_BY = {"SUB": "ENDSUB", "IF": "ENDIF", "WHILE": "ENDWHILE", "DO": "WHILE", "REPEAT": "ENDREPEAT"}
_OPENER = {end: begin for begin, end in _CLOSED_BY.items() if end != "WHILE"}


class OWord(NamedTuple):
    """An O word: its label, its keyword (none: a label alone), and where in the squeezed line they begin and end."""

    label: str
    keyword: str
    start: int
    end: int


class Group:
    """O words of one label that belong together: the lines (from 0) of the first, those between, and the last."""

    def __init__(self, first: int, word: OWord):
        self.first, self.word, self.last = first, word, first
        self.between: list[int] = []


class Structure:
    """The O words of a program by line, and for each the group it belongs to.

    ``leaves``: the lines in which a subroutine ends or returns, by its label.
    """

    def __init__(self, lines: list[Line], limit: int):
        self.lines = {i: squeezed(line, limit) for i, line in enumerate(lines) if _BEGIN.match(line.text)}
        found = {i: o_word(line) for i, line in self.lines.items()}
        self.words = {i: word for i, word in found.items() if word is not None}
        self.groups: dict[int, Group] = {}
        self.subs: dict[str, Group] = {}
        self.leaves: dict[str, list[int]] = {}
        self._open: list[Group] = []
        self._labels: dict[tuple[str, str], int] = {}
        for i, word in self.words.items():
            self._place(self.lines[i], i, word)
        if self._open:
            group = self._open[-1]
            reason = f"O{group.word.label} {_CLOSED_BY[group.word.keyword]} is missing"
            raise self.lines[group.first].error(group.word.start, group.word.end, reason)

    def _place(self, line: Line, i: int, word: OWord) -> None:
        top = self._open[-1] if self._open else None
        mine = top if top is not None and top.word.label == word.label else None
        closes = mine is not None and _CLOSED_BY[mine.word.keyword] == word.keyword
        if word.keyword in ("ENDSUB", "RETURN"):
            self.leaves.setdefault(word.label, []).append(i)
        if mine is not None and closes and not (word.keyword == "WHILE" and mine.word.keyword == "WHILE"):
            mine.last = i
            self.groups[i] = mine
            self._open.pop()
        elif word.keyword in _CLOSED_BY:
            self._begin(line, i, word)
        elif word.keyword in ("ELSEIF", "ELSE"):
            self._branch(line, i, word, mine)
        elif word.keyword in ("BREAK", "CONTINUE", "RETURN"):
            self._leave(line, i, word)
        elif word.keyword in _OPENER:
            inside = f"; O{top.word.label} {top.word.keyword} is still open" if top else ""
            reason = f"O{word.label} {_OPENER[word.keyword]} is not open here{inside}"
            raise line.error(word.start, word.end, reason)
        elif not word.keyword and self._sub:
            raise line.error(word.start, word.end, "a label alone begins a program; it cannot stand in a subroutine")

    @property
    def _sub(self) -> str:
        """The label of the subroutine that is open."""
        return self._open[0].word.label if self._open and self._open[0].word.keyword == "SUB" else ""

    def _begin(self, line: Line, i: int, word: OWord) -> None:
        group = Group(i, word)
        if word.keyword == "SUB":
            if self._open:
                raise line.error(word.start, word.end, "a subroutine stands outside of everything else")
            if word.label in self.subs:
                raise line.error(word.start, word.end, f"subroutine O{word.label} is defined twice")
            self.subs[word.label] = group
        else:
            before = self._labels.setdefault((self._sub, word.label), i)
            if before != i:
                reason = f"the label O{word.label} is taken by line {self.lines[before].number}; a label stands for one"
                raise line.error(word.start, word.end, f"{reason} branch or loop")
        self.groups[i] = group
        self._open.append(group)

    def _branch(self, line: Line, i: int, word: OWord, mine: Group | None) -> None:
        if mine is None or mine.word.keyword != "IF":
            raise line.error(word.start, word.end, f"O{word.label} IF is not open here")
        if mine.between and self.words[mine.between[-1]].keyword == "ELSE":
            raise line.error(word.start, word.end, "ELSE is the last branch of an IF")
        mine.between.append(i)
        self.groups[i] = mine

    def _leave(self, line: Line, i: int, word: OWord) -> None:
        kinds = ("SUB",) if word.keyword == "RETURN" else _LOOPS
        for group in reversed(self._open):
            if group.word.label == word.label and group.word.keyword in kinds:
                group.between.append(i)
                self.groups[i] = group
                return
        what = "subroutine" if word.keyword == "RETURN" else "loop"
        hint = "" if what == "subroutine" else "; BREAK and CONTINUE are for WHILE and DO"
        raise line.error(word.start, word.end, f"no {what} O{word.label} is open here{hint}")


def o_word(line: Squeezed) -> OWord | None:
    """The O word a line begins with, or None. Raises ProgramError for one without label, or an unknown keyword."""
    begin = _O_WORD.match(line.text)
    if begin is None:
        return None
    start = begin.start(1)
    label = _LABEL.match(line.text, begin.end())
    if label is None:
        raise line.error(start, begin.end(), "an O word has a number or a <name>")
    pos = label.end()
    name = str(int(label[0])) if label[1] is None else label[1].lower()
    if line.text[pos : pos + 1] in ("", "(", ";"):
        return OWord(name, "", start, pos)
    keyword = _KEYWORD.match(line.text, pos)
    if keyword is None:
        word = re.match(r"[A-Za-z]*", line.text[pos:])
        reason = f"the O word has no keyword known here; there are {', '.join(KEYWORDS)}"
        raise line.error(start, pos + (word.end() if word else 0), reason)
    return OWord(name, keyword[0].upper(), start, keyword.end())
