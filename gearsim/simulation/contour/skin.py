"""The surface through the hits on a lattice's edges, whatever shape its cells have."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.triangles import TriangleMesh
from gearsim.simulation.contour.cells import Quads
from gearsim.simulation.contour.hits import Hits
from gearsim.simulation.contour.placing import place
from gearsim.simulation.contour.splitting import split

_BEYOND = 1.0
"""Of a cell: how far a vertex may leave its own, for edges and corners that the nodes do not see."""


class Skin(NamedTuple):
    """``points`` [mm], ``triangles`` (m, 3) and the quad that each is of; ``beyond`` [mm³]: the volume that vertices
    add, or take, that left their cells."""

    points: NDArray[np.floating]
    triangles: NDArray[np.integer]
    quad: NDArray[np.integer]
    beyond: float


def close(
    topology: Quads, leaves: NDArray, way: NDArray, at: Hits, lower: NDArray, upper: NDArray
) -> Skin:  # fmt: skip
    """Place the vertices of quads and split them into triangles, outward where the lattice is right-handed.

    ``way`` of the quads' edges from the node to the next, shape (n, 3), ``leaves`` as of their crossings; ``lower`` and
    ``upper`` [mm], shape (n, 3), of boxes around the vertices' cells. All in one frame.
    """
    held, free = place(topology.corners, at.point, at.normal, lower, upper)
    room = _BEYOND * (upper - lower)
    near = np.all((free >= lower - room) & (free <= upper + room), axis=1)
    vertices = np.where(near[:, None], free, held)
    points, triangles, quad = split(topology, way, leaves, vertices, at.point)
    inner = np.concatenate([held, points[len(held) :]])
    volumes = [TriangleMesh(p, triangles, quad).volume for p in (points, inner)]
    return Skin(points, triangles, quad, abs(volumes[1] - volumes[0]))
