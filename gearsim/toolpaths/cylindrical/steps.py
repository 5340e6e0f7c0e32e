"""Where along a flank a pass has its points."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from gearsim.toolpaths.counts import check_count

Spacing = Literal["arc", "roll"]


def roll_points(base_radius: float, start: float, end: float, step: float, spacing: Spacing) -> NDArray:
    """Roll angles [rad] from ``start`` to ``end`` in equal parts, shape (n,), n >= 2.

    ``spacing`` "arc": parts of at most ``step`` mm of the involute's length R_b xi² / 2 (Groover 2.11, 2.12); "roll":
    of at most ``step`` rad. (The thesis takes full steps and leaves a rest at the end.)
    """
    if spacing == "roll":
        return np.linspace(start, end, parts(abs(end - start), step) + 1)
    half = 0.5 * base_radius
    count = parts(half * abs(end * end - start * start), step)
    rolls = np.sqrt(np.linspace(start * start, end * end, count + 1))
    rolls[[0, -1]] = start, end
    return rolls


def with_points(rolls: NDArray, wanted: Sequence[float]) -> NDArray:
    """Rolls that rise or fall, with those of the ``wanted`` ones between their ends."""
    between = [w for w in wanted if min(rolls[0], rolls[-1]) < w < max(rolls[0], rolls[-1])]
    every = np.unique(np.concatenate([rolls, between]))
    return every if rolls[0] <= rolls[-1] else every[::-1]


def parts(length: float, step: float) -> int:
    """Into how many equal parts of at most ``step`` a length is divided. Raises InputError for too many."""
    check_count(length, step, "mm (or rad of roll)")
    return max(1, ceil(length / step - 1e-9))


def descent(top: float, bottom: float, step: float) -> NDArray:
    """Heights [mm] of passes below ``top`` down to ``bottom``, in equal steps; ``top`` itself cuts nothing (3.8)."""
    return np.linspace(top, bottom, parts(top - bottom, step) + 1)[1:]
