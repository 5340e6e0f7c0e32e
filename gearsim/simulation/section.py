"""A transverse section through a stock as cut: parallel rays in one plane."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.solid import Solid
from gearsim.simulation.intervals import IntervalSet, stretches, subtract


@dataclass(frozen=True)
class Section:
    """A transverse section as cut: rays along x at heights ``y`` (n,) [mm] in the plane ``z`` [mm], what is left."""

    z: float
    y: NDArray[np.floating]
    start: float
    left: IntervalSet


def section(rays: RayBundle, stock: Solid, removed: IntervalSet) -> Section:
    """What is left along the section's rays."""
    left = subtract(stretches(len(rays), *stock.chords(rays.origin, rays.direction)), removed)
    return Section(float(rays.origin[0, 2]), rays.origin[:, 1], float(rays.origin[0, 0]), left)
