"""Where to start looking: for each ray, nearby points of every closed-form class."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.nearby import PointCloud
from gearsim.envelope.surface import BRANCHES, envelope_grid, radial_axes
from gearsim.envelope.swept import Chart, Guess, Swept
from gearsim.geometry.rays import RayBundle

_POSES = 192
_PER_ELEMENT = 12
_ANGLES = 24
_ANGLE_SPACING = 2.0
_PROBE_STEP = 0.4
_SLACK = 1.0
_SEVERAL = 5
_CHUNK = 1 << 18
_TURNS = 10


class Probes(NamedTuple):
    """Points to look from, shape (n, 3), their rays, and how far to look [mm]."""

    point: NDArray
    ray: NDArray
    reach: NDArray


def probes(rays: RayBundle, thorough: bool, slack: float = _SLACK) -> Probes:
    """The rays' origins; if ``thorough``, points all along the windows. ``slack`` [mm]: how far samples lie apart."""
    every = np.arange(len(rays))
    if not thorough:
        return Probes(rays.origin, every, np.maximum(rays.end, -rays.start) + slack)
    count = np.ceil((rays.end - rays.start) / _PROBE_STEP).astype(int) + 1
    ray = np.repeat(every, count)
    index = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    tau = rays.start[ray] + (rays.end - rays.start)[ray] * index / np.maximum(count - 1, 1)[ray]
    return Probes(rays.origin[ray] + tau[:, None] * rays.direction[ray], ray, np.full(len(ray), slack))


class Seeds:
    """Sampled points of the classes of one motion of one cutter, and which of them lie near rays."""

    def __init__(self, swept: Swept) -> None:
        self._swept = swept

    @cached_property
    def _envelope(self) -> list[tuple[NDArray, PointCloud, Guess]]:
        """For every profile element and branch its grazing points, and where they are."""
        source, cutter = self._swept.source, self._swept.cutter
        grid = envelope_grid(source, cutter, _POSES, _PER_ELEMENT, self._swept.device)
        found = []
        for i in range(len(cutter.elements)):
            columns = np.flatnonzero(grid.element == i)
            for k, branch in enumerate(BRANCHES):
                pose, column = np.nonzero(grid.exists[:, columns, k])
                column = columns[column]
                if len(pose):
                    n = len(pose)
                    places = grid.piece[pose], grid.t[pose], np.full(n, i), grid.s[column], np.full(n, branch)
                    points = grid.point[pose, column, k]
                    found.append((points, PointCloud(points, self._swept.device), Guess(np.arange(n), *places)))
        return found

    def envelope(self, rays: RayBundle, thorough: bool) -> Guess:
        """The nearest envelope point of every profile element and branch to each probe."""
        slack = max(_SLACK, max(e.length for e in self._swept.cutter.elements) / _PER_ELEMENT)
        where = probes(rays, thorough, slack)
        if thorough:
            return joined([_several(where, points, places) for points, _, places in self._envelope])
        return joined([_nearest(where, cloud, places) for _, cloud, places in self._envelope])

    @cached_property
    def _poses(self) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Piece, t, tip and axis of about _POSES poses."""
        piece, t = spaced(self._swept.source.pieces, _POSES)
        tip, axis = self._swept.source.pose(piece, t, 0)
        return piece, t, tip.value, axis.value

    def circles(self, rays: RayBundle, elements: Sequence[int]) -> Guess:
        """For each of the circles that end elements the nearest of its sampled poses to each ray's origin."""
        piece, t, tip, axis = self._poses
        where = probes(rays, False, max(_SLACK, 0.5 * _ANGLE_SPACING))
        ends = np.array([self._swept.cutter.elements[e].end for e in elements])
        nearest = self._swept.nearest_circles((tip, axis), ends, where.point, where.reach)
        row, circle = np.nonzero(nearest >= 0)
        pose = nearest[row, circle]
        angle = _facing(where.point[row] - tip[pose], axis[pose])
        return Guess(row, piece[pose], t[pose], np.array(elements)[circle], angle, np.zeros(len(row)))

    def angles(self, rays: RayBundle, chart: Chart, elements: Sequence[int]) -> Guess:
        """The nearest points of surfaces over (t, angle about the axis), one an element, to probes in the windows."""
        angles = _angle_count(self._swept.cutter)
        poses, at = spaced(self._swept.source.pieces, _POSES)
        piece, t = np.repeat(poses, angles), np.repeat(at, angles)
        angle = np.tile(2.0 * np.pi * np.arange(angles) / angles, len(poses))
        where = probes(rays, True, max(_SLACK, 0.5 * _ANGLE_SPACING))
        guesses = []
        for element in elements:
            every = Guess(np.arange(len(t)), piece, t, np.full(len(t), element), angle, np.zeros(len(t)))
            points = self._swept.points(chart, every)
            exists = np.flatnonzero(np.isfinite(points[:, 0]))
            if len(exists):
                guesses.append(_several(where, points[exists], Guess(*(c[exists] for c in every))))
        return joined(guesses)

    def closest(self, rays: RayBundle) -> tuple[Guess, NDArray]:
        """For each ray the pose that comes closest to its origin, and the one that holds the machined surface on it.

        Where grazing curves run along the feed, or joints cut most of a surface, the nearest envelope point may lie
        many pieces away from the pose that cuts. Where the tool all but stands still, or turns about a point of its
        axis, its grazing point races around it, and Newton's method steps over the moment: the pose that comes closest
        is sought instead, and the ray's parameter moved by the distance left until none is. Returns the points, too,
        shape (2 n, 3).
        """
        first, holding, tau = self._swept.pursue(self._swept.rays(rays), _TURNS)
        points = np.concatenate([rays.origin + tau[:, None] * rays.direction, rays.origin])
        piece, t = (np.concatenate(pair) for pair in zip(holding, first, strict=True))
        return _touched(self._swept, np.tile(np.arange(len(rays)), 2), points, piece, t), points


