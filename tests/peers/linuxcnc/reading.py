"""The moves that gearsim's reader makes of a program, in the peer's form."""

from __future__ import annotations

import math

from gearsim.programs.gcode import read_program
from tests.peers.linuxcnc.control import AXES, MACHINE, Control
from tests.peers.linuxcnc.moves import Move, stands

NORMALS = {2: (17, 0, 1), 1: (18, 2, 0), 0: (19, 1, 2)}


def read(program: str, control: Control) -> list[Move]:
    """Read a program. Raises ProgramError where the reader refuses it."""
    blocks = read_program(program, MACHINE, dialect="linuxcnc", settings=control.settings()).blocks
    place = control.offsets.get("G54", {})
    zero = [place.get(axis, 0.0) for axis in AXES]
    columns = [AXES.index(axis) for axis in MACHINE.axes]
    found: list[Move] = []
    nose = (0.0,) * 6
    for i in range(len(blocks)):
        end = zero[:]
        for column, value in zip(columns, blocks.values[i], strict=True):
            end[column] += math.degrees(value) if column > 2 else float(value)
        length = control.tools.get(int(blocks.tool[i]), 0.0)
        end[2] += length
        for column in set(range(6)) - set(columns):
            end[column] = 0.0
        kind = "rapid" if blocks.rapid[i] else "arc" if blocks.sweep[i] else "feed"
        seconds = float(blocks.seconds[i])
        plane, a, b = NORMALS[int(blocks.normal[i])]
        middle = blocks.centre[i] + zero[:3] + [0.0, 0.0, length]
        if kind == "arc":
            move = Move("arc", tuple(end), seconds, (float(middle[a]), float(middle[b])), float(blocks.sweep[i]), plane)
        else:
            move = Move(kind, tuple(end), seconds)
        if kind == "feed" and stands(move, nose) and seconds > 0.0:
            move = Move("dwell", tuple(end), seconds)
        if not stands(move, nose):
            found.append(move)
        nose = move.end
    return found
