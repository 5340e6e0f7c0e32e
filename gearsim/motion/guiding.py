"""Theoretical motion: the tool guided by two curves, one for its tip and one for a point up its axis.

Zhou 2015, 4.4 and 4.5. A point h [mm] up the axis moves with o_c' + h l', l being the normalised axis: the
printed (1 - h) o_c' + h o_t' needs h as a fraction of a constant distance between the curves (errata, 4.5).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import CurveMotion

# Points [mm], (order + 1, n, 3), as series in the path parameter, from parameter values (n,) and an order.
Curve = Callable[[NDArray, int], Series]


@dataclass(frozen=True)
class Guided:
    """Poses whose tip follows ``tip`` and whose axis points to ``top`` at the same parameter; called as a Curve is."""

    tip: Curve
    top: Curve

    def __call__(self, values: NDArray, order: int) -> PoseSeries:
        """Raises InputError where the curves meet."""
        below, above = self.tip(values, order), self.top(values, order)
        along = above - below
        length = np.linalg.norm(along.value, axis=-1)
        if len(length) and not length.min() > 1e-9:
            at = np.asarray(values)[int(length.argmin())]
            raise InputError(f"the guiding curves meet at parameter {at:g}: they must stay apart to give an axis")
        return PoseSeries(below, series.unit(along))


@dataclass(frozen=True)
class Line:
    """The straight line from ``start`` to ``end`` [mm], shape (3,), for parameters from 0 to 1."""

    start: NDArray[np.floating]
    end: NDArray[np.floating]

    def __call__(self, values: NDArray, order: int) -> Series:
        return Series.variable(values, order).column * (self.end - self.start) + self.start


def guided(tip: Curve, top: Curve, start: float = 0.0, end: float = 1.0) -> CurveMotion:
    """The motion whose tip follows ``tip`` and whose axis points to ``top`` at the same parameter.

    Both curves take path parameters from ``start`` to ``end``. Asked for a pose, it raises InputError where
    the curves meet.
    """
    return CurveMotion(Guided(tip, top), start, end)


def line(a: ArrayLike, b: ArrayLike) -> Curve:
    """The straight line from a to b [mm], shape (3,), for parameters from 0 to 1."""
    return Line(np.asarray(a, dtype=float), np.asarray(b, dtype=float))
