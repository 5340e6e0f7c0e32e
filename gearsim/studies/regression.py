"""Linear regression of a figure on all parameters at once: slopes, and standardised ones, with their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.stats import t

from gearsim.studies.factors import Factor, Floats, contrasts, dependent

CONFIDENCE = 0.95


class Estimate(NamedTuple):
    """A value with the ends of its 95 % interval; nan: there is none."""

    value: float = float("nan")
    low: float = float("nan")
    high: float = float("nan")

    def times(self, factor: float) -> Estimate:
        """The same in another unit."""
        low, high = sorted((float(self.low * factor), float(self.high * factor)))
        return Estimate(float(self.value * factor), low, high)


class Linear(NamedTuple):
    """``slopes``: the figure's change by one unit of each factor, the others held; ``standardised``: by standard
    deviations of both; nan of factors with more than two levels, which count in the fit. ``r2``: the share of the
    figure's variance that the fit describes, corrected for the number of its terms.
    """

    slopes: list[Estimate]
    standardised: list[Estimate]
    r2: float


def least_jobs(factors: Sequence[Factor]) -> int:
    """Fewer jobs leave nothing by which the fit's error could be told."""
    return 2 + sum(1 if f.ordered else len(f.levels) - 1 for f in factors)


def linear(factors: Sequence[Factor], y: Floats) -> Linear | None:
    """Least squares with an intercept; intervals of Student's t. None where factors say one another's values.

    ``y``, shape (jobs,): at least ``least_jobs``, not all alike.
    """
    columns = [_column(f) for f in factors]
    if dependent(columns):
        return None
    design = np.column_stack([np.ones(len(y)), *columns])
    free = len(y) - design.shape[1]
    q, r = np.linalg.qr(design)
    back = np.linalg.inv(r)
    found = back @ (q.T @ y)
    rest = float(np.sum((y - design @ found) ** 2))
    half = t.ppf(0.5 + 0.5 * CONFIDENCE, free) * np.sqrt(rest / free * np.sum(back**2, axis=1))
    total = float(np.sum((y - y.mean()) ** 2))
    slopes, standardised, at = [], [], 1
    for factor, column in zip(factors, columns, strict=True):
        width = column.shape[1] if column.ndim == 2 else 1
        spread = float(np.std(factor.values)) if factor.ordered else np.nan
        per_spread = found[at] if factor.ordered else np.nan
        one = Estimate(per_spread, per_spread - half[at], per_spread + half[at])
        slopes.append(one.times(1.0 / spread))
        standardised.append(one.times(1.0 / float(np.std(y))))
        at += width
    r2 = 1.0 - rest / total
    return Linear(slopes, standardised, 1.0 - (1.0 - r2) * (len(y) - 1) / free)


def _column(factor: Factor) -> Floats:
    """A factor in its standard deviations, or what tells its levels apart."""
    if factor.ordered:
        return (factor.values - factor.values.mean()) / np.std(factor.values)
    return contrasts(factor, 1)[0]
