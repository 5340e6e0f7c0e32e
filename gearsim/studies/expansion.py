"""Sobol indices from the jobs as they were drawn, by a polynomial chaos expansion whose fit is cross-validated.

Sobol, Math. Comput. Simulation 55 (2001) 271-280; from an expansion's coefficients: Sudret, Reliab. Eng. Syst. Saf. 93
(2008) 964-979. The polynomials are orthonormal over the values that were drawn, whatever their distribution.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.studies.factors import Factor, Floats, contrasts
from gearsim.studies.regression import Estimate

_MOST_TERMS = 300
_JOBS_A_TERM = 3
_DEGREES = (1, 2, 3, 4, 5, 6, 8, 10)
_BETTER = 0.9  # of the unexplained share: a larger expansion that leaves more of it is not worth its terms
_ENOUGH = 1e-4  # of the variance: what is left of it is not looked for
_RESAMPLES = 100
_GROUPS = 100
_TWO_SIDED = 1.959964  # of the normal distribution, 95 %


class Shares(NamedTuple):
    """``first``: the share of the figure's variance that each factor makes alone; ``total``: with what it makes
    together with others. ``explained``: Q2, the share of the variance that the expansion predicts in jobs left out
    one by one; what it misses is in no index. ``degree``, ``terms``: of the expansion.
    """

    first: list[Estimate]
    total: list[Estimate]
    explained: float
    degree: int
    terms: int


class _Fit(NamedTuple):
    design: Floats  # (jobs, 1 + terms), the first column 1
    owners: NDArray[np.int_]  # (terms, 2): the factors of each term, the second -1 where it has one
    degree: int
    explained: float


def expand(factors: Sequence[Factor], y: Floats, seed: int = 0) -> Shares | None:
    """First-order and total Sobol indices of independent factors on a figure ``y``, shape (jobs,), not all alike.

    The expansion has terms of one factor and of pairs, up to the degree that predicts left-out jobs best. Intervals
    (95 %) are from the standard error over resampled jobs, the expansion's terms being held: they do not hold what it
    misses. None where there are fewer than three jobs a term even of the first degree.
    """
    fit = _best(factors, y)
    if fit is None:
        return None
    first, total = _indices(fit, len(factors), *_squares(fit.design, y))
    errors = np.std(_resampled(fit, len(factors), y, seed), axis=0, ddof=1)
    return Shares(
        _estimates(first, errors[0]), _estimates(total, errors[1]), fit.explained, fit.degree, len(fit.owners)
    )


def _estimates(values: Floats, errors: Floats) -> list[Estimate]:
    half = _TWO_SIDED * errors
    ends = np.clip(np.column_stack([values, values - half, values + half]), 0.0, 1.0)
    return [Estimate(*row) for row in ends.tolist()]


def _best(factors: Sequence[Factor], y: Floats) -> _Fit | None:
    """The expansion that predicts left-out jobs best; one with more terms must do so clearly."""
    best: _Fit | None = None
    for design, owners, degree in _candidates(factors, min(_MOST_TERMS, len(y) // _JOBS_A_TERM)):
        explained = _cross_validated(design, y)
        if best is None or 1.0 - explained < _BETTER * (1.0 - best.explained):
            best = _Fit(design, owners, degree, explained)
        if 1.0 - best.explained < _ENOUGH:
            break
    return best


def _candidates(factors: Sequence[Factor], most: int) -> Iterator[tuple[Floats, NDArray[np.int_], int]]:
    """Designs of rising degree, each without pairs and with them, of no more than ``most`` columns."""
    bases = [contrasts(f, _DEGREES[-1]) for f in factors]
    for degree in _DEGREES:
        fresh = any((degrees == degree).any() for _, degrees in bases) or degree <= len(factors)
        for pairs in (False, True) if fresh else ():
            terms = list(_terms([d for _, d in bases], degree, pairs and degree > 1))
            if len(terms) + 1 <= most and not (pairs and degree == 1):
                columns = [_product(bases, term) for term in terms]
                owners = np.array([(t[0][0], t[1][0] if len(t) > 1 else -1) for t in terms])
                yield np.column_stack([np.ones(len(factors[0].values)), *columns]), owners, degree


def _terms(
    degrees: Sequence[NDArray[np.int_]], most: int, pairs: bool
) -> Iterator[tuple[tuple[int, int], ...]]:  # fmt: skip
    """Terms as (factor, function) each, of one factor or two."""
    for i, own in enumerate(degrees):
        for a in np.flatnonzero(own <= most):
            yield ((i, int(a)),)
    for i, j in combinations(range(len(degrees)), 2) if pairs else ():
        for a, b in np.argwhere(np.add.outer(degrees[i], degrees[j]) <= most):
            yield (i, int(a)), (j, int(b))


def _product(bases: Sequence[tuple[Floats, NDArray[np.int_]]], term: tuple[tuple[int, int], ...]) -> Floats:
    return np.prod([bases[i][0][:, a] for i, a in term], axis=0)


def _cross_validated(design: Floats, y: Floats) -> float:
    """Q2 with every job left out once, which a linear fit tells from its projection; -inf where it cannot be."""
    found, inverse = _solved(design, y)
    kept = 1.0 - np.einsum("ij,ij->i", design @ inverse, design)
    if kept.min() < 1e-9:
        return float("-inf")
    return float(1.0 - np.mean(((y - design @ found) / kept) ** 2) / np.var(y))


def _squares(design: Floats, y: Floats) -> tuple[Floats, float]:
    """Squares of the terms' coefficients less what noise alone would make them, shape (terms,); and the noise."""
    found, inverse = _solved(design, y)
    noise = float(np.sum((y - design @ found) ** 2)) / (len(y) - design.shape[1])
    return (found**2 - noise * np.diag(inverse))[1:], noise


