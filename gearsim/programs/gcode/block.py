"""The words of one block sorted by what they are: one per letter, one G code a modal group, M codes."""

from __future__ import annotations

from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.errors import Line, ProgramError
from gearsim.programs.gcode.lexer import Word

_AXES = "ABCUVWXYZ"


class Block:
    """A line's words by letter; those nobody ``take``s are refused in the end."""

    def __init__(self, line: Line, words: list[Word], dialect: Dialect, axes: tuple[str, ...]):
        self.line, self.dialect = line, dialect
        self.g: dict[str, tuple[int, Word]] = {}
        self.m: dict[str, tuple[int, Word]] = {}
        self.letters: dict[str, Word] = {}
        self._taken: set[str] = set()
        m_words = [word for word in words if word.letter == "M"]
        if len(m_words) > dialect.m_count:
            raise self.error(m_words[-1], f"a block has up to {dialect.m_count} M words in dialect {dialect.name}")
        for word in words:
            if word.letter == "G":
                self._sort_g(word)
            elif word.letter == "M":
                self._sort_m(word)
            elif word.letter in self.letters:
                raise self.error(word, f"the letter {word.letter} stands twice in the block")
            else:
                self.letters[word.letter] = word
        self.axes = {letter: word for letter, word in self.letters.items() if letter in axes}
        for letter, word in self.letters.items():
            if letter in _AXES and letter not in axes:
                raise self.error(word, f"the machine has no axis {letter}; it has {', '.join(axes)}")

    @property
    def open_axes(self) -> dict[str, Word]:
        """The axis words that nothing has taken yet."""
        return {letter: word for letter, word in self.axes.items() if letter not in self._taken}

    def is_open(self, letter: str) -> bool:
        """Whether there is a word with that letter that nothing has taken yet."""
        return letter in self.letters and letter not in self._taken

    def take_axes(self) -> None:
        """All axis words have found their use."""
        self._taken.update(self.axes)

    def error(self, word: Word, reason: str) -> ProgramError:
        """An error at a word."""
        return self.line.error(word.start, word.end, reason)

    def take(self, letter: str) -> Word | None:
        """The word with a letter, or None."""
        self._taken.add(letter)
        return self.letters.get(letter)

    def need(self, letter: str, word: Word, what: str) -> Word:
        """The word with a letter, without which ``word`` cannot do its work."""
        found = self.take(letter)
        if found is None:
            raise self.error(word, f"{letter}, {what}, is missing")
        return found

    def whole(self, word: Word, largest: int = 99_999_999) -> int:
        """The value of a word that has to be a whole number from 0 on."""
        nearest = round(word.value)
        if not 0 <= nearest <= largest or abs(word.value - nearest) > self.dialect.whole_within:
            raise self.error(word, f"expected a whole number from 0 to {largest} behind {word.letter}")
        return nearest

    def without_point(self) -> list[str]:
        """The letters of lengths and angles other than zero whose numbers have no decimal point."""
        lengths = {letter: self.letters[letter] for letter in "IJKR" if letter in self.letters} | self.axes
        text = self.line.text
        return [a for a, word in lengths.items() if word.value != 0.0 and "." not in text[word.start : word.end]]

    def scale(self, letter: str, factor: float) -> None:
        """Multiply a word's number."""
        word = self.letters[letter]
        self.letters[letter] = word._replace(value=word.value * factor)
        if letter in self.axes:
            self.axes[letter] = self.letters[letter]

    def check_all_taken(self) -> None:
        """Refuse the first word that nothing in the block has a use for."""
        for letter, word in self.letters.items():
            if letter not in self._taken:
                raise self.error(word, f"nothing in this block has a use for the letter {letter}")

    def _sort_g(self, word: Word) -> None:
        code, dialect = round(10.0 * word.value), self.dialect
        name = f"G{code / 10:g}"
        if abs(code - 10.0 * word.value) > dialect.code_within or not (
            code in dialect.groups or code in dialect.refused
        ):
            raise self.error(word, f"dialect {dialect.name} has no such G code")
        if code in dialect.refused:
            raise self.error(word, f"{name} is not read: {dialect.refused[code]}")
        group = dialect.groups[code]
        if group in self.g:
            other = f"G{self.g[group][0] / 10:g}"
            reason = "stands twice" if other == name else f"and {other} are both of the group {group}"
            raise self.error(word, f"{name} {reason}; a block has one of them")
        self.g[group] = (code, word)

    def _sort_m(self, word: Word) -> None:
        dialect, code = self.dialect, self.whole(word, 999)
        if code in dialect.m_refused:
            raise self.error(word, f"M{code} is not read: {dialect.m_refused[code]}")
        group = dialect.m_groups.get(code, f"M{code}" if code in dialect.m_harmless else None)
        if group is None:
            raise self.error(word, f"dialect {dialect.name} has no such M code")
        if group in self.m:
            raise self.error(word, f"M{self.m[group][0]} and M{code} are both of the group {group}; a block has one")
        self.m[group] = (code, word)
