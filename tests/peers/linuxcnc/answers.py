"""The peer's answers as data: a packed text with one line a program.

``name digest refused moves``: the digest is that of the program and its control; a move is its kind, the axes that
change, and what belongs to the kind (t seconds, u v centre, s sweep, p plane).
"""

from __future__ import annotations

import hashlib
import lzma
import math
import re
from dataclasses import dataclass
from pathlib import Path

from tests.peers.linuxcnc.control import AXES, Control
from tests.peers.linuxcnc.moves import Move

_WORD = re.compile(r"([A-Za-z])([-+.\d]+(?:e[-+]?\d+)?|nan)")
FILE = Path(__file__).parents[2] / "data" / "gcode" / "linuxcnc" / "answers.txt.xz"


@dataclass(frozen=True)
class Kept:
    """What is kept of an answer: the digest of what was asked, whether the peer refused, the moves it made."""

    digest: str
    refused: bool
    moves: list[Move]


def digest(program: str, control: Control) -> str:
    """Names a program on its control."""
    return hashlib.sha256(f"{program}\0{control}".encode()).hexdigest()[:10]


def save(answers: dict[str, Kept], file: Path = FILE) -> None:
    """Write the answers."""
    rows = [f"{name.replace(' ', ':')} {k.digest} {int(k.refused)} {_packed(k.moves)}" for name, k in answers.items()]
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_bytes(lzma.compress("\n".join(rows).encode(), preset=9))


def load(file: Path = FILE) -> dict[str, Kept]:
    """Read the answers."""
    rows = (row.split(" ", 3) for row in lzma.decompress(file.read_bytes()).decode().splitlines())
    return {name.replace(":", " "): Kept(key, refused == "1", _moves(moves)) for name, key, refused, moves in rows}


def _packed(moves: list[Move]) -> str:
    found, before = [], (0.0,) * 6
    for move in moves:
        parts = [move.kind[0]]
        parts += [f"{axis}{_number(v)}" for axis, v, b in zip(AXES, move.end, before, strict=True) if abs(v - b) > 2e-8]
        before = tuple(v if abs(v - b) > 2e-8 else b for v, b in zip(move.end, before, strict=True))
        if move.kind != "rapid":
            parts.append(f"t{move.seconds:.8g}")
        if move.kind == "arc":
            parts.append(f"u{_number(move.centre[0])}v{_number(move.centre[1])}s{move.sweep:.7g}p{move.plane}")
        found.append("".join(parts))
    return ",".join(found)


def _moves(packed: str) -> list[Move]:
    found, end = [], dict.fromkeys(AXES, 0.0)
    for part in filter(None, packed.split(",")):
        told = {
            letter: float(value) for letter, value in re.findall(r"([A-Za-z])([-+.\d]+(?:e[-+]?\d+)?|nan)", part[1:])
        }
        end |= {axis: told[axis] for axis in AXES if axis in told}
        kind = {"r": "rapid", "f": "feed", "a": "arc", "d": "dwell"}[part[0]]
        centre = (told.get("u", 0.0), told.get("v", 0.0))
        place, plane = tuple(end.values()), int(told.get("p", 17))
        found.append(Move(kind, place, told.get("t", math.nan), centre, told.get("s", 0.0), plane))
    return found


def _number(value: float) -> str:
    return f"{value:.7f}".rstrip("0").rstrip(".")
