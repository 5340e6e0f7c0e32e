"""The uniform table of quintic segments that every motion is compiled into for the kernels."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from math import radians

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import NumericalError
from gearsim.geometry.rigid import Rigid
from gearsim.motion.sources import CLMotion, CLMotions, MotionSource

DEGREE = 5
_NODES = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
_TO_MONOMIAL = np.linalg.inv(np.vander(_NODES, increasing=True))
_CHECKS = np.linspace(-0.95, 0.95, 11)
_POWERS = np.arange(DEGREE + 1)


@dataclass(frozen=True)
class SegmentTable:
    """Quintic segments; row i is the pose for x in [-1, 1] as sum of coefficient[k] x^k.

    ``tip`` [mm] and ``axis`` have shape (n, 6, 3). ``speed`` [mm], ``acceleration`` [mm] and ``spin``
    [rad] bound, over x in [-1, 1], the fastest tool point's velocity, the second derivative, as the tool sees it,
    of a fixed point that the row's tool reaches anywhere, and the axis rotation rate. ``piece``, ``start``,
    ``end`` say where a row lies in its source; ``path`` numbers the source when tables are joined.
    """

    tip: NDArray[np.floating]
    axis: NDArray[np.floating]
    speed: NDArray[np.floating]
    acceleration: NDArray[np.floating]
    spin: NDArray[np.floating]
    piece: NDArray[np.integer]
    start: NDArray[np.floating]
    end: NDArray[np.floating]
    path: NDArray[np.integer]

    def __len__(self) -> int:
        return len(self.speed)

    def part(self, chosen: NDArray | slice) -> SegmentTable:
        """The rows of a slice, index array or mask."""
        return SegmentTable(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})

    def moved(self, rigid: Rigid) -> SegmentTable:
        """The same motion in another frame; exact up to rounding."""
        tip = rigid.direction(self.tip)
        tip[:, 0] += rigid.translation
        values = {f.name: getattr(self, f.name) for f in fields(self)}
        return SegmentTable(**{**values, "tip": tip, "axis": rigid.direction(self.axis)})


def join(tables: list[SegmentTable]) -> SegmentTable:
    """One table of several; ``path`` becomes the index of the table a row came from."""
    columns = {f.name: np.concatenate([getattr(t, f.name) for t in tables]) for f in fields(SegmentTable)}
    columns["path"] = np.repeat(np.arange(len(tables)), [len(t) for t in tables])
    return SegmentTable(**columns)


def compile_motion(
    source: MotionSource, reach: float, tolerance: float = 1e-9, max_rotation: float = radians(0.5)
) -> SegmentTable:
    """Interpolate an exact motion by quintics that share their end poses.

    ``reach`` [mm] is the largest distance of a tool point from the tip; ``tolerance`` [mm] bounds the
    position error of that point (checked between the nodes); ``max_rotation`` [rad] bounds the axis
    rotation of a row, so that a swept interval has a single minimum on it. Raises NumericalError where
    the motion is too rough to be met by 2^12 parts a piece.
    """
    return _compiled(source, np.full(source.pieces, reach), tolerance, max_rotation)


def compile_cl(
    motions: Sequence[CLMotion], reaches: Sequence[float], tolerance: float = 1e-9,
    max_rotation: float = radians(0.5),
) -> list[SegmentTable]:  # fmt: skip
    """Each motion's table as ``compile_motion`` makes it with its own reach, all motions interpolated at once.

    Raises NumericalError where one of them cannot be compiled.
    """
    pieces = np.array([m.pieces for m in motions])
    first = np.cumsum(pieces) - pieces
    table = _compiled(CLMotions(tuple(motions)), np.repeat(reaches, pieces), tolerance, max_rotation)
    rows = np.searchsorted(table.piece, np.append(first, pieces.sum()))
    parts = (table.part(slice(a, b)) for a, b in pairwise(rows))
    return [replace(part, piece=part.piece - f) for part, f in zip(parts, first, strict=True)]


def _compiled(source: MotionSource, reach: NDArray, tolerance: float, max_rotation: float) -> SegmentTable:
    """See ``compile_motion``; ``reach`` [mm] of each piece, shape (pieces,)."""
    piece = np.arange(source.pieces)
    start, end = np.zeros(source.pieces), np.ones(source.pieces)
    done: list[tuple[NDArray, ...]] = []
    for _ in range(13):
        tip, axis = _interpolate(source, piece, start, end)
        bad = _error(source, piece, start, end, tip, axis, reach[piece]) > tolerance
        bad |= 2.0 * _bound(axis, 1) > max_rotation
        done.append((tip[~bad], axis[~bad], piece[~bad], start[~bad], end[~bad]))
        middle = 0.5 * (start + end)[bad]
        piece = np.repeat(piece[bad], 2)
        start, end = _interleave(start[bad], middle), _interleave(middle, end[bad])
        if not len(piece):
            return _finish(done, reach)
    raise NumericalError(
        f"the motion cannot be compiled to {tolerance:g} mm: piece {piece[0] + 1} is still off after 4096 "
        "parts; loosen the tolerance or check the path for a jump"
    )


def _interleave(a: NDArray, b: NDArray) -> NDArray:
    return np.stack([a, b], axis=1).ravel()


def _sample(source: MotionSource, piece: NDArray, start: NDArray, end: NDArray, x: NDArray) -> tuple[NDArray, NDArray]:
    """Exact tips and axes, shape (n, len(x), 3), at local parameters x of every part."""
    t = start[:, None] + 0.5 * (end - start)[:, None] * (1.0 + x)
    pose = source.pose(np.repeat(piece, len(x)), t.ravel(), 0)
    shape = (len(piece), len(x), 3)
    return pose.tip.value.reshape(shape), pose.axis.value.reshape(shape)


def _interpolate(source: MotionSource, piece: NDArray, start: NDArray, end: NDArray) -> tuple[NDArray, NDArray]:
    tip, axis = _sample(source, piece, start, end, _NODES)
    return np.einsum("kj,njc->nkc", _TO_MONOMIAL, tip), np.einsum("kj,njc->nkc", _TO_MONOMIAL, axis)


def _error(
    source: MotionSource, piece: NDArray, start: NDArray, end: NDArray,
    tip: NDArray, axis: NDArray, reach: NDArray,
) -> NDArray:  # fmt: skip
    """Largest position error [mm] of the farthest tool point at the check points, shape (n,)."""
    true_tip, true_axis = _sample(source, piece, start, end, _CHECKS)
    powers = np.vander(_CHECKS, DEGREE + 1, increasing=True)
    tip_error = np.linalg.norm(np.einsum("xk,nkc->nxc", powers, tip) - true_tip, axis=2)
    axis_error = np.linalg.norm(np.einsum("xk,nkc->nxc", powers, axis) - true_axis, axis=2)
    return (tip_error + reach[:, None] * axis_error).max(axis=1, initial=0.0)


def _bound(coefficients: NDArray, derivative: int) -> NDArray:
    """Bound of |d^k p / dx^k| on [-1, 1] by the sum of the coefficients' lengths, shape (n,)."""
    factor = np.ones(DEGREE + 1)
    for k in range(derivative):
        factor *= _POWERS - k
    return np.linalg.norm(coefficients, axis=2) @ factor


def _finish(parts: list[tuple[NDArray, ...]], reach_of_piece: NDArray) -> SegmentTable:
    tip, axis, piece, start, end = (np.concatenate(column) for column in zip(*parts, strict=True))
    order = np.lexsort((start, piece))
    tip, axis, piece, start, end = tip[order], axis[order], piece[order], start[order], end[order]
    travel, spin, reach = _bound(tip, 1), _bound(axis, 1), reach_of_piece[piece]
    arm = reach + 2.0 * (travel + spin * reach)
    acceleration = _bound(tip, 2) + arm * (_bound(axis, 2) + spin**2) + 2.0 * spin * travel
    path = np.zeros(len(tip), dtype=np.int64)
    return SegmentTable(tip, axis, travel + spin * reach, acceleration, spin, piece, start, end, path)
