"""The faces about a place: what each is there, and in which sector of directions it goes on from there.

A place is a point on a border, on a knot line over which curvature or normal may jump, or where such lines cross.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.surfaces.patch import Jet

_CUSP = 1e-2  # rad: a boundary that turns back so sharply ends a face in a cusp
_FLAT = 1e-9
"""Part of the surface's size by its domain, below which a tangent counts as none (an edge that is a point)."""


@dataclass(frozen=True)
class Sides:
    """n sides of places.

    | field | meaning |
    | --- | --- |
    | place, face | numbers of the place and of the face, (n,) |
    | u, v | parameters on the face's surface, (n,) |
    | point, normal | (n, 3) [mm], and out of the material |
    | bend | the curvature as a symmetric tensor in space [1/mm], (n, 3, 3), nan where there is none |
    | start, width | the sector: a unit tangent (n, 3), and from it counter-clockwise about the normal [rad], (n,) |
    """

    place: NDArray[np.intp]
    face: NDArray[np.intp]
    u: NDArray
    v: NDArray
    point: NDArray
    normal: NDArray
    bend: NDArray
    start: NDArray
    width: NDArray

    def __len__(self) -> int:
        return len(self.place)

    def __getitem__(self, index: NDArray) -> Sides:
        return Sides(*(getattr(self, f.name)[index] for f in fields(self)))

    def direction(self, share: float) -> NDArray:
        """Unit tangents at a share of the sector, (n, 3)."""
        angle = share * self.width[:, None]
        return np.cos(angle) * self.start + np.sin(angle) * np.cross(self.normal, self.start)

    def highest(self, way: NDArray, trim: float) -> NDArray:
        """The largest product of vectors (n, 3) with the sector's unit tangents, ``trim`` [rad] off its ends, (n,)."""
        x, y = _dot(self.start, way), _dot(np.cross(self.normal, self.start), way)
        low, high = np.minimum(trim, 0.5 * self.width), np.maximum(self.width - trim, 0.5 * self.width)
        top = np.mod(np.arctan2(y, x) - low, 2.0 * np.pi) <= high - low
        ends = [x * np.cos(a) + y * np.sin(a) for a in (low, high)]
        return np.where(top, np.hypot(x, y), np.maximum(*ends))


def no_sides() -> Sides:
    return Sides(np.empty(0, int), np.empty(0, int), *(np.empty(s) for s in _SHAPES))


_SHAPES = ((0,), (0,), (0, 3), (0, 3), (0, 3, 3), (0, 3), (0,))


def joined(parts: Sequence[Sides]) -> Sides:
    """Several as one."""
    parts = [*parts, no_sides()]
    return Sides(*(np.concatenate([getattr(p, f.name) for p in parts]) for f in fields(Sides)))


def bend_of(jet: Jet) -> NDArray:
    """The curvature as a symmetric tensor in space [1/mm], (n, 3, 3)."""
    c = jet.curvature()
    pairs = ((c.k1, c.direction1), (c.k2, c.direction2))
    return np.sum([k[:, None, None] * d[:, :, None] * d[:, None, :] for k, d in pairs], axis=0)


def half_sides(surface: NurbsSurface, face: int, place: NDArray, u: NDArray, v: NDArray,
               ways: NDArray, behind: NDArray) -> Sides:  # fmt: skip
    """Sides to the left, in (u, v), of a boundary that leaves along ``ways`` and came along ``behind``, (n, 2).

    Left of a smooth boundary both agree; at a corner the sector lies between the way on and the way back.
    """
    jet = surface.jet(u, v)
    on, back = (unit_tangents(w[:, :1] * jet.ru + w[:, 1:] * jet.rv, _FLAT * surface.size) for w in (ways, -behind))
    start, end = (back, on) if surface.flip else (on, back)
    found = _sector(jet, face, place, u, v, start, end)
    return replace(found, width=np.where(found.width > 2.0 * np.pi - _CUSP, 0.0, found.width))


