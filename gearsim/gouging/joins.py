"""Places on borders and knot lines of faces, with the sides that meet there, found by where the faces lie.

What a file says of neighbours is not asked: a border point lies on another face where that face passes within the
join's tolerance of it, at its border or inside (a wall that stands on a floor).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.gouging.lines import Lines
from gearsim.gouging.sides import Sides, half_sides, joined, no_sides, sides_about
from gearsim.surfaces.face import Face
from gearsim.surfaces.footpoint import foot
from gearsim.surfaces.nurbs import NurbsSurface

TOLERANCE = 1e-5
"""Part of the size of all faces within which they join."""
_FEWEST, _MOST = 1e-6, 1e-2
"""Least and greatest tolerance [mm]."""
_SEAM = 0.5
"""Part of the domain that lies between the two borders of a seam."""


@dataclass(frozen=True)
class Places:
    """``sides`` of places, numbered from 0 on; ``on_border``: whether a place lies on its face's border, (k,).

    ``joins``: whether another side than its face's own was found there, (k,).
    """

    sides: Sides
    count: int
    on_border: NDArray[np.bool_]
    joins: NDArray[np.bool_]


def join_tolerance(faces: Sequence[Face]) -> float:
    """How far [mm] faces may lie apart and still join."""
    corners = np.concatenate([f.surface.points.reshape(-1, 3) for f in faces])
    return float(np.clip(TOLERANCE * np.linalg.norm(np.ptp(corners, axis=0)), _FEWEST, _MOST))


def find_places(faces: Sequence[Face], lines: Sequence[Lines], borders: bool = True) -> Places:
    """The places of all faces; ``lines``: where each is looked at. Without ``borders`` those on knot lines alone."""
    tolerance = join_tolerance(faces)
    found: list[Sides] = []
    border: list[NDArray] = []
    count = 0
    for k, (face, mine) in enumerate(zip(faces, lines, strict=True)):
        for make, on_border in ((_inner, False), (_border, True))[: 1 + borders]:
            sides, before = make(face, k, mine, count), count
            found.append(sides)
            count = int(sides.place.max(initial=count - 1)) + 1
            border.append(np.full(count - before, on_border))
    own = joined(found)
    edge = np.concatenate(border) if border else np.empty(0, bool)
    others = _neighbours(faces, lines, own, edge, tolerance) if borders else no_sides()
    joins = np.zeros(count, dtype=bool)
    joins[others.place] = True
    return Places(joined([own, others]), count, edge, joins)


def _inner(face: Face, number: int, lines: Lines, first: int) -> Sides:
    """Places on knot lines inside a face, and where they cross, as far as it is looked at."""
    u, v = _on_breaks(face, lines, inner=True)
    (u0, u1), (v0, v1) = lines.ranges
    inside = face.holds_points(u, v) & (u >= u0) & (u <= u1) & (v >= v0) & (v <= v1)
    u, v = u[inside], v[inside]
    return sides_about(face.surface, number, first + np.arange(len(u)), u, v, lines.breaks)


def _border(face: Face, number: int, lines: Lines, first: int) -> Sides:
    """Places on a face's border."""
    if not face.loops:
        u, v = _on_breaks(face, lines, inner=False)
        return sides_about(face.surface, number, first + np.arange(len(u)), u, v, lines.breaks)
    at = np.concatenate([_walk(loop) for loop in face.loops])
    place = first + np.arange(len(at))
    return half_sides(face.surface, number, place, at[:, 0], at[:, 1], at[:, 2:4], at[:, 4:6])


def _on_breaks(face: Face, lines: Lines, inner: bool) -> tuple[NDArray, NDArray]:
    """Where breaks meet lines and one another, shape (n,) each: those inside the domain, or those on its border."""
    (bu, bv), (lu, lv) = (b[:, 1] for b in lines.breaks), lines.at
    pairs = [np.meshgrid(*p, indexing="ij") for p in ((bu, lv), (lu, bv), (bu, bv))]
    u, v = (np.concatenate([p[k].ravel() for p in pairs]) for k in (0, 1))
    (u0, u1), (v0, v1) = face.surface.domain
    inside = (u > u0) & (u < u1) & (v > v0) & (v < v1)
    return u[inside == inner], v[inside == inner]


def _walk(loop: Sequence[NDArray]) -> NDArray:
    """Rows (u, v, way on, way back) of a loop's points: those inside its curves, and where one follows another."""
    curves = [e for e in loop if np.ptp(e, axis=0).max() > 0.0]
    rows = []
    for k, e in enumerate(curves):
        middle = e[2:] - e[:-2]
        rows.append(np.hstack([e[1:-1], middle, middle]))
        after = curves[(k + 1) % len(curves)]
        rows.append(np.hstack([e[-1:], _leaving(after)[None], -_leaving(e[::-1])[None]]))
    return np.concatenate(rows)


