"""The sheets of surface within a cell of a lattice, for all 256 states of its corners: which edges each one crosses.

On every face of a cell the crossed edges are joined by arcs; where all four are crossed, the two beside each corner
that is material are (the cell beyond the face sees the same). Each crossed edge lies on two faces, so the arcs close to
rings: the sheets, up to four in a cell.

Corner x + 2 y + 4 z. Edge 4 axis + p + 2 q runs along ``axis`` from the corner at p along the next axis (x after z) and
at q along the one after.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


def _edge_corners() -> NDArray:
    """The lower corner of each edge."""
    edges = [(a, p, q) for a in range(3) for q in range(2) for p in range(2)]
    return np.array([(p << (a + 1) % 3) | (q << (a + 2) % 3) for a, p, q in edges])


LOWER = _edge_corners()
_UPPER = LOWER | (1 << np.arange(12) // 4)


def _arcs(solid: NDArray) -> list[list[tuple[int, int]]]:
    """For each face (2 axis + side) the pairs of crossed edges that are joined on it; ``solid``: of the corners."""
    crossed = solid[LOWER] != solid[_UPPER]
    faces = []
    for axis, side in ((a, s) for a in range(3) for s in range(2)):
        on_face = (np.arange(12) // 4 != axis) & (LOWER >> axis & 1 == side) & crossed
        edges = np.flatnonzero(on_face)
        if len(edges) == 4:
            inner = np.where(solid[LOWER[edges]], LOWER[edges], _UPPER[edges])
            edges = edges[np.argsort(inner, kind="stable")]
        faces.append([(int(edges[i]), int(edges[i + 1])) for i in range(0, len(edges), 2)])
    return faces


def _sheets(solid: NDArray) -> tuple[NDArray, int]:
    """The sheet of each edge (-1: it is not crossed), and the faces with two arcs of one sheet, as bits."""
    sheet = np.where(solid[LOWER] != solid[_UPPER], np.arange(12), -1)
    faces = _arcs(solid)
    for _ in range(12):
        for a, b in (arc for arcs in faces for arc in arcs):
            sheet[[a, b]] = min(sheet[a], sheet[b])
    _, sheet[sheet >= 0] = np.unique(sheet[sheet >= 0], return_inverse=True)
    twice = [len(arcs) == 2 and sheet[arcs[0][0]] == sheet[arcs[1][0]] for arcs in faces]
    return sheet, sum(1 << f for f, yes in enumerate(twice) if yes)


class Sheets(NamedTuple):
    """By 2 x (crossed edges as bits) + (corner 0 is material): each edge's ``sheet``, their ``number``, and as bits the
    faces on which one sheet has two arcs, ``twice``. By crossed edges: whether each's lower corner ``differs`` from
    corner 0.
    """

    sheet: NDArray
    number: NDArray
    twice: NDArray
    differs: NDArray


@cache
def sheet_tables() -> Sheets:
    """Made once, when the first surface is asked for."""
    sheet, count = np.full((8192, 12), -1, dtype=np.int8), np.zeros(8192, dtype=np.int8)
    twice, differs = np.zeros(8192, dtype=np.uint8), np.zeros((4096, 12), dtype=bool)
    for state in range(256):
        solid = (state >> np.arange(8) & 1).astype(bool)
        crossed = int(((solid[LOWER] != solid[_UPPER]) << np.arange(12)).sum())
        case = 2 * crossed + int(solid[0])
        sheet[case], twice[case] = _sheets(solid)
        count[case] = sheet[case].max() + 1
        differs[crossed] = solid[LOWER] != solid[0]
    return Sheets(sheet, count, twice, differs)
