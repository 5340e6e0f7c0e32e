"""The surface of a tri-dexel as a closed mesh of triangles (dual contouring, sharp edges kept)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.triangles import TriangleMesh
from gearsim.simulation.contour.cells import Quads, quads
from gearsim.simulation.contour.columns import Columns, columns
from gearsim.simulation.contour.crossings import across, along
from gearsim.simulation.contour.hits import Hits, hits, nodes
from gearsim.simulation.contour.skin import close
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.ends import Normals
from gearsim.simulation.intervals import IntervalSet
from gearsim.simulation.stock import Stock


@dataclass(frozen=True)
class Contour:
    """A tri-dexel's surface, and what is certain of it.

    ``mesh`` is in the part's frame. ``volume`` [mm³] is that of the bundle along the box's last axis; ``unseen`` [mm³]
    are its walls and gaps that lie between two nodes, which no mesh of the nodes shows. ``bound`` [mm³]: the two
    volumes differ by less (half a cell for every end, one for every cell with a vertex, what is unseen, and what
    vertices add that left their cells); it falls as the pitch does. ``apart``: crossed edges on which the bundles do
    not agree. ``hit``, shape (k, 3) [mm]: the ends of material that the surface goes through or by, ``of`` each
    triangle which of them, shape (m,). Vertices lie off a curved surface, hits do not.
    """

    mesh: TriangleMesh
    hit: NDArray[np.floating]
    of: NDArray[np.integer]
    volume: float
    unseen: float
    bound: float
    apart: int


def contour(stock: Stock, normals: Normals) -> Contour:
    """The surface of the material that is left of a stock.

    The nodes of the lattice are where rays of all three bundles meet; the bundle along the last axis alone says which
    are material, so that the surface is watertight however ends tie. Every edge has two faces, every vertex one fan of
    them. Edges and corners of the part are kept sharp, which takes some vertices into cells beside their own. Walls and
    gaps thinner than a cell may be missing; the mesh may touch or cross itself where they are thinner than two.
    """
    box, left = stock.box, stock.left
    first, second, third = (int(n) for n in box.counts)
    runs = columns((first, second, third), nodes(box, 2)[1:-1], left[2])
    crossings = [across(runs, 0), across(runs, 1), along(runs)]
    topology = quads(crossings, (first + 1, second + 1, third + 1))
    at = _joined([hits(box, left, c, normals) for c in crossings])
    way = np.repeat(np.eye(3), [len(c) for c in crossings], axis=0)
    leaves = np.concatenate([c.leaves for c in crossings])
    skin = close(topology, leaves, way, at, *_cells(box, topology))
    triangles = skin.triangles if np.linalg.det(box.frame.rotation) > 0.0 else skin.triangles[:, ::-1]
    mesh = TriangleMesh(box.frame.point(skin.points), triangles, at.tag[skin.quad])
    return _judged(box, left[2], runs, mesh, skin.quad, len(topology.cells), skin.beyond, at)


def _joined(found: Sequence[Hits]) -> Hits:
    return Hits(*(np.concatenate([getattr(h, name) for h in found]) for name in ("point", "normal", "tag")))


def _cells(box: DexelBox, topology: Quads) -> tuple[NDArray, NDArray]:
    """Lower and upper corners of the vertices' cells in the box's frame."""
    cell = np.unravel_index(topology.cell, tuple(box.counts + 1))
    lattice = [box.lower[k] + nodes(box, k) for k in range(3)]
    lower, upper = (np.column_stack([lattice[k][cell[k] + step] for k in range(3)]) for step in (0, 1))
    return lower, upper


def _judged(
    box: DexelBox, material: IntervalSet, runs: Columns, mesh: TriangleMesh, of: NDArray, cells: int, beyond: float,
    at: Hits,
) -> Contour:  # fmt: skip
    area = box.cell_area(2)
    cell = area * float(box.upper[2] - box.lower[2]) / float(box.counts[2])
    unseen = area * (runs.walls + runs.gaps)
    bound = cell * (cells + len(runs.column)) + unseen + beyond
    volume = area * float((material.hi - material.lo).sum())
    apart = int(np.count_nonzero(~at.normal.any(axis=1)))
    return Contour(mesh, box.frame.point(at.point), of, volume, unseen, bound, apart)


def at_vertices(found: Contour, values: NDArray) -> NDArray:
    """Of values at hits, shape (k,), the mean at each vertex of those of its triangles, (n,); nan counts nowhere."""
    own = np.repeat(values[found.of], 3)
    known, corner = np.isfinite(own), found.mesh.triangles.ravel()
    count = np.bincount(corner[known], minlength=len(found.mesh.points))
    total = np.bincount(corner[known], weights=own[known], minlength=len(found.mesh.points))
    return np.where(count > 0, total / np.maximum(count, 1), np.nan)