def _solved(design: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Coefficients, and the inverse of the normal equations' matrix, which is well posed: terms are near orthonormal.

    Not by a QR decomposition: its threads wait for one another at every step where cores are busy.
    """
    inverse = np.linalg.pinv(design.T @ design, rcond=1e-10, hermitian=True)
    return np.asarray(inverse @ (design.T @ y)), np.asarray(inverse, dtype=float)


def _indices(fit: _Fit, count: int, squares: Floats, noise: float) -> tuple[Floats, Floats]:
    """First-order and total indices, shape (factors,) each.

    Shares of the variance that independent factors and noise make, whatever correlations chance gave those drawn.
    """
    variance = squares.sum() + noise
    alone = fit.owners[:, 1] < 0
    first = np.bincount(fit.owners[alone, 0], squares[alone], count)
    total = first + sum(np.bincount(fit.owners[~alone, k], squares[~alone], count) for k in (0, 1))
    return first / variance, total / variance


def _resampled(fit: _Fit, count: int, y: Floats, seed: int) -> Floats:
    """Indices, shape (resamples, 2, factors), of jobs drawn anew from the jobs: by groups of them where there are many.

    The groups' normal equations are added up, so that a resample costs no look at the jobs.
    """
    rng = np.random.default_rng([seed, 2])
    groups = np.array_split(rng.permutation(len(y)), min(len(y), _GROUPS))
    squares = np.array([fit.design[g].T @ fit.design[g] for g in groups])
    sides = np.array([fit.design[g].T @ y[g] for g in groups])
    sums = np.array([(len(g), (y[g] ** 2).sum()) for g in groups])
    drawn = rng.multinomial(len(groups), np.full(len(groups), 1.0 / len(groups)), _RESAMPLES)
    return np.array([_resample(fit, count, w, squares, sides, sums) for w in drawn.astype(float)])


def _resample(
    fit: _Fit, count: int, weights: Floats, squares: Floats, sides: Floats, sums: Floats
) -> tuple[Floats, Floats]:
    jobs, sum_of_squares = weights @ sums
    side = weights @ sides
    matrix = np.tensordot(weights, squares, 1)
    matrix[np.diag_indices_from(matrix)] += 1e-9 * jobs  # where a resample holds too few different jobs
    found = np.linalg.solve(matrix, side)
    noise = max(0.0, sum_of_squares - found @ side) / max(1.0, jobs - len(found))
    return _indices(fit, count, (found**2 - noise / jobs)[1:], noise)
