"""A peer with opencamlib, in three axes: its drop cutter cuts dexels when tool and path change places.

The package has no cutting simulation. But where a tool of lower profile f passes below vertical dexels, the
height left at (x, y) is min over the path's points p of p_z + f(|p - (x, y)|), and what the drop cutter finds
over a surface of points q is max of q_z - f(|q - (x, y)|): the same, upside down, when q is the path mirrored
in z. A straight line of the path is a vertical triangle under it. Both ways are exact for straight lines.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.bench.peer_work import Work

_FAR = 100.0


def drop(opencamlib: Any, work: Work) -> NDArray:
    """First surface along each vertical ray [mm] below a ball end mill that moves on straight lines."""
    source, rays, cutter = work.source, work.rays, work.cutter
    piece = np.arange(source.pieces)
    start, end = (source.pose(piece, np.full(source.pieces, t), 0).tip.value * (1.0, 1.0, -1.0) for t in (0.0, 1.0))
    point, surface = opencamlib.Point, opencamlib.STLSurf()
    for a, b in zip(start.tolist(), end.tolist(), strict=True):
        below = point(a[0], a[1], a[2] - 1.0)
        surface.addTriangle(opencamlib.Triangle(point(*a), point(*b), below))
    dropper, tool = opencamlib.BatchDropCutter(), opencamlib.BallCutter(2.0 * cutter.max_radius, cutter.height)
    dropper.setSTL(surface)
    dropper.setCutter(tool)
    dropper.setThreads(1)
    for x, y, _ in rays.origin.tolist():
        dropper.appendPoint(opencamlib.CLPoint(x, y, -_FAR))
    dropper.run()
    height = -np.array([p.z for p in dropper.getCLPoints()])
    return np.minimum(height - rays.origin[:, 2], rays.end)
