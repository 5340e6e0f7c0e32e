"""Which parameter matters for a figure of a study, and how far that can be trusted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.studies.expansion import expand
from gearsim.studies.factorial import analyse, is_whole
from gearsim.studies.factors import Factor, Floats, factors_of
from gearsim.studies.regression import Estimate, least_jobs, linear

DRAWN = ("latin-hypercube", "sobol", "monte-carlo")
NONE = Estimate()
_MOST_JOBS = 20_000
_TRUSTED = 0.5  # Q2: indices of a fit that predicts less are not told
_WELL = 0.9
_LINEAR = 0.7  # R2
_CORRELATED = 4.0  # standard errors of no correlation


@dataclass(frozen=True)
class Effect:
    """What a parameter does to a figure: shares of its variance, alone (``first``) and with others (``total``); by
    linear regression its change by a unit of the parameter (``slope``), and by standard deviations (``standardised``).
    """

    name: str
    first: Estimate = NONE
    total: Estimate = NONE
    slope: Estimate = NONE
    standardised: Estimate = NONE

    @property
    def size(self) -> float:
        """By which parameters are ranked, 0 to 1: the total share, else the square of the standardised coefficient."""
        if np.isfinite(self.total.value):
            return self.total.value
        return self.standardised.value**2 if np.isfinite(self.standardised.value) else 0.0


@dataclass(frozen=True)
class Importance:
    """All parameters' effects on a figure, the greatest first.

    ``shares_by``: ``expansion`` (Sobol indices), ``grid`` (analysis of variance) or empty: there are none.
    ``explained``: how well the expansion predicts jobs that it has not seen (Q2); ``r2``: of the linear regression,
    corrected for its terms; nan: there is none. ``together``: shares that two parameters make together, by their
    names. ``told``: sentences on what limits all this. ``deviation``: the figure's standard deviation.
    """

    figure: str
    effects: tuple[Effect, ...] = ()
    shares_by: str = ""
    explained: float = float("nan")
    r2: float = float("nan")
    together: tuple[tuple[str, float], ...] = ()
    used: int = 0
    left_out: int = 0
    deviation: float = float("nan")
    told: tuple[str, ...] = ()


def importance(
    figure: str, values: NDArray[Any], parameters: Mapping[str, NDArray[Any]], method: str, seed: int = 0,
    noise: float = 0.0,
) -> Importance:  # fmt: skip
    """What each parameter does to a figure.

    ``values`` of the figure, shape (jobs,), nan where a job has none: such jobs are left out, and counted.
    ``parameters``: each one's value in every job: numbers, words or truth values. ``method`` is the study's: what it
    drew has Sobol indices, a whole grid has its analysis of variance, and all have linear regression. A figure that
    varies by no more than ``noise`` is taken as constant.
    """
    y = np.asarray(values, dtype=float)
    good = np.isfinite(y)
    found = Importance(figure, used=int(good.sum()), left_out=int((~good).sum()))
    told = [f"{found.left_out:,} of {len(y):,} jobs have no value and are left out: what is said holds for the others"]
    told = told if found.left_out else []
    if found.used < 2 or np.ptp(y[good]) <= max(noise, 1e-12 * np.abs(y[good]).max(initial=0.0)):
        return replace(found, told=(*told, _constant(found.used, noise)), deviation=0.0)
    rows = np.flatnonzero(good)
    if len(rows) > _MOST_JOBS:
        rows = rows[:: -(-len(rows) // _MOST_JOBS)]
        told.append(f"reckoned from {len(rows):,} of the {found.used:,} jobs, evenly chosen")
    factors, joined = factors_of({name: np.asarray(v)[rows] for name, v in parameters.items()})
    found = replace(found, deviation=float(np.std(y[good])), told=(*told, *joined))
    return _ranked(_with_shares(_with_slopes(found, factors, y[rows]), factors, y[rows], method, seed))


def _constant(used: int, noise: float) -> str:
    if used < 2:
        return "fewer than two jobs have a value: nothing can be said"
    return f"the same in all jobs{f', to {noise:g}' if noise else ''}: no parameter matters"


def _ranked(found: Importance) -> Importance:
    return replace(found, effects=tuple(sorted(found.effects, key=lambda e: -e.size)))


def _with_slopes(found: Importance, factors: Sequence[Factor], y: Floats) -> Importance:
    """With linear regression, or why there is none."""
    found = replace(found, effects=tuple(Effect(f.name) for f in factors))
    if not factors:
        return replace(found, told=(*found.told, "no parameter varies"))
    need = least_jobs(factors)
    if len(y) < need:
        return _also(found, f"{len(y)} jobs are too few for a regression on {len(factors)} parameters: it needs {need}")
    fit = linear(factors, y)
    if fit is None:
        return _also(found, "parameters depend on one another linearly: a regression cannot tell their effects apart")
    rows = zip(found.effects, fit.slopes, fit.standardised, strict=True)
    found = replace(
        found, effects=tuple(replace(e, slope=s, standardised=b) for e, s, b in rows), r2=fit.r2
    )  # fmt: skip
    if fit.r2 < _LINEAR:
        r2 = f"R² {max(fit.r2, 0.0):.2f}"
        return _also(found, f"a linear regression does not explain the figure ({r2}): its slopes are averages over a "
                     "bend or a kink, or there is none")  # fmt: skip
    return found


def _with_shares(found: Importance, factors: Sequence[Factor], y: Floats, method: str, seed: int) -> Importance:
    """With shares of the variance, or why there are none."""
    if not factors:
        return found
    if method == "grid":
        if not is_whole(factors):
            return _also(found, "the grid is not whole, so that there is no analysis of variance")
        return _of_grid(found, factors, y)
    if method not in DRAWN:
        return _also(found, "a list has no distribution, so that there are no shares of variance")
    told = _correlations(factors)
    shares = expand(factors, y, seed)
    if shares is None:
        return _also(found, *told, f"{len(y)} jobs are too few for Sobol indices of {len(factors)} parameters")
    found = replace(found, explained=shares.explained)
    if shares.explained < _TRUSTED:
        q2 = f"Q² {max(shares.explained, 0.0):.2f}"
        return _also(found, *told, f"no polynomial predicts the figure ({q2}): there are no Sobol indices to be told")
    if shares.explained < _WELL:
        told.append(
            f"the expansion predicts {100.0 * shares.explained:.0f} % of the variance in jobs left out; "
            "the rest is in no index"
        )
    rows = zip(found.effects, shares.first, shares.total, strict=True)
    found = replace(found, effects=tuple(replace(e, first=a, total=b) for e, a, b in rows), shares_by="expansion")
    return _also(found, *told)


def _of_grid(found: Importance, factors: Sequence[Factor], y: Floats) -> Importance:
    of = analyse(factors, y)
    rows = zip(found.effects, of.main, of.total, strict=True)
    effects = tuple(replace(e, first=Estimate(a), total=Estimate(b)) for e, a, b in rows)
    pairs = sorted(((f"{factors[i].name} with {factors[j].name}", s) for (i, j), s in of.pairs.items()),
                   key=lambda pair: -pair[1])  # fmt: skip
    more = [("three and more together", of.more)] * (len(factors) > 2)
    return replace(found, effects=effects, shares_by="grid", together=(*pairs, *more))


def _correlations(factors: Sequence[Factor]) -> list[str]:
    """Parameters that were drawn together, which Sobol indices do not allow for."""
    told = []
    for i, a in enumerate(factors):
        for b in factors[:i]:
            if a.ordered and b.ordered:
                r = float(np.corrcoef(a.values, b.values)[0, 1])
                if abs(r) > _CORRELATED / np.sqrt(len(a.values)):
                    told.append(f"{b.name} and {a.name} are correlated ({r:+.2f}): their shares run into one another")
    return told


def _also(found: Importance, *sentences: str) -> Importance:
    return replace(found, told=(*found.told, *sentences))
