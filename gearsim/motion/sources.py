"""Exact motions: the tool's pose as a smooth function of t in [0, 1] on each piece of the path.

The envelope road reads these; the removal road reads only the table compiled from them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.series import Series

_UNIT = 1e-9


class MotionSource(Protocol):
    """A path of ``pieces`` smooth pieces; consecutive ones meet in one pose, where the velocity may jump."""

    @property
    def pieces(self) -> int: ...

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        """Poses at t (0 to 1, may be exceeded slightly) of the given pieces, both shape (n,)."""
        ...


@dataclass(frozen=True)
class CurveMotion:
    """One smooth piece, given by a function of a path parameter from ``start`` to ``end``.

    ``curve`` takes parameter values, shape (n,), and an order, and returns the pose as series in that
    parameter (Zhou 2015, section 4.1.2, theoretical cutter motion).
    """

    curve: Callable[[NDArray, int], PoseSeries]
    start: float
    end: float

    @property
    def pieces(self) -> int:
        return 1

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        span = self.end - self.start
        tip, axis = self.curve(self.start + span * np.asarray(t, dtype=float), order)
        scale = (span ** np.arange(order + 1))[:, None, None]
        return PoseSeries(Series(tip.c * scale), Series(axis.c * scale))


@dataclass(frozen=True)
class CLMotion:
    """CL points joined by straight tip lines while the axis turns at a constant rate (Zhou 4.6-4.13).

    ``tips`` [mm] and unit ``axes`` have shape (n, 3), n >= 2. The axis is written with cosine and sine of
    the swept angle, so that a step without rotation needs no special case (4.12 divides by sin gamma).
    Raises InputError for other shapes, numbers that are not finite, axes not of unit length to 1e-9, and opposite
    consecutive axes, whose plane of rotation is undefined.
    """

    tips: NDArray[np.floating]
    axes: NDArray[np.floating]

    def __post_init__(self) -> None:
        tips, axes = np.shape(self.tips), np.shape(self.axes)
        if tips != axes or len(tips) != 2 or tips[1] != 3:
            raise InputError(f"CL points: tips and axes have shapes {tips} and {axes}; expected (n, 3) both")
        if len(self.tips) < 2:
            raise InputError(f"a CL path needs at least 2 points, got {len(self.tips)}")
        wrong = ~np.isfinite(self.tips).all(axis=1) | ~(np.abs(np.linalg.norm(self.axes, axis=1) - 1.0) <= _UNIT)
        if wrong.any():
            i = int(np.argmax(wrong))
            raise InputError(
                f"CL point {i + 1}: tip {self.tips[i]} and axis {self.axes[i]}; expected finite numbers and a unit axis"
            )
        opposite = np.flatnonzero(self._turns[0] > np.pi - 1e-6)
        if len(opposite):
            i = int(opposite[0])
            raise InputError(
                f"CL points {i + 1} and {i + 2} have opposite tool axes: the axis could turn any way round; "
                "put a point between them"
            )

    @cached_property
    def _turns(self) -> tuple[NDArray, NDArray]:
        """Swept angle [rad] of each step and the unit vector its axis starts to move along."""
        a, b = self.axes[:-1], self.axes[1:]
        across = b - (a * b).sum(1, keepdims=True) * a
        sine = np.linalg.norm(across, axis=1)
        angle = np.arctan2(sine, (a * b).sum(1))
        return angle, across / np.where(sine > 0.0, sine, 1.0)[:, None]

    @property
    def pieces(self) -> int:
        return len(self.tips) - 1

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        return _cl_pose(self.steps, np.asarray(piece), t, order)

    @property
    def steps(self) -> tuple[NDArray, ...]:
        """Of each piece the tip, its way, the axis, its swept angle and the unit vector it starts to move along."""
        return self.tips[:-1], np.diff(self.tips, axis=0), self.axes[:-1], *self._turns


@dataclass(frozen=True)
class CLMotions:
    """Many CL motions as one, the pieces of each behind those of the one before; they need not meet."""

    motions: tuple[CLMotion, ...]

    @cached_property
    def _steps(self) -> list[NDArray]:
        return [np.concatenate(part) for part in zip(*(m.steps for m in self.motions), strict=True)]

    @property
    def pieces(self) -> int:
        return len(self._steps[0])

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        return _cl_pose(self._steps, np.asarray(piece), t, order)


def _cl_pose(steps: Sequence[NDArray], piece: NDArray, t: NDArray, order: int) -> PoseSeries:
    """Poses of CL pieces, given by ``CLMotion.steps``."""
    tips, ways, axes, angle, sideways = steps
    time = Series.variable(t, order)
    turn = series.exp(time * (1j * angle[piece]))
    tip = time.column * ways[piece] + tips[piece]
    axis = turn.real.column * axes[piece] + turn.imag.column * sideways[piece]
    return PoseSeries(tip, axis)


@dataclass(frozen=True)
class MovedMotion:
    """A motion carried along by a rigid (or mirrored) displacement of the whole scene."""

    source: MotionSource
    rigid: Rigid

    @property
    def pieces(self) -> int:
        return self.source.pieces

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        tip, axis = self.source.pose(piece, t, order)
        moved = Series(self.rigid.direction(tip.c)) + self.rigid.translation
        return PoseSeries(moved, Series(self.rigid.direction(axis.c)))
