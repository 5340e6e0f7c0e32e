"""CL data in APT words: read and written (ISO 3592/4343 style).

Words understood: PARTNO, PPRINT, UNITS/MM, CUTTER/d,r,e,f,a,b,h, MULTAX/ON, SPINDL, FEDRAT/f, COOLNT,
LOADTL, RAPID, FROM and GOTO/x,y,z,i,j,k, END, FINI; ``$$`` starts a comment, ``$`` at a line's end carries
it on. ``PPRINT PASS name`` names the cutting moves that follow.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import degrees, isfinite, radians

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.catalogue import apt
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError

_IGNORED = {"PARTNO", "PPRINT", "SPINDL", "COOLNT", "LOADTL", "END", "FINI", "MACHIN", "TOOLNO", "STOP", "MULTAX"}
_UNIT_AXIS = 1e-4
RAPID = "rapid"


@dataclass(frozen=True)
class CLPath:
    """Consecutive moves of one kind: ``tips`` [mm] and unit ``axes``, shape (n, 3), first point included.

    ``name`` is the pass's name, or RAPID for moves at rapid rate.
    """

    name: str
    tips: NDArray[np.floating]
    axes: NDArray[np.floating]


@dataclass(frozen=True)
class CLProgram:
    """A CL program: its paths in order, the cutter it declares and its slowest feed [mm/min] (None: none)."""

    paths: tuple[CLPath, ...]
    cutter: Profile | None = None
    feed: float | None = None

    def path(self, name: str) -> CLPath | None:
        """The first path of that name, or None."""
        return next((p for p in self.paths if p.name == name), None)


def parse_cl(text: str, name: str = "CL data") -> CLProgram:
    """Read CL data; ``name`` stands in the messages.

    Raises InputError naming line and word for anything it cannot use.
    """
    reader = _Reader(name)
    for number, word, values in _statements(text, name):
        reader.take(number, word, values)
    return reader.program()


def _statements(text: str, name: str) -> list[tuple[int, str, str]]:
    """(line number, word, text behind it) of every statement, comments dropped and lines joined."""
    out: list[tuple[int, str, str]] = []
    pending, start = "", 0
    for number, line in enumerate(text.splitlines(), 1):
        body = line.split("$$")[0].rstrip()
        start = start if pending else number
        if body.endswith("$"):
            pending += body[:-1]
            continue
        statement, pending = (pending + body).strip(), ""
        if statement:
            word, slash, rest = statement.partition("/")
            if not slash:
                word, _, rest = statement.partition(" ")
            out.append((start, word.strip().upper(), rest.strip()))
    if pending:
        raise InputError(f"{name}, line {start}: the file ends in a line to be continued ('$')")
    return out


class _Reader:
    """State of the modal CL language while it is read."""

    def __init__(self, name: str):
        self.name = name
        self.rapid = False
        self.label = "cut"
        self.cutter: Profile | None = None
        self.feed: float | None = None
        self.at: tuple[NDArray, NDArray] | None = None
        self.moves: list[tuple[str, list[NDArray], list[NDArray]]] = []

    def fail(self, line: int, message: str) -> InputError:
        return InputError(f"{self.name}, line {line}: {message}")

    def take(self, line: int, word: str, rest: str) -> None:
        if word in ("GOTO", "FROM"):
            self._goto(line, rest, moves=word == "GOTO")
        elif word == "RAPID":
            self.rapid = True
        elif word == "FEDRAT":
            feed = self._numbers(line, rest.split(",")[0], (1,), "FEDRAT/feed")
            if feed[0] <= 0.0:
                raise self.fail(line, f"FEDRAT/{feed[0]:g}: a feed must be positive")
            self.feed = min(feed[0], self.feed or feed[0])
        elif word == "UNITS":
            if rest.upper() != "MM":
                raise self.fail(line, f"UNITS/{rest}: only UNITS/MM is supported; convert the file to millimetres")
        elif word == "CUTTER":
            self._cutter(line, rest)
        elif word == "PPRINT" and rest.upper().startswith("PASS"):
            self.label = rest[4:].strip(" ,").lower() or "cut"
            if self.label == RAPID:
                raise self.fail(line, "a pass cannot be called 'rapid'; that names moves at rapid rate")
        elif word not in _IGNORED:
            raise self.fail(
                line, f"word {word!r} is not supported; supported are GOTO, FROM, RAPID, FEDRAT, CUTTER, "
                "UNITS and " + ", ".join(sorted(_IGNORED)),
            )  # fmt: skip

    def _numbers(self, line: int, rest: str, counts: tuple[int, ...], form: str) -> list[float]:
        fields = [f.strip() for f in rest.split(",")]
        numbers = []
        for f in fields:
            try:
                numbers.append(float(f))
            except ValueError:
                raise self.fail(line, f"{f!r} is not a number; expected {form}") from None
            if not isfinite(numbers[-1]):
                raise self.fail(line, f"{f} is not a finite number; expected {form}")
        if len(numbers) not in counts:
            raise self.fail(line, f"{len(numbers)} numbers; expected {form}")
        return numbers

    def _cutter(self, line: int, rest: str) -> None:
        d, r, e, f, alpha, beta, h = self._numbers(line, rest, (7,), "CUTTER/d,r,e,f,a,b,h")
        try:
            self.cutter = apt(d, r, e, f, radians(alpha), radians(beta), h)
        except InputError as error:
            raise self.fail(line, str(error)) from error

    def _goto(self, line: int, rest: str, moves: bool) -> None:
        values = self._numbers(line, rest, (3, 6), "GOTO/x,y,z or GOTO/x,y,z,i,j,k")
        tip = np.array(values[:3])
        if len(values) == 6:
            axis = np.array(values[3:])
            length = float(np.linalg.norm(axis))
            if abs(length - 1.0) > _UNIT_AXIS:
                raise self.fail(line, f"tool axis {rest.split(',', 3)[3]} has length {length:.6g}; expected 1")
            axis = axis / length
        else:
            axis = self.at[1] if self.at else np.array([0.0, 0.0, 1.0])
        if self.at is not None and moves:
            self._move(tip, axis)
        self.at = (tip, axis)
        self.rapid = self.rapid and not moves

    def _move(self, tip: NDArray, axis: NDArray) -> None:
        assert self.at is not None
        label = RAPID if self.rapid else self.label
        if np.array_equal(tip, self.at[0]) and np.array_equal(axis, self.at[1]):
            return
        goes_on = self.moves and self.moves[-1][0] == label and np.array_equal(self.moves[-1][1][-1], self.at[0])
        if not goes_on:
            self.moves.append((label, [self.at[0]], [self.at[1]]))
        self.moves[-1][1].append(tip)
        self.moves[-1][2].append(axis)

    def program(self) -> CLProgram:
        if not any(label != RAPID for label, _, _ in self.moves):
            raise InputError(f"{self.name}: no cutting moves; a path needs at least two GOTO points")
        paths = (CLPath(label, np.array(tips), np.array(axes)) for label, tips, axes in self.moves)
        return CLProgram(tuple(paths), self.cutter, self.feed)


def apt_parameters(cutter: Profile) -> tuple[float, ...]:
    """The seven APT parameters d, r, e, f [mm], a, b [deg], h [mm] of a cutter with a straight flank."""
    side = cutter.elements[cutter.flank]
    lower = cutter.elements[0]
    corner = next((e for e in cutter.elements if e.is_arc), None)
    beta = np.arctan2(side.end[0] - side.start[0], side.end[1] - side.start[1])
    alpha = 0.0 if lower.is_arc else np.arctan2(lower.end[1] - lower.start[1], lower.end[0] - lower.start[0])
    meet = (side.start[0] - side.start[1] * np.tan(beta)) / (1.0 - np.tan(alpha) * np.tan(beta))
    r, (e, f) = (corner.radius, corner.centre) if corner else (0.0, side.start)
    return 2.0 * meet, r, e, f, degrees(alpha), degrees(beta), cutter.height


def format_cl(program: CLProgram, title: str, feed_mm_min: float, decimals: int) -> str:
    """CL data as text with ``decimals`` digits behind the point."""
    lines = [f"PARTNO {title}", "UNITS/MM", "MULTAX/ON"]
    if program.cutter is not None:
        lines.append("CUTTER/" + ",".join(f"{v:.9g}" for v in apt_parameters(program.cutter)))
    for i, path in enumerate(program.paths):
        lines.append(f"$$ {len(path.tips) - 1} moves, {path.name}")
        rows = np.round(np.hstack([path.tips, path.axes]), decimals) + 0.0
        if i == 0:
            lines.append("FROM/" + ",".join(f"{v:.{decimals}f}" for v in rows[0]))
        if path.name != RAPID:
            lines += [f"PPRINT PASS {path.name}", f"FEDRAT/{feed_mm_min:g}"]
        for row in rows[1:]:
            lines += ["RAPID"] if path.name == RAPID else []
            lines.append("GOTO/" + ",".join(f"{v:.{decimals}f}" for v in row))
    return "\n".join([*lines, "FINI", ""])


def assemble(passes: list[CLPath], retract: float, cutter: Profile) -> CLProgram:
    """A program that runs cutting passes, with rapid moves along the tool axis before and after each.

    ``retract`` [mm] is how far the tool withdraws along its axis between the passes.
    """
    paths: list[CLPath] = []
    for path in passes:
        tips = [path.tips[0] + retract * path.axes[0], path.tips[0]]
        axes = [path.axes[0], path.axes[0]]
        if paths:
            tips.insert(0, paths[-1].tips[-1])
            axes.insert(0, paths[-1].axes[-1])
        end, end_axis = path.tips[-1], path.axes[-1]
        away = np.array([end, end + retract * end_axis])
        paths += [
            CLPath(RAPID, np.array(tips), np.array(axes)),
            path,
            CLPath(RAPID, away, np.array([end_axis, end_axis])),
        ]
    return CLProgram(tuple(paths), cutter)
