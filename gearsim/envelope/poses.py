"""An exact motion as a table of power series for the kernels, true to rounding.

The rates of tip and axis are interpolated at Chebyshev's nodes on equal spans of each piece, halved until the last
coefficients end at rounding, and integrated: so the rates, which the grazing condition lives on, keep the source's
relative accuracy even where the tool hardly moves. The removal road's segment table is another one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial.chebyshev import cheb2poly
from numpy.typing import NDArray

from gearsim.errors import NumericalError
from gearsim.geometry.grazing import AT_REST
from gearsim.kernels import exact_pose
from gearsim.motion.sources import MotionSource

BEYOND = float(exact_pose.BEYOND)

_NODES = 9
_FINEST = 10
_ROUNDING = 4e-15
_NOISE = 1e-10
_SHRINKS = 16.0
_NOTHING = 8e-16

_ANGLES = np.pi * (np.arange(_NODES) + 0.5) / _NODES
_X = np.where(np.arange(_NODES) == _NODES // 2, 0.0, np.cos(_ANGLES))
_TO_CHEBYSHEV = 2.0 / _NODES * np.cos(np.outer(np.arange(_NODES), _ANGLES))
_TO_CHEBYSHEV[0] *= 0.5
_TO_POWERS = np.stack([np.pad(cheb2poly([0.0] * k + [1.0]), (0, _NODES - 1 - k)) for k in range(_NODES)], axis=1)


@dataclass(frozen=True)
class PoseTable:
    """Power series of tip [mm] and axis by x in [-1, 1], shape (spans, terms, 3), on equal spans of the pieces.

    Piece i has the spans ``first[i]`` to ``first[i + 1]``, which cover t = -0.5 to 1.5; span k has the first
    ``terms[k]`` coefficients, the rest are zero.
    """

    tip: NDArray[np.floating]
    axis: NDArray[np.floating]
    terms: NDArray[np.integer]
    first: NDArray[np.integer]


def pose_table(source: MotionSource, reach: float) -> PoseTable:
    """The table of a motion for a tool of some reach [mm], by which the axis's errors are weighed.

    Raises NumericalError where a piece is not smooth.
    """
    waiting = np.arange(source.pieces)
    before = np.full(source.pieces, np.inf)
    done: list[tuple[NDArray, NDArray, NDArray, NDArray]] = []
    for level in range(_FINEST + 1):
        count = 1 << level
        series, terms, tail, smooth = _spans(source, waiting, count, reach)
        stalled = (tail > before[waiting] / _SHRINKS) & (tail < _NOISE)
        good = smooth & ((tail < _ROUNDING) | stalled)
        done.append((waiting[good], np.full(good.sum(), count), series[good], terms[good]))
        before[waiting] = tail
        waiting = waiting[~good]
        if not len(waiting):
            return _joined(source.pieces, done)
    raise NumericalError(
        f"the motion is not smooth on piece {waiting[0] + 1} of {source.pieces}: the envelope road needs poses with a "
        "derivative; break the path where its velocity jumps"
    )


def _spans(
    source: MotionSource, pieces: NDArray, count: int, reach: float
) -> tuple[NDArray, NDArray, NDArray, NDArray]:  # fmt: skip
    """Series (piece, span, term, tip and axis), their numbers of terms, the largest tail of each piece in shares of its
    rate (0 where the tool stands still), and whether the poses are finite where the piece itself lies."""
    half = (0.5 + BEYOND) / count
    middle = -BEYOND + half * (2.0 * np.arange(count) + 1.0)
    t = (middle[:, None] + half * _X).ravel()
    tip, axis = source.pose(np.repeat(pieces, len(t)), np.tile(t, len(pieces)), 1)
    value, rate = (np.concatenate([tip.c[i], axis.c[i]], axis=1).reshape(-1, count, _NODES, 6) for i in (0, 1))
    constant = half * rate[:, :, [_NODES // 2]]
    chebyshev = np.einsum("kj,pcji->pcki", _TO_CHEBYSHEV, half * rate - constant)  # constant rates stay without noise
    chebyshev[:, :, [0]] += constant
    size = np.linalg.norm(chebyshev[..., :3], axis=-1) + reach * np.linalg.norm(chebyshev[..., 3:], axis=-1)
    scale = np.nanmax(size, axis=(1, 2), initial=0.0)
    needed = np.arange(1, _NODES + 1) * (size > _NOTHING * scale[:, None, None])
    terms = 1 + needed.max(axis=2)
    powers = np.einsum("kj,pcji->pcki", _TO_POWERS, np.where(needed[..., None] > 0, chebyshev, 0.0))
    series = np.concatenate([value[:, :, [_NODES // 2]], powers / np.arange(1, _NODES + 1)[:, None]], axis=2)
    with np.errstate(invalid="ignore", divide="ignore"):
        moves = scale > AT_REST
        tail = np.where(moves[:, None], size[..., -2:].sum(axis=2) / scale[:, None], 0.0)
    tail = np.nan_to_num(tail, nan=0.0)
    inner = (middle + half > 0.0) & (middle - half < 1.0)
    finite = np.isfinite(size).all(axis=2)
    return series, terms, tail.max(axis=1), finite[:, inner].all(axis=1)


def _joined(pieces: int, done: list[tuple[NDArray, NDArray, NDArray, NDArray]]) -> PoseTable:
    """The spans of all pieces in their order."""
    counts = np.empty(pieces, dtype=int)
    for piece, count, *_ in done:
        counts[piece] = count
    first = np.concatenate([[0], np.cumsum(counts)])
    series = np.empty((first[-1], _NODES + 1, 6))
    terms = np.empty(first[-1], dtype=np.int32)
    for piece, count, some, number in done:
        if len(piece):
            rows = first[piece][:, None] + np.arange(count[0])
            series[rows], terms[rows] = some, number
    return PoseTable(series[..., :3].copy(), series[..., 3:].copy(), terms, first)
