"""What a study varied, made ready to be held against a figure: numbers, or levels that have names."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
_ALIKE = 1e-10  # of 1: what the correlation of two that are one misses


@dataclass(frozen=True)
class Factor:
    """A parameter, or several that move together, with its value in each job, shape (jobs,).

    Of values that are no numbers ``levels`` names each, and ``values`` are places among them.
    """

    name: str
    values: Floats
    levels: tuple[str, ...] = ()

    @property
    def ordered(self) -> bool:
        """Whether half its range means anything: numbers, and two levels, of which one comes after the other."""
        return len(self.levels) <= 2

    @property
    def count(self) -> int:
        """Different values."""
        return len(np.unique(self.values))


def factors_of(columns: Mapping[str, NDArray[Any]]) -> tuple[list[Factor], list[str]]:
    """The parameters that vary, those that move together as one; and sentences on what had to be left out or joined."""
    made = [_factor(name, values) for name, values in columns.items()]
    constant = [f.name for f in made if f.count < 2]
    told = [f"{', '.join(constant)}: the same in all jobs that count, so that nothing can be said of it"] * bool(
        constant
    )
    kept: list[Factor] = []
    for factor in (f for f in made if f.count > 1):
        twin = next((i for i, other in enumerate(kept) if _together(other, factor)), None)
        if twin is None:
            kept.append(factor)
        else:
            kept[twin] = Factor(f"{kept[twin].name} and {factor.name}", kept[twin].values, kept[twin].levels)
    told += [f"{f.name} move together: their effects cannot be told apart" for f in kept if f.name not in columns]
    return kept, told


def _factor(name: str, values: NDArray[Any]) -> Factor:
    if np.asarray(values).dtype.kind in "iuf":
        return Factor(name, np.asarray(values, dtype=float))
    words = np.array([str(v).lower() if isinstance(v, bool | np.bool_) else str(v) for v in values], dtype=object)
    levels, codes = np.unique(words.astype(str), return_inverse=True)
    return Factor(name, codes.astype(float), tuple(map(str, levels)))


def _together(a: Factor, b: Factor) -> bool:
    """Whether the one says what the other is: by a straight line, or value by value where values recur."""
    n, first, second = len(a.values), a.count, b.count
    if first == second < n:
        return len(np.unique(np.column_stack([a.values, b.values]), axis=0)) == first
    numbers = a.ordered and b.ordered
    return numbers and abs(np.corrcoef(a.values, b.values)[0, 1]) > 1.0 - _ALIKE


def contrasts(factor: Factor, degree: int) -> tuple[Floats, NDArray[np.int_]]:
    """Functions of a factor, (jobs, n), that are orthonormal over the jobs and to 1; and the degree of each.

    Polynomials of numbers up to a degree; of levels as many as tell them apart, all of degree 1.
    """
    n = len(factor.values)
    if factor.ordered:
        top = min(degree, factor.count - 1)
        low, high = factor.values.min(), factor.values.max()
        raw = np.polynomial.legendre.legvander((2.0 * factor.values - low - high) / (high - low), top)
        degrees = np.arange(1, top + 1)
    else:
        raw = np.column_stack([np.ones(n), *(factor.values == k for k in range(1, len(factor.levels)))])
        degrees = np.ones(len(factor.levels) - 1, dtype=int)
    q, _ = np.linalg.qr(raw)
    return np.sqrt(n) * q[:, 1:], degrees


def dependent(columns: Sequence[Floats]) -> bool:
    """Whether columns, shape (jobs,) or (jobs, n), together with 1 say one another's values."""
    design = np.column_stack([np.ones(len(columns[0])), *columns])
    size = np.linalg.svd(design / np.linalg.norm(design, axis=0), compute_uv=False)
    return bool(size[-1] < 1e-9 * size[0])