def sides_about(surface: NurbsSurface, face: int, place: NDArray, u: NDArray, v: NDArray,
                breaks: tuple[NDArray, NDArray]) -> Sides:  # fmt: skip
    """All sides of points of an untrimmed surface: halves on a line of ``breaks``, quarters where two cross.

    ``breaks``: of u and of v, rows of parameters just before and just behind a line, (m, 2); the borders of the
    domain are such lines, too. A point on none has one side, all around it.
    """
    found = []
    at = [_broken(x, b, d) for x, b, d in zip((u, v), breaks, surface.domain, strict=True)]
    for su in (-1, 0, 1):
        for sv in (-1, 0, 1):
            mine = np.flatnonzero(at[0][su + 1].exists & at[1][sv + 1].exists)
            if len(mine):
                uu, vv = at[0][su + 1].value[mine], at[1][sv + 1].value[mine]
                found.append(_about(surface, face, place[mine], uu, vv, su, sv))
    return joined(found)


@dataclass(frozen=True)
class _Beside:
    exists: NDArray[np.bool_]
    value: NDArray


def _broken(x: NDArray, breaks: NDArray, domain: tuple[float, float]) -> tuple[_Beside, _Beside, _Beside]:
    """Of parameters (n,): those before a break, on none, and behind one."""
    lines = np.searchsorted(breaks[:, 1], x)
    before, behind, on = x.copy(), x.copy(), np.zeros(len(x), dtype=bool)
    for k in (np.clip(lines - 1, 0, len(breaks) - 1), np.clip(lines, 0, len(breaks) - 1)):
        mine = (x >= breaks[k, 0]) & (x <= breaks[k, 1])
        before, behind, on = np.where(mine, breaks[k, 0], before), np.where(mine, breaks[k, 1], behind), on | mine
    low, high = domain
    return _Beside(on & (x > low), before), _Beside(~on, x), _Beside(on & (x < high), behind)


def _about(surface: NurbsSurface, face: int, place: NDArray, u: NDArray, v: NDArray, su: int, sv: int) -> Sides:
    jet = surface.jet(u, v)
    least = [_FLAT * surface.size / (high - low) for low, high in surface.domain]
    a, b = unit_tangents(jet.ru, least[0]), unit_tangents(jet.rv, least[1])
    if su == 0 and sv == 0:
        around = _sector(jet, face, place, u, v, a, a)
        return replace(around, width=np.full(len(around), 2.0 * np.pi))
    first = {(1, 0): -b, (-1, 0): b, (0, 1): a, (0, -1): -a, (1, 1): a, (-1, 1): b, (-1, -1): -a, (1, -1): -b}
    last = {(1, 0): b, (-1, 0): -b, (0, 1): -a, (0, -1): a, (1, 1): b, (-1, 1): -a, (-1, -1): -b, (1, -1): a}
    start, end = first[su, sv], last[su, sv]
    return _sector(jet, face, place, u, v, *((end, start) if surface.flip else (start, end)))


def _sector(jet: Jet, face: int, place: NDArray, u: NDArray, v: NDArray, start: NDArray, end: NDArray) -> Sides:
    across = np.cross(jet.normal, start)
    width = np.mod(np.arctan2(_dot(end, across), _dot(end, start)), 2.0 * np.pi)
    width = np.where(np.abs(width - np.pi) < 1e-6, np.pi, width)
    found = Sides(place, np.full(len(u), face), u, v, jet.r, jet.normal, bend_of(jet), start, width)
    real = np.isfinite(start).all(axis=1) & np.isfinite(end).all(axis=1) & np.isfinite(jet.normal).all(axis=1)
    return found[real & (np.linalg.norm(start, axis=1) > 0.5) & (np.linalg.norm(end, axis=1) > 0.5)]


def unit_tangents(a: NDArray, least: float = 0.0) -> NDArray:
    """Unit vectors, (n, 3); 0 where they are not longer than ``least``."""
    length = np.linalg.norm(a, axis=1, keepdims=True)
    return np.where(length > least, a / np.where(length > least, length, 1.0), 0.0)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ni,ni->n", a, b)
