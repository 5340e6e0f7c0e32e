"""The text of IGES and STEP files looked at before Open CASCADE reads it: what it would take wrongly is refused."""

from __future__ import annotations

import re

from gearsim.errors import InputError

_SECTIONS = "SGDPT"
_NUMBER = re.compile(r"([+-]?(\d+\.?\d*|\.\d+)([EeDd][+-]?\d+)?)?")
_UNITS = {
    1: ("IN", "INCH"), 2: ("MM",), 4: ("FT",), 5: ("MI",), 6: ("M",), 7: ("KM",), 8: ("MIL",), 9: ("UM",), 10: ("CM",),
    11: ("UIN",),
}  # fmt: skip
_NAMED = 3


def clean(data: bytes) -> str:
    """The text without a byte-order mark, blanks at the ends of lines, blank lines and other ends at its end."""
    text = data.removeprefix(b"\xef\xbb\xbf").decode("latin-1").rstrip("\x1a\x00 \r\n\t")
    return "\n".join(line.rstrip() for line in text.splitlines()) + "\n"


def without_blank_lines(text: str) -> str:
    """The text as IGES wants it, where every line stands in a section."""
    return "\n".join(line for line in text.splitlines() if line) + "\n"


def check_iges(text: str, name: str) -> None:
    """80 columns, sections in order, entries in the directory, full scale and a unit that is one."""
    lines = [line.ljust(80) for line in text.splitlines()]
    order = -1
    for number, line in enumerate(lines, 1):
        letter = line[72:73]
        if not line.strip():
            continue
        if len(line.rstrip()) > 80 or letter not in _SECTIONS or not letter.strip():
            raise InputError(
                f"{name}, line {number}: no IGES in fixed ASCII format, whose lines have 80 columns with one of "
                f"S, G, D, P, T in column 73; got {line[:80].strip()[:40]!r}"
            )
        if _SECTIONS.index(letter) < order:
            raise InputError(f"{name}, line {number}: section {letter} stands after {_SECTIONS[order]}")
        order = _SECTIONS.index(letter)
    if order != len(_SECTIONS) - 1:
        raise InputError(f"{name}: the file ends after line {len(lines)} without its T section: it is cut off")
    if not any(line[72] == "D" for line in lines):
        raise InputError(f"{name}: no entities; expected B-spline surfaces (entity 128)")
    comma, end = _check_global("".join(line[:72] for line in lines if line[72] == "G"), name)
    _check_numbers(lines, comma, end, name)


def check_step(text: str, name: str) -> None:
    """It begins and ends as STEP does."""
    if not text.lstrip().startswith("ISO-10303-21;"):
        raise InputError(f"{name}, line 1: no STEP file, which begins with ISO-10303-21; got {text[:40]!r}")
    if not re.search(r"END-ISO-10303-21\s*;\s*$", text):
        raise InputError(f"{name}: the file ends without END-ISO-10303-21; it is cut off")


def _check_global(text: str, name: str) -> tuple[str, str]:
    """Scale and unit of the global section: Open CASCADE ignores the one and guesses the other.

    Returns what parts values and what ends entities.
    """
    fields, comma, end = _global_fields(text)
    scale, flag, unit = (fields + [""] * 15)[12:15]
    if scale and not (_NUMBER.fullmatch(scale) and float(re.sub("[Dd]", "E", scale)) == 1.0):
        raise InputError(
            f"{name}, global field 13: the model space scale is {scale}; expected 1: numbers drawn to another scale "
            "are not the part's sizes. Write the model at full size."
        )
    if not flag.strip() and not unit.strip():
        return comma, end
    number = int(flag) if flag.strip().isdecimal() else 1 if not flag.strip() else 0
    known = [n for names in _UNITS.values() for n in names]
    wanted = known if number == _NAMED else list(_UNITS.get(number, ()))
    if not wanted:
        raise InputError(f"{name}, global field 14: the unit flag must be 1 to 11, got {flag.strip()!r}")
    if (unit.strip() or number == _NAMED) and unit.strip().upper() not in wanted:
        raise InputError(
            f"{name}, global field 15: unit {unit.strip()!r} where unit flag {number} wants {' or '.join(wanted)}"
        )
    return comma, end


def _global_fields(text: str) -> tuple[list[str], str, str]:
    """The fields of a global section, strings (8HSTRING) without their counts, and the two delimiters."""
    comma, end, at = ",", ";", 0
    fields: list[str] = []
    while at < len(text):
        counted = re.compile(r"\s*(\d+)H").match(text, at)
        if counted:
            stop = counted.end() + int(counted[1])
            value, at = text[counted.end() : stop], stop
        else:
            stop = min((i for i in (text.find(comma, at), text.find(end, at)) if i >= 0), default=len(text))
            value, at = text[at:stop].strip(), stop
        if not fields and counted:
            comma = value
        if len(fields) == 1 and counted:
            end = value
        fields.append(value)
        if text[at : at + 1] != comma:
            break
        at += 1
    return fields, comma, end


def _check_numbers(lines: list[str], comma: str, end: str, name: str) -> None:
    """Numbers only in entity 128, written as IGES wants them: Open CASCADE takes others for 0."""
    pointer, wanted = "", False
    for number, line in enumerate(lines, 1):
        if line[72] != "P":
            continue
        if line[64:72] != pointer:
            pointer, wanted = line[64:72], line.split(comma)[0].strip() == "128"
        values, *rest = line[:64].split(end)
        for value in values.split(comma) if wanted else []:
            if not _NUMBER.fullmatch(value.strip()):
                raise InputError(f"{name}, line {number}: entity 128 wants numbers, got {value.strip()!r}")
        wanted = wanted and not rest
