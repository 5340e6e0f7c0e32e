"""Power laws of error and time, and what they say of an error not measured."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from gearsim.errors import InputError


class Law(NamedTuple):
    """value = factor * resolution ** order."""

    factor: float
    order: float

    def at(self, resolution: float) -> float:
        """The value at a resolution."""
        return float(self.factor * resolution**self.order)

    def inverse(self, value: float) -> float:
        """The resolution that has a value."""
        return float((value / self.factor) ** (1.0 / self.order))


def fit_law(resolutions: Sequence[float], values: Sequence[float]) -> Law:
    """The straight line through the logarithms, by least squares.

    Raises InputError for fewer than two different resolutions, or values that have no logarithm.
    """
    x, y = np.asarray(resolutions, dtype=float), np.asarray(values, dtype=float)
    if len(np.unique(x)) < 2 or len(x) != len(y):
        raise InputError(f"a law needs values at two resolutions or more, got {len(y)} at {sorted(set(x.tolist()))}")
    if not np.all((x > 0.0) & (y > 0.0) & np.isfinite(y)):
        raise InputError(f"a law needs positive finite values, got {y.tolist()} at {x.tolist()}")
    order, offset = np.polyfit(np.log(x), np.log(y), 1)
    return Law(float(np.exp(offset)), float(order))


class Level(NamedTuple):
    """One run of a method: its resolution, CPU time [s], largest error [mm], rays hit by it or by us alone."""

    resolution: float
    seconds: float
    error: float
    lost: int


class Laws(NamedTuple):
    """How error and time go with resolution."""

    error: Law
    time: Law
    finest: float

    def seconds_at(self, error: float) -> float:
        """CPU time [s] for an error [mm]."""
        return self.time.at(self.error.inverse(error))

    def error_in(self, seconds: float) -> float:
        """Error [mm] after a CPU time [s]."""
        return self.error.at(self.time.inverse(seconds))

    def origin(self, error: float) -> str:
        """Whether an error [mm] lies within what was run."""
        return "interpolated" if self.error.inverse(error) <= self.finest else "extrapolated"


def fit_laws(levels: Sequence[Level]) -> Laws:
    """Both laws of a method's levels; raises InputError as ``fit_law`` does."""
    n = [level.resolution for level in levels]
    return Laws(fit_law(n, [x.error for x in levels]), fit_law(n, [x.seconds for x in levels]), max(n))
