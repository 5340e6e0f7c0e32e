"""Where a stock and an intended solid differ along the stock's rays: what no end of the material itself may show."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.intervals import IntervalSet, concatenate, stretches, subtract
from gearsim.simulation.stock import AXES, Stock
from gearsim.surfaces.faced_solid import FacedPart
from gearsim.surfaces.machined_solid import MachinedSolid


class Difference(NamedTuple):
    """The ``middle`` [mm], shape (n, 3), of every stretch of a ray that only one of the two holds.

    ``unseen``: which of the solids taken from the intended body take nothing from it on any ray.
    """

    middle: NDArray[np.floating]
    unseen: tuple[int, ...]


def difference(intended: MachinedSolid | FacedPart, stock: Stock) -> Difference:
    """Compare them along all rays, to the ends of the stock's box.

    Where a piece of the part is missing as a whole, no end of the stock lies off the intended surface; its rays tell.
    """
    middle, seen = [], np.zeros(len(intended.minus), dtype=bool)
    for axis, left in zip(AXES, stock.left, strict=True):
        rays = stock.box.rays(axis)
        body = _inside(intended.body.chords(rays.origin, rays.direction), len(rays))
        meant = body
        for k, solid in enumerate(intended.minus):
            taken = _inside(solid.chords(rays.origin, rays.direction), len(rays))
            meant = subtract(meant, taken)
            seen[k] = seen[k] or subtract(body, taken).length < body.length
        apart = concatenate([subtract(meant, left), subtract(left, meant)])
        at = 0.5 * (apart.lo + apart.hi)[:, None]
        ray = apart.ray % len(rays)
        middle.append(rays.origin[ray] + at * rays.direction[ray])
    return Difference(np.concatenate(middle), tuple(np.flatnonzero(~seen).tolist()))


def _inside(chords: tuple[NDArray, NDArray, NDArray], rays: int) -> IntervalSet:
    return stretches(rays, *chords)
