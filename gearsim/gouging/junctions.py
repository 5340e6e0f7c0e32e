"""Places judged: a tool that touches one of the sides that meet there, against all of them.

First order first. With the tool tangent to one side, another side that rises above the tangent plane lies inside a
smooth tool however small it is (a concave corner; only a sharp edge may enter it), one that falls below it is clear of
it (a convex edge), and one that goes on in the plane is compared to second order in its own sector. On a convex edge
the tool may also stand with its normal between the two sides' normals; then only the edge is compared, along itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.contact import ANGLE, BEYOND, approach
from gearsim.gouging.borders import least_in_sectors
from gearsim.gouging.compare import TIE
from gearsim.gouging.joins import Places
from gearsim.gouging.sides import Sides
from gearsim.gouging.tensors import Tensor
from gearsim.gouging.tool import Tool

SMOOTH = 1e-4
"""Largest angle [rad] between normals that still counts as a tangent join."""
_TRIM = 0.02
"""Left out [rad] at the ends of a sector where it is asked whether it rises: there it meets its neighbours."""
_ALIGNED = 2e-3
"""Within this of each other [rad] the border of a sector and of the tool's two sides are one."""
_APART = 1e-6
_TURNS = 8


class Join(IntEnum):
    """How two sides of a place meet. DISAGREE: their material lies on opposite sides of one surface."""

    TANGENT = 0
    CONVEX = 1
    CONCAVE = 2
    DISAGREE = 3


@dataclass(frozen=True)
class Pairs:
    """Two sides of a place, rows of ``Sides``: the one that is touched, the other, and how they meet, (m,)."""

    touched: NDArray[np.intp]
    other: NDArray[np.intp]
    kind: NDArray[np.intp]


@dataclass(frozen=True)
class Ridges:
    """Tools standing on convex edges: the two rows of ``Sides``, (k,), normals and edges' directions (k, 3), and the
    edges' curvature along the normals [1/mm].
    """

    side: NDArray[np.intp]
    other: NDArray[np.intp]
    normal: NDArray
    along: NDArray
    bend: NDArray


@dataclass(frozen=True)
class Junctions:
    """All places with what follows from their geometry, whatever the tool."""

    places: Places
    pairs: Pairs
    ridges: Ridges

    @property
    def sides(self) -> Sides:
        return self.places.sides

    def kinds(self) -> NDArray[np.intp]:
        """Of each place the gravest way in which two of its sides meet, -1 where it has one side only."""
        found = np.full(self.places.count, -1)
        np.maximum.at(found, self.sides.place[self.pairs.touched], self.pairs.kind)
        return found

    def only(self, places: NDArray) -> Junctions:
        """The same of some places."""
        kept = np.isin(self.sides.place, places)
        row = np.cumsum(kept) - 1
        p, r = kept[self.pairs.touched], kept[self.ridges.side]
        return Junctions(
            replace(self.places, sides=self.sides[kept]),
            Pairs(row[self.pairs.touched[p]], row[self.pairs.other[p]], self.pairs.kind[p]),
            Ridges(
                row[self.ridges.side[r]],
                row[self.ridges.other[r]],
                self.ridges.normal[r],
                self.ridges.along[r],
                self.ridges.bend[r],
            ),
        )


def junctions(places: Places, solid: NDArray[np.bool_]) -> Junctions:
    """Pair the sides of every place; ``solid``: of each face, whether its material side is known from a solid."""
    sides = places.sides
    order = np.argsort(sides.place, kind="stable")
    first = np.searchsorted(sides.place[order], np.arange(places.count))
    counts = np.bincount(sides.place, minlength=places.count)
    touched, other = [np.empty(0, int)], [np.empty(0, int)]
    for size in np.unique(counts[counts > 1]):
        rows = order[first[counts == size][:, None] + np.arange(size)]
        for i in range(size):
            for j in range(size):
                if i != j:
                    touched.append(rows[:, i])
                    other.append(rows[:, j])
    a, b = np.concatenate(touched), np.concatenate(other)
    pairs = Pairs(a, b, _kinds(sides, a, b, counts, solid))
    return Junctions(places, pairs, _ridges(sides, pairs))


