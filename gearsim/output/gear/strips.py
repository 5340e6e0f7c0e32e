"""Material along parallel rays as an area: strips from ray to ray, their ends joined by straight lines.

So an edge that is almost parallel to the rays is drawn without steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.simulation.section import Section

_LONGEST = 32  # times that distance: half of a strip
_SLIVER = 1e-5  # mm of material: what tools that just meet leave between them


class Strips(NamedTuple):
    """Material in a plane: ``quads`` (n, 4, 2) [mm] that cover it, and their free ``edges`` (m, 2, 2) [mm]."""

    quads: NDArray
    edges: NDArray


def section_strips(
    section: Section, off: float, x: tuple[float, float] = (-np.inf, np.inf),
    y: tuple[float, float] = (-np.inf, np.inf),
) -> Strips:  # fmt: skip
    """What is left in a section between two x and two y [mm]; ``off`` as of strips."""
    left = section.left
    ray, low, high = left.ray, *(np.clip(section.start + end, *x) for end in (left.lo, left.hi))
    chosen = (section.y >= y[0]) & (section.y <= y[1])
    kept = (high - low > _SLIVER) & chosen[ray]
    row = np.cumsum(chosen) - 1
    return strips(section.y[chosen], row[ray[kept]], low[kept], high[kept], off)


def strips(y: NDArray, ray: NDArray, low: NDArray, high: NDArray, off: float) -> Strips:
    """Strips of intervals from ``low`` to ``high`` on rays at rising, evenly spaced ``y``, sorted by ray and place.

    Where an interval and one of the next ray meet each other alone, a strip leads from one to the other; elsewhere both
    end half way. Intervals in line with those before and after, at most ``off`` [mm] beside it, are passed over.
    """
    apart = float(np.diff(y).mean()) if len(y) > 1 else 0.0
    above, back, every = _partner(ray, low, high, 1), _partner(ray, low, high, -1), np.arange(len(ray))
    joined = (above >= 0) & (back[above] == every)
    above, below = np.where(joined, above, -1), np.full(len(ray), -1)
    below[above[joined]] = every[joined]
    kept = _pass_over_straight(ray, low, high, above, below, off)
    first, ends, begins = (every[kept & where] for where in (above >= 0, above < 0, below < 0))
    pairs = [
        (first, y[ray[first]], above[first], y[ray[above[first]]]),
        (ends, y[ray[ends]], ends, y[ray[ends]] + 0.5 * apart),
        (begins, y[ray[begins]] - 0.5 * apart, begins, y[ray[begins]]),
    ]
    joints, tops, bottoms = (_quads(low, high, *pair) for pair in pairs)
    quads = np.concatenate([joints, tops, bottoms])
    return Strips(quads, np.concatenate([quads[:, [0, 3]], quads[:, [1, 2]], tops[:, 2:], bottoms[:, :2]]))


def _pass_over_straight(
    ray: NDArray, low: NDArray, high: NDArray, above: NDArray, below: NDArray, tolerance: float
) -> NDArray[np.bool_]:  # fmt: skip
    """Which intervals are kept; ``above`` and ``below``, whom each is joined to (-1: to none), are led past the others.

    One is passed over whose ends lie half way between those of its neighbours, as far above as below; then every other
    of what is left, and so on.
    """
    kept = np.ones(len(ray), dtype=bool)
    step = 1
    while step <= _LONGEST:
        tried = np.flatnonzero(kept & (ray % (2 * step) == step) & (above >= 0) & (below >= 0))
        a, b = above[tried], below[tried]
        even = (ray[a] - ray[tried] == step) & (ray[tried] - ray[b] == step)
        off = (np.abs(end[tried] - 0.5 * (end[a] + end[b])) for end in (low, high))
        straight = even & np.logical_and(*(distance <= tolerance for distance in off))
        kept[tried[straight]] = False
        above[b[straight]], below[a[straight]] = a[straight], b[straight]
        step *= 2
    return kept


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