def edge_seeds(swept: Swept, edges: Sequence[int], closest: Guess, points: NDArray) -> Guess:
    """Places on the circles of profile edges that face points, shape (n, 3), at the poses ``closest`` to them."""
    tip, axis = (s.value for s in swept.source.pose(closest.piece, closest.t, 0))
    angle = _facing(points - tip, axis)
    return joined([closest._replace(element=np.full(len(angle), e), place=angle, branch=0.0 * angle) for e in edges])


def with_neighbours(guess: Guess, pieces: int, beyond: float) -> Guess:
    """Each guess on its own piece and on the two beside it; of equal ones, the first."""
    ray, piece, t, element, place, branch = (np.tile(c, 3) for c in guess)
    shift = np.repeat([0, -1, 1], len(guess.ray))
    piece, t = piece + shift, np.clip(t - shift, -beyond, 1.0 + beyond)
    good = (piece >= 0) & (piece < pieces)
    return Guess(*(c[good] for c in (ray, piece, t, element, place, branch)))


def distinct(guess: Guess, fine: bool, scale: float = 1.0) -> Guess:
    """One guess per ray, piece, element and branch; if ``fine``, per place too, to half a unit over ``scale``."""
    columns = [guess.ray, guess.piece, guess.element, guess.branch.astype(int)]
    if fine:
        columns.append(np.round(2.0 * scale * guess.place).astype(int))
    key = np.zeros(len(guess.ray), dtype=np.int64)
    for column in columns:
        low, high = (int(f(initial=0)) for f in (column.min, column.max))
        key = key * (high - low + 1) + (column - low)
    _, first = np.unique(key, return_index=True)
    return Guess(*(c[first] for c in guess))


