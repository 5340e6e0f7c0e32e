"""Faces: NURBS surfaces trimmed to their boundary, each with a name and a material side."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.footpoint import foot
from gearsim.surfaces.nurbs import NurbsSurface

MaterialSide = Literal["solid", "stated", "assumed"]
Loop = tuple[NDArray, ...]
_ROUNDING = 1e-9
_WHOLE = 1e-6


@dataclass(frozen=True, eq=False)
class Face:
    """A part of a surface.

    ``loops``: its boundary as closed chains of curves, each a polyline of (u, v), shape (n, 2), with the face to its
    left in the plane of (u, v), whatever the normal; none: the whole domain. ``side``: the material lies where a
    solid has it, where the file states it (JSON), or is assumed behind the normal as the file's parameters give it.
    """

    name: str
    surface: NurbsSurface
    loops: tuple[Loop, ...] = ()
    side: MaterialSide = "stated"

    @cached_property
    def outline(self) -> tuple[NDArray, NDArray]:
        """Straight pieces of the boundary in (u, v): starts and ends, shape (m, 2)."""
        chains = [np.concatenate(loop) for loop in self.loops]
        starts, ends = np.concatenate(chains), np.concatenate([np.roll(c, -1, axis=0) for c in chains])
        real = np.any(starts != ends, axis=1)
        return starts[real], ends[real]

    @cached_property
    def sag(self) -> NDArray:
        """How far the straight pieces may lie off the boundary in u and in v, shape (2,)."""
        (u0, u1), (v0, v1) = self.surface.domain
        bends = [np.abs(np.diff(e, 2, axis=0)).max(axis=0, initial=0.0) for loop in self.loops for e in loop]
        return 0.25 * np.max(bends, axis=0) + _ROUNDING * np.array([u1 - u0, v1 - v0])

    @property
    def is_whole(self) -> bool:
        """Whether the boundary is that of the surface's domain, to a millionth of its area."""
        if not self.loops:
            return True
        start, end = self.outline
        (u0, u1), (v0, v1) = self.surface.domain
        area = 0.5 * abs(float(np.sum(start[:, 0] * end[:, 1] - end[:, 0] * start[:, 1])))
        return abs(area - (u1 - u0) * (v1 - v0)) <= _WHOLE * (u1 - u0) * (v1 - v0)

    def holds(self, u: NDArray, v: NDArray) -> NDArray[np.bool_]:
        """Whether the points of the grid of lines u (n,) and v (m,) lie inside the boundary, not on it: (m, n)."""
        (u0, u1), (v0, v1) = self.surface.domain
        inside = ((u > u0) & (u < u1))[None, :] & ((v > v0) & (v < v1))[:, None]
        if not self.loops:
            return inside
        start, end = self.outline
        by_rows = _parity(start, end, u, v, self.sag[0])
        by_columns = _parity(start[:, ::-1], end[:, ::-1], v, u, self.sag[1])
        return inside & by_rows & by_columns.T

    def holds_points(self, u: NDArray, v: NDArray) -> NDArray[np.bool_]:
        """The same for single points, shape (n,)."""
        (u0, u1), (v0, v1) = self.surface.domain
        found = (u > u0) & (u < u1) & (v > v0) & (v < v1)
        if self.loops and len(u):
            start, end = self.outline
            found &= _parity_at(start, end, u, v, self.sag[0])
            found &= _parity_at(start[:, ::-1], end[:, ::-1], v, u, self.sag[1])
        return found


def face_from_cad(entry: dict[str, Any], surface: NurbsSurface) -> Face:
    """A face as `surfaces.cad_reader` writes it, with its boundary in the parameters of ``surface``."""
    chains = [[_on_surface(np.array(edge), surface) for edge in loop] for loop in entry["loops"]]
    side: MaterialSide = "solid" if entry["solid"] else "assumed"
    return Face(surface.name, surface, tuple(oriented([c for c in chains if c])), side)


def oriented(chains: list[list[NDArray]]) -> list[Loop]:
    """Loops turned so that the face lies to their left: a loop inside an odd number of others is a hole."""
    outlines = [np.concatenate(c) for c in chains]
    found = []
    for k, chain in enumerate(chains):
        inside = sum(
            bool(_parity(o, np.roll(o, -1, axis=0), outlines[k][:1, 0], outlines[k][:1, 1], 0.0)[0, 0])
            for j, o in enumerate(outlines)
            if j != k
        )
        turned = (_area(outlines[k]) < 0.0) != (inside % 2 == 1)
        found.append(tuple(e[::-1] for e in reversed(chain)) if turned else tuple(chain))
    return found


def _on_surface(edge: NDArray, surface: NurbsSurface) -> NDArray:
    """A boundary curve in the surface's parameters, by its points where those of the file are others."""
    (u0, u1), (v0, v1) = surface.domain
    u, v = np.clip(edge[:, 0], u0, u1), np.clip(edge[:, 1], v0, v1)
    if edge.shape[1] == 5:
        u, v, _ = foot(surface, edge[:, 2:], u, v)
    return np.stack([u, v], axis=1)


def _area(outline: NDArray) -> float:
    x, y = outline.T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def _parity(start: NDArray, end: NDArray, x: NDArray, y: NDArray, margin: float) -> NDArray[np.bool_]:
    """Whether points of the grid of lines x (n,), y (m,) lie inside an outline, at least ``margin`` off it along x."""
    found = np.zeros((len(y), len(x)), dtype=bool)
    for k, level in enumerate(y):
        crossing = (start[:, 1] <= level) != (end[:, 1] <= level)
        a, b = start[crossing], end[crossing]
        at = np.sort(a[:, 0] + (level - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]))
        odd = np.searchsorted(at, x) % 2 == 1
        if len(at) and margin > 0.0:
            after = np.clip(np.searchsorted(at, x), 0, len(at) - 1)
            nearest = np.minimum(np.abs(x - at[after]), np.abs(x - at[np.maximum(after - 1, 0)]))
            odd &= nearest > margin
        found[k] = odd
    return found


def _parity_at(start: NDArray, end: NDArray, x: NDArray, y: NDArray, margin: float) -> NDArray[np.bool_]:
    """The same for single points (x, y), shape (n,)."""
    crossing = (start[:, 1] <= y[:, None]) != (end[:, 1] <= y[:, None])
    row, piece = np.nonzero(crossing)
    a, b = start[piece], end[piece]
    ahead = a[:, 0] + (y[row] - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0]) - x[row]
    count = np.bincount(row[ahead < 0.0], minlength=len(x))
    nearest = np.full(len(x), np.inf)
    np.minimum.at(nearest, row, np.abs(ahead))
    return np.asarray((count % 2 == 1) & (nearest > margin))