def least_at_sides(found: Junctions, tool: Tool, axis: ArrayLike = (0.0, 0.0, 1.0)) -> NDArray:
    """The least f [1/mm] of a tool that touches each side: -inf in a concave corner, nan where it cannot touch, (n,).

    Where normal and axis agree the tool may stand on any side of the contact: the best of eight counts.
    """
    sides = found.sides
    least = _least(found, tool, axis, None)
    level = approach(sides.normal, axis).theta <= ANGLE
    if level.any():
        of = np.isin(sides.place, sides.place[level])
        here = found.only(sides.place[level])
        middle = here.sides.direction(0.5)
        turns = [2.0 * np.pi * k / _TURNS for k in range(_TURNS)]
        tried = [_least(here, tool, axis, _turned(middle, here.sides.normal, t))[level[of]] for t in turns]
        least[level] = np.max(tried, axis=0)
    return least


def least_on_ridges(found: Junctions, tool: Tool, axis: ArrayLike = (0.0, 0.0, 1.0)) -> NDArray:
    """The least f [1/mm] of a tool that stands on each ridge, along it; nan where it cannot, (k,).

    Only between two sides which the tool reaches: under the edge of one that is turned away it does not go.
    """
    r, sides = found.ridges, found.sides
    seen = approach(r.normal, axis)
    steepest = np.maximum(*(approach(sides.normal[k], axis).theta for k in (r.side, r.other)))
    contact = tool.contact(seen.theta)
    x, y = _dot(r.along, seen.uphill), _dot(r.along, np.cross(r.normal, seen.uphill))
    f = _section(contact.weaker, contact.around, x, y) - r.bend
    return np.where(steepest <= 0.5 * np.pi + BEYOND, f, np.nan)


def _least(found: Junctions, tool: Tool, axis: ArrayLike, toward: NDArray | None = None) -> NDArray:
    sides, pairs = found.sides, found.pairs
    seen = approach(sides.normal, axis, toward)
    reached = seen.theta <= 0.5 * np.pi + BEYOND
    least = np.full(len(sides), np.nan)
    least[reached] = _in_sector(sides[reached], tool, seen.theta[reached], seen.uphill[reached])
    for kind in (Join.TANGENT, Join.CONCAVE):
        mine = (pairs.kind == kind) & reached[pairs.touched]
        a, b = pairs.touched[mine], pairs.other[mine]
        if kind == Join.TANGENT:
            value = _in_sector(sides[b], tool, seen.theta[a], seen.uphill[a])
        else:
            value = _in_corner(sides[a], sides[b], tool, axis)
        np.minimum.at(least, a, value)
    return least


def _in_sector(sides: Sides, tool: Tool, theta: NDArray, uphill: NDArray) -> NDArray:
    """Tool against sides in their sectors; ``uphill`` of the normal touched, which theirs may miss by a hair."""
    e1 = uphill - _dot(uphill, sides.normal)[:, None] * sides.normal
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    e2 = np.cross(sides.normal, e1)
    part = Tensor(*(np.einsum("ni,nij,nj->n", a, sides.bend, b) for a, b in ((e1, e1), (e1, e2), (e2, e2))))
    start = np.arctan2(_dot(sides.start, e2), _dot(sides.start, e1))
    end = _aligned(start + sides.width)
    start = _aligned(start)
    return least_in_sectors(tool.contact(theta), part, start, end - start)


def _aligned(angle: NDArray) -> NDArray:
    """Directions [rad] put onto the border of the tool's two sides, across uphill, where they all but lie on it."""
    border = (np.round(angle / np.pi - 0.5) + 0.5) * np.pi
    return np.where(np.abs(angle - border) <= _ALIGNED, border, angle)


def _in_corner(touched: Sides, other: Sides, tool: Tool, axis: ArrayLike) -> NDArray:
    """Tool in concave corners: along the corner where a sharp edge fits between both sides, else -inf."""
    one, two = approach(touched.normal, axis), approach(other.normal, axis)
    level = (one.theta <= ANGLE) | (two.theta <= ANGLE)
    apart = np.where(level, 0.0, np.arctan2(np.linalg.norm(np.cross(one.out, two.out), axis=1), _dot(one.out, two.out)))
    fits = tool.fits_corner(one.theta, two.theta, apart)
    along = np.cross(touched.normal, other.normal)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    found = np.full(len(touched), np.inf)
    for side, seen in ((touched, one), (other, two)):
        bend = np.einsum("ni,nij,nj->n", along, side.bend, along)
        found = np.minimum(found, tool.contact(seen.theta).around - bend)
    return np.where(fits, found, -np.inf)