def standing_tools(rays: RayBundle, swept: Swept) -> tuple[NDArray, NDArray]:
    """(ray, joint) pairs where the tool standing in a joint pose comes near the ray's window.

    Joint i is the pose in which piece i begins; the last is the path's end.
    """
    pieces = swept.source.pieces
    joint = np.arange(pieces + 1)
    last = joint == pieces
    pose = swept.source.pose(np.where(last, joint - 1, joint), np.where(last, 1.0, 0.0), 0)
    points, ray, _ = probes(rays, thorough=True)
    pairs = []
    step = max(1, _CHUNK // len(joint))
    for begin in range(0, len(points), step):
        q = points[begin : begin + step, None] - pose.tip.value
        z = np.einsum("ijk,jk->ij", q, pose.axis.value)
        r = np.sqrt(np.maximum(np.einsum("ijk,ijk->ij", q, q) - z * z, 0.0))
        i, j = np.nonzero(np.abs(swept.cutter.signed_distance(r, z)) < _PROBE_STEP)
        pairs.append(np.stack([ray[begin + i], joint[j]]))
    found = np.unique(np.concatenate(pairs, axis=1), axis=1) if pairs else np.empty((2, 0), dtype=int)
    return found[0], found[1]


def spaced(pieces: int, poses: int) -> tuple[NDArray, NDArray]:
    """Piece and t of at least ``poses`` poses, equally many a piece."""
    each = max(1, -(-poses // pieces))
    return np.repeat(np.arange(pieces), each), np.tile((np.arange(each) + 0.5) / each, pieces)


def joined(guesses: list[Guess]) -> Guess:
    """Guesses one after the other."""
    none = Guess(*(np.empty(0, dtype=k) for k in (int, int, float, int, float, float)))
    return Guess(*(np.concatenate(column) for column in zip(none, *guesses, strict=True)))


def _touched(swept: Swept, ray: NDArray, points: NDArray, piece: NDArray, t: NDArray) -> Guess:
    """The profile's points nearest to points at poses."""
    (tip, tip_rate), (axis, axis_rate) = (s.derivatives() for s in swept.source.pose(piece, t, 1))
    q = points - tip
    z = np.einsum("ij,ij->i", q, axis)
    w = q - z[:, None] * axis
    element, s = swept.cutter.nearest(np.linalg.norm(w, axis=1), z)
    at = swept.cutter.at(element, s)
    lever = (at.z * at.nr - at.r * at.nz)[:, None]
    g = at.nr[:, None] * tip_rate + lever * axis_rate
    branch = np.where(np.einsum("ij,ij->i", w, np.cross(axis, g)) < 0.0, -1.0, 1.0)
    return Guess(ray, piece, t, element, s, branch)


def _facing(q: NDArray, axis: NDArray) -> NDArray:
    """The angle about the axis, as the charts count it, that faces points q from the tip."""
    x, y = radial_axes(axis)
    return np.arctan2(np.einsum("ij,ij->i", q, y), np.einsum("ij,ij->i", q, x))


def _angle_count(cutter: Profile) -> int:
    return max(_ANGLES, int(np.ceil(2.0 * np.pi * cutter.max_radius / _ANGLE_SPACING)))


def _nearest(where: Probes, cloud: PointCloud, places: Guess) -> Guess:
    """For each probe the nearest point within its reach."""
    nearest = cloud.nearest(where.point, where.reach)
    near = np.flatnonzero(nearest >= 0)
    return Guess(where.ray[near], *(c[nearest[near]] for c in places[1:]))


def _several(where: Probes, points: NDArray, places: Guess) -> Guess:
    """For each probe the nearest few points within its reach."""
    from scipy.spatial import cKDTree  # slow to load, and seldom needed

    tree = cKDTree(points)
    distance, index = tree.query(where.point, k=min(_SEVERAL, tree.n))
    near, column = np.nonzero(distance.reshape(len(where.point), -1) <= where.reach[:, None])
    point = index.reshape(len(where.point), -1)[near, column]
    return Guess(where.ray[near], *(c[point] for c in places[1:]))
