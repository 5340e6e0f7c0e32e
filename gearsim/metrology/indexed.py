"""What a program of one tooth space does with its tools and what holds them, once or indexed to all spaces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.holder import Holder
from gearsim.motion.segments import DEGREE
from gearsim.simulation.operation import Operation, Variant, turned_copies
from gearsim.simulation.sequence import in_sequence

_TOLERANCE = 1e-9
_ROWS, _POSES, _ALONG, _AROUND = 8, 33, 5, 24


def tools_and_holders(variant: Variant, copies: int) -> tuple[tuple[Operation, ...], tuple[Operation, ...]]:
    """Cutters by their flutes, and apart from them what stands above these, as operations of their own.

    ``copies`` times about the part's axis, each operation of the program in all spaces before the next one, and the
    steps counted on so; 1: as they are.
    """
    if copies == 1:
        given = variant.operations
        return tuple(o.by_flutes() for o in given), tuple(o.carried(_TOLERANCE) for o in given if o.holder is not None)
    cutters, holders, done = [], [], 0
    for once in in_sequence(variant):
        steps = 1 + int(once.step.max(initial=-1))
        cutters.append(_later(turned_copies(once.by_flutes(), copies), done))
        if once.holder is not None:
            holders.append(_later(turned_copies(once.carried(_TOLERANCE), copies), done))
        done += steps * copies
    return tuple(cutters), tuple(holders)


def _later(operation: Operation, steps: int) -> Operation:
    return replace(operation, step=operation.step + steps)


def deepest_in(operation: Operation, rows: NDArray[np.integer], points: NDArray) -> tuple[float, str]:
    """How far [mm] under the surface of an operation's tool points, shape (n, 3), come in some rows, and in which body.

    It is looked at in 33 poses of each row, of at most eight rows.
    """
    tip, axis = _poses(operation, rows)
    off = points - tip
    z = (off * axis).sum(axis=-1)
    r = np.linalg.norm(off - z[..., None] * axis, axis=-1)
    depth = -operation.cutter.signed_distance(r, z)
    deepest = int(np.argmax(depth))
    tool = operation.cutter
    body = tool.called(float(z.ravel()[deepest])) if isinstance(tool, Holder) else "cutter"
    return max(0.0, float(depth.ravel()[deepest])), body


def surface_points(operation: Operation, row: int) -> NDArray[np.floating]:
    """Points [mm] (n, 3) on the surface of an operation's tool, corners among them, in the move that a row is of."""
    elements = operation.cutter.elements
    element = np.repeat(np.arange(len(elements)), _ALONG)
    s = np.concatenate([np.linspace(0.0, e.length, _ALONG) for e in elements])
    meridian = operation.cutter.at(element, s)
    table = operation.table
    same = (table.path == table.path[row]) & (table.piece == table.piece[row])
    tip, axis = _poses(operation, np.flatnonzero(same))
    side = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis[..., 0, :]).mean(axis=0))])
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    angle = np.linspace(0.0, 2.0 * np.pi, _AROUND, endpoint=False)[:, None, None, None]
    out = np.cos(angle) * side + np.sin(angle) * np.cross(axis, side)
    found: NDArray[np.floating] = tip + meridian.z[:, None] * axis + meridian.r[:, None] * out
    return found.reshape(-1, 3)


def _poses(operation: Operation, rows: NDArray[np.integer]) -> tuple[NDArray, NDArray]:
    """Tips [mm] and axes, shape (n, 1, 3), in 33 poses of each of some rows, of at most eight of them."""
    rows = rows[np.linspace(0, len(rows) - 1, min(len(rows), _ROWS)).astype(int)]
    powers = np.vander(np.linspace(-1.0, 1.0, _POSES), DEGREE + 1, increasing=True)
    tip, axis = (np.einsum("xk,nkc->nxc", powers, c[rows]) for c in (operation.table.tip, operation.table.axis))
    return tip.reshape(-1, 1, 3), axis.reshape(-1, 1, 3)


def who(operation: Operation, row: int) -> str:
    """What the work that a row belongs to is called: by the program's heading where there are some."""
    return operation.headings[operation.section[row]] if operation.headings else operation.name


def where(operation: Operation, row: int, copies: int = 1) -> str:
    """In words the line of the program that a row stands in, or, where none is known, which of its moves it is.

    Of indexed ones it is told in which space, counted from that of the program.
    """
    copy, path = divmod(int(operation.table.path[row]), len(operation.sources) // copies)
    line, piece = int(operation.line[row]), int(operation.table.piece[row])
    told = f"in the move of line {line}" if line else f"in move {piece + 1} of its path {path + 1}"
    return told + (f", space {copy + 1}" if copies > 1 else "")