def _section(meridian: NDArray, around: NDArray, x: NDArray, y: NDArray) -> NDArray:
    """Normal curvature [1/mm] of a tool in the direction x uphill, y across; inf across a sharp edge."""
    sharp = np.isinf(meridian)
    smooth = np.where(sharp, 0.0, meridian) * x * x + np.where(np.isinf(around), 0.0, around) * y * y
    return np.where(np.isinf(around) | (sharp & (np.abs(x) > 1e-6)), np.inf, smooth)


def _kinds(sides: Sides, a: NDArray, b: NDArray, counts: NDArray, solid: NDArray) -> NDArray[np.intp]:
    """`Join` of pairs of sides: how the other one stands to the tangent plane of the one that is touched."""
    one, two = sides[a], sides[b]
    facing = _dot(one.normal, two.normal)
    apart = np.arctan2(np.linalg.norm(np.cross(one.normal, two.normal), axis=1), facing)
    rises = two.highest(one.normal, _TRIM)
    kind = np.where(rises > np.sin(SMOOTH) * np.sin(_TRIM), Join.CONCAVE, Join.CONVEX)
    kind = np.where(apart <= SMOOTH, Join.TANGENT, kind)
    folded = np.pi - apart <= SMOOTH
    kind = np.where(folded, _folded(one, two), kind)
    halves = (np.abs(one.width - np.pi) < 1e-3) & (np.abs(two.width - np.pi) < 1e-3) & (counts[one.place] == 2)
    against = halves & (_dot(one.start, two.start) > 0.5) & ~(solid[one.face] & solid[two.face])
    return np.where(against, Join.DISAGREE, kind)


def _folded(one: Sides, two: Sides) -> NDArray[np.intp]:
    """Opposite normals: a knife's edge is convex, a crack between two sides that touch each other is concave."""
    way = two.direction(0.5)
    gap = [np.einsum("ni,nij,nj->n", way, s.bend, way) for s in (one, two)]
    return np.where(-gap[1] - gap[0] > TIE, Join.CONCAVE, Join.CONVEX)


def _ridges(sides: Sides, pairs: Pairs) -> Ridges:
    """Normals between those of convex edges' two sides where the edge is more hollow than along either of them.

    At an edge's end it goes on one way only; there its neighbours stand for it. The edge's curvature vector has the
    components of both sides along their normals (Meusnier).
    """
    half = np.abs(sides.width - np.pi) < 1e-3
    p = (pairs.kind == Join.CONVEX) & (pairs.touched < pairs.other) & half[pairs.touched] & half[pairs.other]
    a, b = pairs.touched[p], pairs.other[p]
    n1, n2 = sides.normal[a], sides.normal[b]
    cosine = _dot(n1, n2)
    fan = np.arctan2(np.linalg.norm(np.cross(n1, n2), axis=1), cosine)
    along = np.cross(n1, n2) / np.maximum(np.sin(fan), 1e-300)[:, None]
    k1, k2 = (np.einsum("ni,nij,nj->n", along, sides.bend[i], along) for i in (a, b))
    with np.errstate(divide="ignore", invalid="ignore"):
        steepest = np.arctan2((k2 - cosine * k1) / np.sin(fan), k1) / fan
    shares = steepest[:, None]
    with np.errstate(invalid="ignore"):
        inside = (shares > _APART) & (shares < 1.0 - _APART) & ((fan > SMOOTH) & (np.pi - fan > SMOOTH))[:, None]
        first, second = np.sin((1.0 - shares) * fan[:, None]), np.sin(shares * fan[:, None])
        bend = (first * k1[:, None] + second * k2[:, None]) / np.sin(fan)[:, None]
        row, column = np.nonzero(inside & (bend > 0.0))
    weight = [(w / np.sin(fan)[:, None])[row, column][:, None] for w in (first, second)]
    normal = weight[0] * n1[row] + weight[1] * n2[row]
    return Ridges(a[row], b[row], normal, along[row], bend[row, column])


def _turned(way: NDArray, normal: NDArray, angle: float) -> NDArray:
    return np.cos(angle) * way + np.sin(angle) * np.cross(normal, way)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ni,ni->n", a, b)