def _leaving(e: NDArray) -> NDArray:
    """The way in which a curve of points (n, 2) leaves its first one, to fourth order where there are five."""
    return np.asarray(np.array([-25.0, 48.0, -36.0, 16.0, -3.0]) @ e[:5] if len(e) > 4 else e[1] - e[0])


def _neighbours(
    faces: Sequence[Face], lines: Sequence[Lines], own: Sides, on_border: NDArray, tolerance: float
) -> Sides:
    """The sides of other faces, or of the other border of a seam, at places on borders."""
    sides = own[on_border[own.place]]
    place, index = np.unique(sides.place, return_index=True)
    at = sides[index]
    found = []
    for j, (face, mine) in enumerate(zip(faces, lines, strict=True)):
        target = _Target(face, j, mine, tolerance)
        near = np.all((at.point >= target.box[0]) & (at.point <= target.box[1]), axis=1)
        for asked in (near & (at.face != j), near & (at.face == j)):
            chosen = np.flatnonzero(asked)
            if len(chosen):
                found.append(target.sides(at[chosen], place[chosen]))
    return joined(found)


class _Target:
    """One face as others' border points find it."""

    def __init__(self, face: Face, number: int, lines: Lines, tolerance: float):
        self.face, self.number, self.lines, self.tolerance = face, number, lines, tolerance
        surface = face.surface
        corners = surface.points.reshape(-1, 3)
        self.box = corners.min(axis=0) - tolerance, corners.max(axis=0) + tolerance
        u, v = (np.union1d(a, b.ravel()) for a, b in zip(lines.at, lines.breaks, strict=True))
        held = face.holds(u, v) if face.loops else np.ones((len(v), len(u)), dtype=bool)
        row, column = np.nonzero(held)
        self.guess = np.stack([u[column], v[row]], axis=1)
        if face.loops:
            self.guess = np.concatenate([self.guess, *[e for loop in face.loops for e in loop]])
            self.outline = _Outline(face, tolerance)
        self.points = surface.jet(*self.guess.T).r
        self.tree = _tree(self.points)

    def sides(self, at: Sides, place: NDArray) -> Sides:
        """This face's sides at points of others, or at its own where a seam brings it back."""
        guess = self._guesses(at)
        mine = np.flatnonzero(guess >= 0)
        if not len(mine):
            return no_sides()
        u, v, gap = foot(self.face.surface, at.point[mine], *self.guess[guess[mine]].T)
        close = (gap <= self.tolerance) & ~self._itself(at[mine], u, v)
        mine, u, v = mine[close], u[close], v[close]
        if self.face.loops:
            return self.outline.sides(self.number, place[mine], u, v, at[mine], self.tolerance)
        u, v = self._snapped(u, v)
        return sides_about(self.face.surface, self.number, place[mine], u, v, self.lines.breaks)

    def _guesses(self, at: Sides) -> NDArray[np.intp]:
        """The known point nearest to each, -1 where there is none, as on one's own side of a seam."""
        if at.face[0] != self.number:
            return np.asarray(self.tree.query(at.point)[1])
        near = self.tree.query_ball_point(at.point, self._reach())
        found = np.full(len(at), -1)
        span = np.array([high - low for low, high in self.face.surface.domain])
        for i, candidates in enumerate(near):
            k = np.asarray(candidates, dtype=int)
            away = np.abs(self.guess[k] - (at.u[i], at.v[i])) / span
            k = k[np.max(away, axis=1, initial=0.0) > _SEAM]
            if len(k):
                found[i] = k[np.argmin(np.linalg.norm(self.points[k] - at.point[i], axis=1))]
        return found

    def _reach(self) -> float:
        return max(self.lines.spacing, self.tolerance)

    def _itself(self, at: Sides, u: NDArray, v: NDArray) -> NDArray[np.bool_]:
        span = [high - low for low, high in self.face.surface.domain]
        away = np.maximum(np.abs(u - at.u) / span[0], np.abs(v - at.v) / span[1])
        return np.asarray((at.face == self.number) & (away <= _SEAM))

    def _snapped(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters moved onto breaks within the tolerance."""
        jet, found = self.face.surface.jet(u, v), []
        for x, breaks, along in ((u, self.lines.breaks[0], jet.ru), (v, self.lines.breaks[1], jet.rv)):
            nearest = breaks[np.argmin(np.abs(x[:, None] - breaks[None, :, 1]), axis=1), 1] if len(x) else x
            close = np.abs(x - nearest) * np.linalg.norm(along, axis=1) <= self.tolerance
            found.append(np.where(close, nearest, x))
        return found[0], found[1]


class _Outline:
    """The boundary of a trimmed face, looked up by points in space."""

    def __init__(self, face: Face, tolerance: float):
        self.face, self.tolerance = face, tolerance
        self.span = np.array([high - low for low, high in face.surface.domain])
        self.rows = np.concatenate([_walk(loop) for loop in face.loops])
        self.corner = _corners(face.surface, self.rows)
        self.start, self.end = (face.surface.jet(*x.T).r for x in face.outline)
        self.way = face.outline[1] - face.outline[0]
        self.begin = face.outline[0]
        bends = [np.diff(face.surface.jet(*e.T).r, 2, axis=0) for loop in face.loops for e in loop]
        self.sag = 0.25 * max(float(np.linalg.norm(b, axis=1).max(initial=0.0)) for b in bends)
        self.vertices = _tree(self._keys(self.rows[:, :2]))
        self.corners = _tree(self._keys(self.rows[self.corner, :2])) if self.corner.any() else None

    def sides(self, number: int, place: NDArray, u: NDArray, v: NDArray, at: Sides, tolerance: float) -> Sides:
        """The face's sides at points on it: at its corners, its border, or inside; none off it."""
        surface = self.face.surface
        gap, way = self._nearest(at.point, np.stack([u, v], axis=1))
        keys = self._keys(np.stack([u, v], axis=1))
        border = gap <= tolerance + self.sag
        inside = ~border & self.face.holds_points(u, v)
        found = [
            sides_about(surface, number, place[inside], u[inside], v[inside], (np.empty((0, 2)), np.empty((0, 2))))
        ]
        corner, rows = np.zeros(len(u), dtype=bool), self.rows[self.corner]
        if self.corners is not None:
            apart, which = self.corners.query(keys)
            corner = border & (apart <= tolerance)
            mine = rows[which[corner]]
            found.append(half_sides(surface, number, place[corner], mine[:, 0], mine[:, 1], mine[:, 2:4], mine[:, 4:6]))
        edge = border & ~corner
        apart, which = self.vertices.query(keys)
        way = np.where((apart <= tolerance)[:, None], self.rows[which, 2:4], way)
        found.append(_along_border(surface, number, place[edge], u[edge], v[edge], way[edge], at[edge]))
        return joined(found)

    def _keys(self, at: NDArray) -> NDArray:
        """Points [mm] with their parameters behind them, which tell the two borders of a seam apart."""
        return np.hstack([self.face.surface.jet(*at.T).r, 10.0 * self.tolerance * at / self.span])

    def _nearest(self, point: NDArray, at: NDArray) -> tuple[NDArray, NDArray]:
        """Distance [mm] to the boundary's straight pieces, and the way in (u, v) along the nearest; ``at``: (u, v)."""
        along = self.end - self.start
        square = np.maximum(np.einsum("mi,mi->m", along, along), 1e-300)
        gap, which = np.empty(len(point)), np.empty(len(point), dtype=int)
        for i, p in enumerate(point):
            share = np.clip(np.einsum("mi,mi->m", p - self.start, along) / square, 0.0, 1.0)
            apart = np.linalg.norm(p - self.start - share[:, None] * along, axis=1)
            across = np.max(np.abs(self.begin + 0.5 * self.way - at[i]) / self.span, axis=1) > _SEAM
            which[i] = int(np.argmin(np.where(across, np.inf, apart)))
            gap[i] = apart[which[i]]
        return gap, self.way[which]


def _along_border(surface: NurbsSurface, number: int, place: NDArray, u: NDArray, v: NDArray, way: NDArray,
                  at: Sides) -> Sides:  # fmt: skip
    """Halves beside a border; where it runs along the other's border, that one's tangent is the better known."""
    found = half_sides(surface, number, place, u, v, way, way)
    if len(found) != len(at):
        return found
    other = at.start - np.einsum("ni,ni->n", at.start, found.normal)[:, None] * found.normal
    other /= np.maximum(np.linalg.norm(other, axis=1, keepdims=True), 1e-300)
    same = np.einsum("ni,ni->n", other, found.start)
    half = np.abs(at.width - np.pi) < 1e-6
    start = np.where((half & (np.abs(same) > 0.99))[:, None], np.sign(same)[:, None] * other, found.start)
    return replace(found, start=start)


def _corners(surface: NurbsSurface, rows: NDArray) -> NDArray[np.bool_]:
    """Which points of a boundary are corners."""
    jet = surface.jet(*rows[:, :2].T)
    on, back = (w[:, :1] * jet.ru + w[:, 1:] * jet.rv for w in (rows[:, 2:4], rows[:, 4:6]))
    sine = np.linalg.norm(np.cross(on, back), axis=1)
    return np.asarray(np.arctan2(sine, np.einsum("ni,ni->n", on, back)) > 1e-2)


def _tree(points: NDArray) -> Any:
    """A k-d tree of points."""
    from scipy.spatial import cKDTree  # slow to load, and only faces that may join need it

    return cKDTree(points)
