"""Catalogues of end mills as pairs (shank radius, corner radius) [mm]: Khan's, and common metric sizes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

KHAN_RADII = (30.0, 25.0, 20.0, 18.0, 16.0, 12.0, 10.0, 8.0, 6.0)
"""Shank radii [mm] of chapter 7; his corner radii run from 2 mm to the shank radius, in steps of 0.1 mm."""
KHAN_CORNER_LEAST = 2.0
KHAN_CORNER_STEP = 0.1

METRIC_CORNERS: dict[float, tuple[float, ...]] = {
    1.0: (0.0, 0.1, 0.2),
    2.0: (0.0, 0.2, 0.5),
    3.0: (0.0, 0.2, 0.5, 1.0),
    4.0: (0.0, 0.2, 0.5, 1.0),
    5.0: (0.0, 0.5, 1.0),
    6.0: (0.0, 0.5, 1.0, 1.5, 2.0),
    8.0: (0.0, 0.5, 1.0, 1.5, 2.0, 2.5),
    10.0: (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0),
    12.0: (0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0),
    16.0: (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
    20.0: (0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0),
    25.0: (0.0, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0),
    32.0: (0.0, 3.0, 4.0, 5.0, 6.0, 8.0),
    40.0: (0.0, 4.0, 5.0, 6.0, 8.0),
    50.0: (0.0, 5.0, 6.0, 8.0),
}
"""Usual corner radii [mm] of flat and bull-nose end mills by diameter [mm]; a ball of each diameter comes with them."""


def khan_mills() -> NDArray:
    """Every (R, r) [mm] that Khan's algorithm can reach, shape (n, 2), the largest first."""
    rows = [(big, r) for big in KHAN_RADII for r in khan_corners(big)]
    return ranked(np.array(rows))


def khan_corners(largest: float) -> NDArray:
    """Corner radii [mm] from the largest down to 2 mm in steps of 0.1 mm."""
    steps = np.floor((largest - KHAN_CORNER_LEAST) / KHAN_CORNER_STEP + 1e-9)
    return np.round(largest - KHAN_CORNER_STEP * np.arange(int(steps) + 1), 12)


def metric_mills() -> NDArray:
    """Common metric end mills, flat, bull-nose and ball: (R, r) [mm], shape (n, 2), the largest first."""
    rows = [(0.5 * d, r) for d, corners in METRIC_CORNERS.items() for r in (*corners, 0.5 * d)]
    return ranked(np.array(rows))


def ranked(mills: NDArray) -> NDArray:
    """Mills (R, r) in the order of Khan's preference: the largest shank first, then the largest corner."""
    return mills[np.lexsort((-mills[:, 1], -mills[:, 0]))]
