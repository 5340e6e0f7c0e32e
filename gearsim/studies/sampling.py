"""The values of all jobs of a study: on a grid, from lists, or drawn; the same on every machine.

Everything is drawn before the first job, so that neither chunks nor workers change a value. Of ``monte-carlo`` every
key has a stream of its own: another key beside it changes nothing, and more samples go on where fewer end.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product
from math import prod
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from gearsim.scene.study import MOST_JOBS, StudyHeader, VaryTable, mistaken
from gearsim.studies import quantiles
from gearsim.studies.records import Parameter, Value

Floats = NDArray[np.float64]
Row = tuple[Value, ...]


def parameters(header: StudyHeader, varied: Sequence[VaryTable], label: str) -> tuple[Parameter, ...]:
    """Every varied key with its value in each job.

    Raises InputError where lists are of different lengths, a grid has too many jobs, or bounds leave nothing of a
    distribution.
    """
    if header.method == "grid":
        columns = _grid([_rows(v) for v in varied], label)
    elif header.method == "list":
        columns = _side_by_side([_rows(v) for v in varied], varied, label)
    else:
        shares = _shares(header, varied)
        columns = [_drawn(v, u, f"vary.{i}", label) for i, (v, u) in enumerate(zip(varied, shares, strict=True))]
    return tuple(
        Parameter(key, _alike([row[k] for row in column]), *_bounds(vary))
        for vary, column in zip(varied, columns, strict=True)
        for k, key in enumerate(vary.names)
    )


def told(header: StudyHeader) -> tuple[str, ...]:
    """What a user should know of the samples."""
    n = header.samples or 0
    if header.method != "sobol" or n & (n - 1) == 0:
        return ()
    less, more = 2 ** (n.bit_length() - 1), 2 ** n.bit_length()
    return (
        f"study.samples: {n} is no power of two, and a Sobol sequence is balanced at powers of two alone; {less} or "
        f"{more} would be",
    )


def _rows(vary: VaryTable) -> list[Row]:
    """Listed values, one of each key in a row, or even steps."""
    if vary.count is None:
        return [tuple(row) for row in vary.rows]
    share = np.arange(vary.count) / (vary.count - 1)
    return [(x,) for x in _by_distribution(vary, share).tolist()]


def _grid(rows: Sequence[list[Row]], label: str) -> list[list[Row]]:
    """Every combination; the first table's values change last."""
    count = prod(map(len, rows))
    if count > MOST_JOBS:
        sizes = " x ".join(str(len(r)) for r in rows)
        raise mistaken(label, [
            f"vary: the grid has {sizes} = {count:,} jobs; expected no more than {MOST_JOBS:,}: fewer values, or a "
            "method that draws its samples"
        ])  # fmt: skip
    return [list(column) for column in zip(*product(*rows), strict=True)]


def _side_by_side(rows: Sequence[list[Row]], varied: Sequence[VaryTable], label: str) -> list[list[Row]]:
    """The i-th values of all tables together."""
    if len({len(r) for r in rows}) > 1:
        lengths = ", ".join(f"{' and '.join(v.names)} {len(r)}" for v, r in zip(varied, rows, strict=True))
        raise mistaken(label, [f"vary: a list takes the first values together, then the second ones; got {lengths}"])
    return list(rows)


def _shares(header: StudyHeader, varied: Sequence[VaryTable]) -> list[Floats]:
    """Shares in [0, 1) of each table's distribution, shape (samples,) each."""
    n, seed, width = header.samples or 0, header.seed, len(varied)
    if header.method == "monte-carlo":
        return [np.random.default_rng([seed, *(crc32(k.encode()) for k in v.names)]).random(n) for v in varied]
    rng = np.random.default_rng(seed)
    if header.method == "latin-hypercube":
        return list(qmc.LatinHypercube(width, seed=rng).random(n).T)
    sequence = qmc.Sobol(width, seed=rng)
    return list(sequence.random_base2((n - 1).bit_length())[:n].T)


def _drawn(vary: VaryTable, share: Floats, where: str, label: str) -> list[Row]:
    """Values at shares of a distribution; of a list, all entries alike."""
    if vary.drawn is None:
        rows = _rows(vary)
        return [rows[i] for i in np.minimum((share * len(rows)).astype(int), len(rows) - 1)]
    values = _by_distribution(vary, share)
    if np.isnan(values).any():
        raise mistaken(label, [f"{where} ({vary.key}): between lower and upper the distribution has nothing"])
    return [(x,) for x in values.tolist()]


def _by_distribution(vary: VaryTable, share: Floats) -> Floats:
    v: Any = vary
    if vary.distribution == "normal":
        lower, upper = (-np.inf if v.lower is None else v.lower), (np.inf if v.upper is None else v.upper)
        return quantiles.normal(share, v.mean, v.deviation, lower, upper)
    if vary.distribution == "triangular":
        return quantiles.triangular(share, v.low, v.mode, v.high)
    if vary.distribution == "tolerance":  # three deviations to either end
        return quantiles.normal(share, v.nominal, v.tolerance / 3.0, v.nominal - v.tolerance, v.nominal + v.tolerance)
    return (quantiles.log_uniform if v.scale == "log" else quantiles.uniform)(share, v.low, v.high)


def _bounds(vary: VaryTable) -> tuple[float, float]:
    """Between which values a table's are drawn; nan where nothing bounds them."""
    if vary.drawn == "tolerance":
        assert vary.nominal is not None
        assert vary.tolerance is not None
        return vary.nominal - vary.tolerance, vary.nominal + vary.tolerance
    ends = (vary.lower, vary.upper) if vary.drawn == "normal" else (vary.low, vary.high)
    low, high = (float("nan") if end is None else end for end in ends)
    return low, high


def _alike(values: list[Value]) -> tuple[Value, ...]:
    """Whole numbers among others as decimal ones, so that a column has one type."""
    if any(isinstance(v, float) for v in values):
        return tuple(map(float, values))
    return tuple(values)
