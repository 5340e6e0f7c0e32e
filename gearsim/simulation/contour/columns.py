"""Which nodes of a lattice are material, as runs of nodes along its columns."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.intervals import IntervalSet


@dataclass(frozen=True)
class Columns:
    """Runs of material nodes along the last index of a lattice of ``shape`` nodes; one bundle alone decides.

    Run m is the nodes ``begin[m]`` to ``end[m]`` (not itself) of the column with number ``column[m]`` (second index
    fastest); runs rise, and no two of a column touch. ``begin_row``, ``end_row``: the interval that begins and ends
    there. Nodes around the lattice are empty, but where its first index is ``periodic``. Walls and gaps that lie
    between two nodes of a column are not seen: ``walls`` and ``gaps`` are their lengths together [mm].
    """

    shape: tuple[int, int, int]
    column: NDArray[np.integer]
    begin: NDArray[np.integer]
    end: NDArray[np.integer]
    begin_row: NDArray[np.integer]
    end_row: NDArray[np.integer]
    walls: float
    gaps: float
    periodic: bool = False


def columns(
    shape: tuple[int, int, int], heights: NDArray, material: IntervalSet, periodic: bool = False
) -> Columns:  # fmt: skip
    """Runs of nodes at ``heights`` [mm along the rays, rising] within intervals of material, ends at nodes included
    where these begin; one ray a column."""
    begin, end = (np.searchsorted(heights, at) for at in (material.lo, material.hi))
    rows = np.flatnonzero(end > begin)
    thin = material.hi - material.lo
    walls = float(thin.sum() - thin[rows].sum())
    column, begin, end = material.ray[rows], begin[rows], end[rows]
    joined = np.append((column[1:] == column[:-1]) & (begin[1:] == end[:-1]), False)[: len(rows)]
    gaps = float((material.lo[rows[1:]] - material.hi[rows[:-1]])[joined[:-1]].sum())
    opens, closes = ~np.append(False, joined[:-1])[: len(rows)], ~joined
    return Columns(
        shape, column[opens], begin[opens], end[closes], rows[opens], rows[closes], walls, gaps, periodic
    )  # fmt: skip
