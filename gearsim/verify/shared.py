"""Poses computed once however often they are asked for: planners that solve for each pose are slow."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.series import Series
from gearsim.motion.sources import MotionSource


@dataclass(frozen=True)
class SharedPoses:
    """The same motion; poses asked for several times in one call are computed once."""

    source: MotionSource

    @property
    def pieces(self) -> int:
        return self.source.pieces

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        where, again = np.unique(np.asarray(piece) + 1j * np.asarray(t, dtype=float), return_inverse=True)
        pose = self.source.pose(where.real.astype(int), where.imag, order)
        return PoseSeries(*(Series(series.c[:, again]) for series in pose))
