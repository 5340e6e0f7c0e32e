"""Moves as the program states them, before the machine: what the interpreter hands on."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

RAPID, FEED, CLOCKWISE, COUNTER_CLOCKWISE, DWELL = 0, 1, 2, 3, 4
Arc = tuple[float, float, float, float, float]
NO_ARC = (np.nan, np.nan, np.nan, np.nan, 1.0)


class Mode(NamedTuple):
    """What holds for all moves of a batch.

    ``tip``: linear values are the tip on the workpiece (else slides); ``excess``: how far the tip stands above
    the programmed one along the tool [mm]; ``feed_mode`` 93, 94, 95; ``scale``: mm in a unit of length, and
    ``feed_scale`` in one of the F word, which may be older than G20 or G21; ``spindle`` [1/min]; ``plane`` 17,
    18, 19; ``arc_absolute``: I J K are the centre itself.
    """

    tip: bool
    excess: float
    feed_mode: int
    scale: float
    feed_scale: float
    spindle: float
    plane: int
    arc_absolute: bool
    tool: int
    operation: int


class Moves(NamedTuple):
    """A batch of moves that begins at ``start`` (k,) and ends at ``ends`` (n, k) [mm, rad].

    ``motion`` (n,) as above; ``feed`` (n,) the F word in force (of a dwell: seconds); ``arcs`` (n, 5) I J K R
    [mm], nan where absent, and P turns (None: no arcs); ``line`` (n,) of the program.
    """

    mode: Mode
    start: NDArray[np.floating]
    ends: NDArray[np.floating]
    motion: NDArray[np.integer]
    feed: NDArray[np.floating]
    arcs: NDArray[np.floating] | None
    line: NDArray[np.integer]

    @property
    def before(self) -> NDArray[np.floating]:
        """Where each move begins, (n, k)."""
        return np.concatenate([self.start[None], self.ends[:-1]])
