"""Where rays cross closed surfaces of triangles, so that every ray comes out as often as it goes in, whatever it meets.

A ray is a point of the plane across it, a triangle is seen projected along it. Which edges pass the point on its upper
side is decided for each edge alone, from its two ends in the order of their heights, and so alike for all triangles
that share it or one that lies under it; a triangle is crossed where one of the two edges at the point's height passes,
and not the other. These counts cancel over a closed surface by themselves, not by the exactness of any number. A point
in an edge counts as a little above it in both coordinates: of two opposite faces along a ray it is inside the lower.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.triangle_tree import TriangleTree, chunks, spread

_CHUNK = 1 << 20
_RAYS = 1 << 13
_PAD = 1e-12
_ALIKE = 4  # rays of one height, on average, from which on each height is a band


class Crossings(NamedTuple):
    """``ray`` that crosses, ``at`` [mm] along it, ``way``: 1 where it goes in, -1 where it comes out, and the
    ``triangle`` that is crossed; all (n,).
    """

    ray: NDArray[np.integer]
    at: NDArray[np.floating]
    way: NDArray[np.integer]
    triangle: NDArray[np.integer]


_NONE = Crossings(np.zeros(0, dtype=int), np.zeros(0), np.zeros(0, dtype=int), np.zeros(0, dtype=int))


class _Spans(NamedTuple):
    """The stretch of a triangle at one height: from ``left`` to ``right``, there ``near`` and ``far`` along the ray.

    ``way`` as of Crossings; without a length there is none.
    """

    left: NDArray
    right: NDArray
    near: NDArray
    far: NDArray
    way: NDArray

    def at(self, place: NDArray) -> NDArray:
        """How far along the ray the stretch is at a place within, between its two ends."""
        length = self.right - self.left
        share = np.clip((place - self.left) / np.where(length > 0.0, length, 1.0), 0.0, 1.0)
        return self.near + share * (self.far - self.near)


def crossings(tree: TriangleTree, origins: NDArray, directions: NDArray) -> Crossings:
    """All crossings of rays, both shape (n, 3), with the triangles of a closed surface, ray by ray along each.

    Directions are of unit length. ``at`` is exact to rounding, and lies within the triangle.
    """
    if not len(origins):
        return _NONE
    main = np.argmax(np.abs(directions), axis=1)
    sense = np.sign(np.take_along_axis(directions, main[:, None], axis=1))
    forward = sense * directions  # or rays back and forth would not see the same edges
    alike = (forward == forward[0]).all()
    ray, at, way, triangle = (_parallel if alike else _apart)(tree, origins, forward)
    at, way = at * sense[ray, 0], way * sense[ray, 0].astype(int)
    order = np.lexsort((-way, at, ray))
    return Crossings(ray[order], at[order], way[order], triangle[order])


def _parallel(tree: TriangleTree, origins: NDArray, directions: NDArray) -> Crossings:
    """Those of parallel rays, band by band: all of one height, or of heights that are near."""
    frame = across(directions[:1])[0]
    at, corners = origins @ frame.T, tree.corners @ frame.T
    band, lowest, highest = _bands(at[:, 1])
    places, place = np.unique(at[:, 0], return_inverse=True)
    number = band * len(places) + place
    rays = np.argsort(number, kind="stable")
    number = number[rays]
    first = np.searchsorted(highest, corners[..., 1].min(axis=1))
    last = np.searchsorted(lowest, corners[..., 1].max(axis=1))
    parts = [_NONE]
    for own in chunks(np.maximum(last - first, 0), _CHUNK):
        triangle, here = spread(first[own], last[own])
        triangle += own.start
        if lowest is highest:
            spans = _spans(corners[triangle], lowest[here])
            left, right, real = spans.left, spans.right, spans.right > spans.left
            triangle, here, left, right = triangle[real], here[real], left[real], right[real]
        else:
            left, right = _reach(corners[triangle], lowest[here], highest[here])
        begin = np.searchsorted(number, here * len(places) + np.searchsorted(places, left))
        end = np.searchsorted(number, here * len(places) + np.searchsorted(places, right, side="right"))
        for some in chunks(end - begin, _CHUNK):
            row, which = spread(begin[some], end[some])
            ray, met = rays[which], triangle[some][row]
            parts.append(_met(corners[met], at[ray], ray, met))
    return Crossings(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _bands(height: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """The band that each height lies in, and the bands' lowest and highest heights, rising."""
    rows, row = np.unique(height, return_inverse=True)
    if len(rows) * _ALIKE <= len(height):
        return row, rows, rows
    first = np.unique(np.linspace(0, len(rows), 2 * int(len(rows) ** 0.5) + 2).astype(int))
    return np.searchsorted(first, row, side="right") - 1, rows[first[:-1]], rows[first[1:] - 1]


