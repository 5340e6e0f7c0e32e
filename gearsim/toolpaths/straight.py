"""Toolpaths along straight lines with the axis along z: drilled holes and milled lines."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Move(NamedTuple):
    """A way of the tip, ``tips`` (n, 3) [mm], and whether it is by rapid."""

    tips: NDArray[np.floating]
    rapid: bool


def drilled(places: Sequence[tuple[float, float]], clear: float, bottom: float, peck: float | None) -> Iterator[Move]:
    """Holes one after the other: down in feed from ``clear`` to ``bottom`` [mm], all up by rapid in between.

    With ``peck`` [mm] the feed goes that deep at a time; down again it goes by rapid as deep as the hole is.
    """
    before = None
    for x, y in places:
        if before is not None:
            yield Move(np.array([[*before, clear], [x, y, clear]]), True)
        before = (x, y)
        steps = 1 if peck is None else ceil((clear - bottom) / peck - 1e-9)
        depths = [clear, *np.linspace(clear, bottom, steps + 1)[1:]]
        for above, below in itertools.pairwise(depths):
            if above < clear:
                yield Move(np.array([[x, y, clear], [x, y, above]]), True)
            yield Move(np.array([[x, y, above], [x, y, below]]), False)
            yield Move(np.array([[x, y, below], [x, y, clear]]), True)


def milled(points: Sequence[tuple[float, float, float]], clear: float) -> Iterator[Move]:
    """Through points in feed, down to the first and up from the last; the feed begins ``clear`` [mm] up."""
    x, y, z = points[0]
    yield Move(np.array([[x, y, clear], [x, y, z], *points[1:]]), False)
    x, y, z = points[-1]
    yield Move(np.array([[x, y, z], [x, y, clear]]), True)


def from_above(moves: Sequence[Move], top: float) -> Iterator[Move]:
    """Moves between a rapid down to their start and one up from their end, from and to ``top`` [mm] if that is higher.

    Between them the tool is as high as the blank at least, so that nothing is in its way from one operation to another.
    """
    start, end = moves[0].tips[0], moves[-1].tips[-1]
    if start[2] < top:
        yield Move(np.array([[*start[:2], top], start]), True)
    yield from moves
    if end[2] < top:
        yield Move(np.array([end, [*end[:2], top]]), True)
