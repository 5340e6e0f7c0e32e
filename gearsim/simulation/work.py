"""What an operation did to a stock."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.operation import Operation


class RapidTouch(NamedTuple):
    """The first row by rapid that takes material: where [mm] (3,) it takes most along a ray, and how much [mm]."""

    row: int
    place: NDArray[np.floating]
    depth: float


class Work(NamedTuple):
    """An operation that was done: the ``volume`` [mm³] that each of its rows was the first to take, (rows,).

    It is the mean of the three bundles of a coarser box; nan where rows are not cut in order (rings). ``left`` [mm³]
    after it, by bundle of the fine box, whose rays all look for the ``touch`` of the first rapid that goes through
    material; ``near`` counts the rows by rapid that are not for certain clear of the uncut blank.
    """

    operation: Operation
    volume: NDArray[np.floating]
    left: tuple[float, float, float]
    touch: RapidTouch | None
    near: int