def _reach(corners: NDArray, low: NDArray, high: NDArray) -> tuple[NDArray, NDArray]:
    """From where to where, and no less, triangles (k, 3, 3) reach along u between two heights, shape (k,)."""
    after = corners[:, [1, 2, 0]]
    rise = after[..., 1] - corners[..., 1]
    per = 1.0 / np.where(rise == 0.0, np.inf, rise)
    ends = []
    for height in (low, high):
        share = np.clip((height[:, None] - corners[..., 1]) * per, 0.0, 1.0)
        ends.append(corners[..., 0] + share * (after[..., 0] - corners[..., 0]))
    u, v = corners[..., 0], corners[..., 1]
    crossed = (np.minimum(v, after[..., 1]) <= high[:, None]) & (np.maximum(v, after[..., 1]) >= low[:, None])
    slack = _PAD * np.abs(u).max(initial=0.0)
    left = np.where(crossed, np.minimum(*ends), np.inf).min(axis=1)
    right = np.where(crossed, np.maximum(*ends), -np.inf).max(axis=1)
    return left - slack, right + slack


def _apart(tree: TriangleTree, origins: NDArray, directions: NDArray) -> Crossings:
    """Those of any rays, each in a frame of its own."""
    frames, parts = across(directions), [_NONE]
    slack = _PAD * max(float(np.abs(tree.corners).max()), float(np.abs(origins).max()))
    with np.errstate(divide="ignore"):
        per = 1.0 / directions

    def keep(query: NDArray, lower: NDArray, upper: NDArray) -> NDArray:
        with np.errstate(invalid="ignore"):  # along a side of a box 0 times inf is nan, which fmin and fmax pass by
            a, b = ((x - origins[query]) * per[query] for x in (lower - slack, upper + slack))
        kept: NDArray = np.fmin(a, b).max(axis=1) <= np.fmax(a, b).min(axis=1)
        return kept

    for begin in range(0, len(origins), _RAYS):
        rays, triangles = tree.pairs(np.arange(begin, min(begin + _RAYS, len(origins))), keep)
        for own in chunks(np.ones(len(rays), dtype=int), _CHUNK):
            ray, met = rays[own], triangles[own]
            corners = np.einsum("kij,kcj->kci", frames[ray], tree.corners[met])
            parts.append(_met(corners, np.einsum("kij,kj->ki", frames[ray], origins[ray]), ray, met))
    return Crossings(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _met(corners: NDArray, origin: NDArray, ray: NDArray, triangle: NDArray) -> Crossings:
    """Those of pairs of a triangle, its corners (k, 3, 3) seen along its ray, and a ray, its origin (k, 3) so, too."""
    spans = _spans(corners, origin[:, 1])
    seen = (spans.left <= origin[:, 0]) & (origin[:, 0] < spans.right)
    real = _Spans(*(column[seen] for column in spans))
    return Crossings(ray[seen], real.at(origin[seen, 0]) - origin[seen, 2], real.way, triangle[seen])


def across(directions: NDArray) -> NDArray:
    """Right-handed frames (n, 3, 3), rows u, v and the direction itself; along an axis they are axes, exactly."""
    first = np.argmax(np.abs(directions), axis=1)
    helper = np.eye(3)[(first + 1) % 3]
    v = np.cross(directions, helper)
    v /= np.linalg.norm(v, axis=1, keepdims=True)
    return np.stack([np.cross(v, directions), v, directions], axis=1)


def _spans(corners: NDArray, height: NDArray) -> _Spans:
    """Where triangles, shape (k, 3, 3) of (u, v, along), are at heights v, shape (k,)."""
    above = corners[..., 1] > height[:, None]
    rises = above[:, [1, 2, 0]].astype(np.int8) - above  # of the edge from each corner to the next
    up, down = np.argmax(rises, axis=1), np.argmin(rises, axis=1)
    k, real = np.arange(len(height)), above.any(axis=1) & ~above.all(axis=1)
    rising = _passed(corners[k, up], corners[k, (up + 1) % 3], height)
    falling = _passed(corners[k, (down + 1) % 3], corners[k, down], height)
    out = rising[0] > falling[0]
    left, near = (np.where(out, a, b) for a, b in zip(falling, rising, strict=True))
    right, far = (np.where(out, a, b) for a, b in zip(rising, falling, strict=True))
    return _Spans(left, np.where(real, right, -np.inf), near, far, np.where(out, -1, 1))


def _passed(low: NDArray, high: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
    """Where edges, from their lower ends to their higher ones, pass a height: u, and how far along."""
    way = high - low
    share = (height - low[:, 1]) / np.where(way[:, 1] > 0.0, way[:, 1], 1.0)
    return low[:, 0] + share * way[:, 0], low[:, 2] + share * way[:, 2]
