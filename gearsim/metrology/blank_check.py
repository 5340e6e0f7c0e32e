"""Whether a blank holds the surfaces that are to be cut from it: what lies outside of it will never be there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from gearsim.geometry.solid import Solid
from gearsim.geometry.wedge import Wedge
from gearsim.metrology.findings import Finding, beyond_the_blank
from gearsim.metrology.samples import SampleGrid
from gearsim.surfaces.part import Part, Tolerance


def outside(
    grid: SampleGrid, tolerance: Tolerance | None, blank: Solid, copies: int, part: Part, known_to: float = 0.0
) -> Iterator[Finding]:
    """The point of an intended surface, and of its ``copies`` about the z axis, that a blank misses by most.

    Nothing is said of a surface without a tolerance, nor of what lies within it, or within what the blank's own surface
    is ``known_to`` [mm].
    """
    if tolerance is None:
        return
    points, solid = grid.point[np.isfinite(grid.point).all(axis=-1)], blank
    if isinstance(blank, Wedge):
        solid, copies = blank.solid, 1  # its surfaces reach into the next sectors, which are alike
    angle = 2.0 * np.pi / copies * np.arange(copies)[:, None]
    x, y, z = points.T
    turned = [np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y, z + 0.0 * angle]
    points = np.stack(turned, axis=-1).reshape(-1, 3)
    points = points[~solid.contains(points)]
    if not len(points):
        return
    off = solid.signed_distance(points)
    worst = int(np.argmax(off))
    if off[worst] > known_to and not tolerance.allows(-1e3 * float(off[worst])):
        yield beyond_the_blank(part, grid.patch.name, points[worst], -1e3 * float(off[worst]))
