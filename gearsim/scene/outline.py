"""Outlines of turned bodies: corners (radius, z), once around."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, Field

from gearsim.scene.tables import LengthOrZero

Coordinate = Annotated[float, Field(gt=-1e5, lt=1e5, allow_inf_nan=False)]
_Corners = tuple[tuple[LengthOrZero, Coordinate], ...]


def _holds_an_area(outline: _Corners) -> _Corners:
    corners = np.array(outline)
    after = np.roll(corners, -1, axis=0)
    for i in np.flatnonzero((corners == after).all(axis=1)):
        raise ValueError(f"corner {i + 1} of {len(corners)} is the next one too; name each once")
    for i, j in _meeting(corners, after):
        raise ValueError(f"it meets itself, after corner {i + 1} and after corner {j + 1}")
    r, z = corners.T
    if not abs(float(r @ np.roll(z, -1) - z @ np.roll(r, -1))) > 1e-12:
        raise ValueError("its corners enclose no area")
    return outline


def _meeting(start: NDArray, end: NDArray) -> NDArray:
    """Pairs (n, 2) of edges of an outline that meet and do not follow each other; the axis may be met."""
    way, n = end - start, len(start)

    def side(points: NDArray) -> NDArray:
        off = points - start[:, None]
        return np.sign(way[:, None, 0] * off[..., 1] - way[:, None, 1] * off[..., 0])

    parted = side(start) * side(end) <= 0.0
    lower, upper = np.minimum(start, end), np.maximum(start, end)
    near = (lower[:, None] <= upper).all(axis=-1) & (upper[:, None] >= lower).all(axis=-1)
    apart = np.subtract.outer(np.arange(n), np.arange(n)) % n
    solid = upper[:, 0] > 0.0
    other = (apart > 1) & (apart < n - 1) & solid & solid[:, None]
    return np.argwhere(np.triu(parted & parted.T & near & other))


Outline = Annotated[_Corners, Field(min_length=3), AfterValidator(_holds_an_area)]
