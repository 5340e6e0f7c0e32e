"""Material along parallel rays as an area: strips from ray to ray, their ends joined by straight lines.

So an edge that is almost parallel to the rays is drawn without steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.section import Section

_SLIVER = 1e-5  # mm of material: what tools that just meet leave between them


class Strips(NamedTuple):
    """Material in a plane: ``quads`` (n, 4, 2) [mm] that cover it, and their free ``edges`` (m, 2, 2) [mm]."""

    quads: NDArray
    edges: NDArray


def section_strips(
    section: Section, every: int = 1, x: tuple[float, float] = (-np.inf, np.inf),
    y: tuple[float, float] = (-np.inf, np.inf),
) -> Strips:  # fmt: skip
    """What is left in a section between two x and two y [mm], by one ray of ``every``."""
    left = section.left
    ray, low, high = left.ray, *(np.clip(section.start + end, *x) for end in (left.lo, left.hi))
    chosen = np.arange(len(section.y)) % every == 0
    chosen &= (section.y >= y[0]) & (section.y <= y[1])
    kept = (high - low > _SLIVER) & chosen[ray]
    row = np.cumsum(chosen) - 1
    return strips(section.y[chosen], row[ray[kept]], low[kept], high[kept])


def strips(y: NDArray, ray: NDArray, low: NDArray, high: NDArray) -> Strips:
    """Strips of intervals from ``low`` to ``high`` on rays at rising, evenly spaced ``y``, sorted by ray and place.

    Where an interval and one of the next ray meet each other alone, a strip leads from one to the other; elsewhere both
    end half way.
    """
    apart = float(np.diff(y).mean()) if len(y) > 1 else 0.0
    above = _partner(ray, low, high, 1)
    back = _partner(ray, low, high, -1)
    joined = np.flatnonzero((above >= 0) & (back[above] == np.arange(len(ray))))
    after = above[joined]
    upper, lower = np.ones(len(ray), dtype=bool), np.ones(len(ray), dtype=bool)
    upper[joined], lower[after] = False, False
    ends, begins = np.flatnonzero(upper), np.flatnonzero(lower)
    pairs = [
        (joined, y[ray[joined]], after, y[ray[after]]),
        (ends, y[ray[ends]], ends, y[ray[ends]] + 0.5 * apart),
        (begins, y[ray[begins]] - 0.5 * apart, begins, y[ray[begins]]),
    ]
    quads = np.concatenate([_quads(low, high, *pair) for pair in pairs])
    caps = np.concatenate([quads[len(joined) : len(joined) + len(ends), 2:], quads[len(joined) + len(ends) :, :2]])
    return Strips(quads, np.concatenate([quads[:, [0, 3]], quads[:, [1, 2]], caps]))


def _partner(ray: NDArray, low: NDArray, high: NDArray, step: int) -> NDArray:
    """The one interval of the ray so many further that overlaps each, -1 where there is none or several."""
    if not len(ray):
        return np.empty(0, dtype=int)
    shift = float(low.min())
    wide = 4.0 * (float(high.max()) - shift + 1.0)  # more than any ray's length: places on one line, ray after ray
    first = np.searchsorted(wide * ray + high - shift, wide * (ray + step) + low - shift, side="right")
    last = np.searchsorted(wide * ray + low - shift, wide * (ray + step) + high - shift, side="left")
    return np.where(last - first == 1, np.minimum(first, len(ray) - 1), -1)


def _quads(low: NDArray, high: NDArray, a: NDArray, ya: NDArray, b: NDArray, yb: NDArray) -> NDArray:
    """Quads from intervals ``a`` at heights ``ya`` to intervals ``b`` at ``yb``."""
    corners = [(low[a], ya), (high[a], ya), (high[b], yb), (low[b], yb)]
    return np.stack([np.stack(corner, axis=-1) for corner in corners], axis=1)
