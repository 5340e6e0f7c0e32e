"""The words of CL data: which are read, which hold text, which do not move the tool; and the rest, all told at once."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches

MOTION = ("GOTO", "FROM", "GODLTA")
TOOL = ("CUTTER", "LOADTL", "TOOLNO", "LOAD", "SELECT")
MODES = ("RAPID", "FEDRAT", "SPINDL", "UNITS", "UNIT", "MULTAX", "TLAXIS", "CSYS", "END", "FINI")
STILL = (
    "COOLNT", "MACHIN", "STOP", "OPSTOP", "DELAY", "INTOL", "OUTOL", "TOLER", "SEQNO", "PAINT", "NOPOST", "CLPRNT",
)  # fmt: skip
TOOL_DATA = ("CSI_SET_FLUTE_LENGTH", "CSI_SET_EXTENSION_LENGTH")
OFF_ONLY = ("CUTCOM", "CYCLE")  # what they switch on is not computed
KNOWN = frozenset((*MOTION, *TOOL, *MODES, *STILL, *TOOL_DATA))

# Their text may follow at once: APT gives the words the first six columns.
GLUED_TEXT = ("PARTNO", "PPRINT", "TPRINT", "INSERT", "REMARK", "LETTER", "TITLES", "PPWORD")
SPACED_TEXT = ("PRINT", "TITLE")
TEXT = frozenset((*GLUED_TEXT, *SPACED_TEXT))
FOR_THE_MACHINE = ("INSERT", "PPWORD")
_TOLD = 8


def is_read(word: str, rest: str) -> bool:
    """Whether a statement that holds no text is one of those that are read."""
    return word in KNOWN or (word in OFF_ONLY and rest.upper() == "OFF")


def unknown_words(found: Iterable[tuple[str, int]]) -> str:
    """Words that are not supported with their lines: how often each stands, its first line, and the nearest word."""
    lines: dict[str, list[int]] = {}
    for word, line in found:
        lines.setdefault(word, []).append(line)
    first = min(at[0] for at in lines.values())
    if len(lines) == 1 and len(lines[word]) == 1:
        return f"line {first}: word {word!r} is not supported{_hint(word)}"
    told = ", ".join(_told(word, at) for word, at in list(lines.items())[:_TOLD])
    if len(lines) > _TOLD:
        told += f" and {len(lines) - _TOLD} more (is this a CL file?)"
    return f"line {first}: {len(lines)} {'words are' if len(lines) > 1 else 'word is'} not supported: {told}"


def supported() -> str:
    """All words that are read."""
    return ", ".join(sorted((*KNOWN, *TEXT, *(f"{word}/OFF" for word in OFF_ONLY))))


def _told(word: str, lines: list[int]) -> str:
    often = f"{len(lines)} times, first in line {lines[0]}" if len(lines) > 1 else f"line {lines[0]}"
    return f"{word!r} ({often}{_hint(word)})"


def _hint(word: str) -> str:
    if word in OFF_ONLY:
        return f", but {word}/OFF"
    near = get_close_matches(word, sorted(KNOWN | TEXT), n=1, cutoff=0.75)
    return f", did you mean {near[0]}?" if near else ""
