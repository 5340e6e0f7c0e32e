"""Analysis of variance of a grid: the shares of main effects, and of what parameters make together."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from gearsim.studies.factors import Factor, Floats


class Effects(NamedTuple):
    """Of a figure's variance over the grid: ``main``, the share of each factor alone (eta squared); ``total``: with
    what it makes together with others; ``pairs``, the share of two together by their places; ``more``, of three and
    more together. They are exact on this grid: nothing was drawn, and there are no intervals.
    """

    main: list[float]
    total: list[float]
    pairs: dict[tuple[int, int], float]
    more: float


def is_whole(factors: Sequence[Factor]) -> bool:
    """Whether every combination of values occurs, all equally often."""
    codes = np.column_stack([np.unique(f.values, return_inverse=True)[1] for f in factors])
    found, times = np.unique(codes, axis=0, return_counts=True)
    return len(found) == int(np.prod([f.count for f in factors])) and len(set(times.tolist())) == 1


def analyse(factors: Sequence[Factor], y: Floats) -> Effects:
    """The shares of a figure ``y``, shape (jobs,), not all alike, over a whole grid."""
    codes = [np.unique(f.values, return_inverse=True)[1] for f in factors]
    every = range(len(factors))
    variance = float(np.var(y))

    def of(which: Sequence[int]) -> float:
        """The variance of the means over all else, as a share."""
        cells = np.zeros(len(y), dtype=np.int64)
        for i in which:
            cells = cells * (1 + int(codes[i].max())) + codes[i]
        _, cell, times = np.unique(cells, return_inverse=True, return_counts=True)
        means = np.bincount(cell, y - y.mean()) / times
        return float(np.sum(times * means**2) / len(y)) / variance

    main = [of([i]) for i in every]
    total = [1.0 - of([j for j in every if j != i]) for i in every]
    pairs = {(i, j): of([i, j]) - main[i] - main[j] for i, j in combinations(every, 2)}
    more = max(0.0, of(list(every)) - sum(main) - sum(pairs.values()))
    return Effects(main, total, pairs, more)
