"""A program as reading its written text gives it, without the text: numbers rounded, moves of one kind in one path."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.programs.cldata.frame import UNIT_AXIS, unit_axis
from gearsim.programs.cldata.program import CLPath, CLProgram


def as_read(program: CLProgram, decimals: int) -> CLProgram:
    """The paths that ``parse_cl(format_cl(program, ..., decimals))`` has, bit by bit; lines, times and feeds unknown.

    Raises InputError where so few decimals leave an axis no unit vector, ValueError for coordinates so large that a
    number does not hold their digits.
    """
    found: list[tuple[str, int, list[NDArray]]] = []
    at: NDArray | None = None
    tool = -1
    for path in program.paths:
        rows = np.round(np.hstack([path.tips, path.axes]), decimals) + 0.0
        if not np.abs(rows).max() < 2.0**52 / 10.0**decimals:
            raise ValueError(f"coordinates of 2^52 units of 1e-{decimals} mm and more are not rounded so")
        rows[:, 3:] = _unit(rows[:, 3:])
        if path.tool != tool:
            at, tool = rows[0], path.tool
        assert at is not None
        points = np.vstack([at, rows[1:]])
        moved = np.append(False, (points[1:] != points[:-1]).any(axis=1))
        at = points[-1]
        if not moved.any():
            continue
        if not (found and found[-1][:2] == (path.name, tool) and np.array_equal(found[-1][2][-1][-1], points[0])):
            found.append((path.name, tool, [points[:1]]))
        found[-1][2].append(points[moved])
    joined = ((name, tool, np.vstack(points)) for name, tool, points in found)
    return CLProgram(tuple(CLPath(name, p[:, :3], p[:, 3:], tool) for name, tool, p in joined), program.tools)


def _unit(axes: NDArray) -> NDArray:
    """Stated axes, shape (n, 3), as unit vectors."""
    length = np.sqrt(np.vecdot(axes, axes))
    wrong = np.abs(length - 1.0) > UNIT_AXIS
    if wrong.any():
        unit_axis(axes[np.argmax(wrong)])
    return np.asarray(axes / length[:, None])
