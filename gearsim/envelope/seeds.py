"""Where to start looking: for each ray, nearby points of every closed-form class."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from gearsim.cutters.profile import Profile
from gearsim.envelope.surface import BRANCHES, envelope_grid, radial_direction
from gearsim.envelope.trim import distance_rate
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource

_POSES = 192
_PER_RAY = 4 * _POSES
_PER_ELEMENT = 12
_ANGLES = 24
_ANGLE_SPACING = 2.0
_PROBE_STEP = 0.4
_SLACK = 1.0
_SEVERAL = 5
_CHUNK = 1 << 20
_TURNS = 10
_HALVINGS = 40
_GRAZES = 0.05


PointsAt = Callable[[NDArray, NDArray, NDArray, NDArray], tuple[Any, ...]]


class Guess(NamedTuple):
    """Starting points of Newton's method, each field of shape (n,): a ray, a pose, a place on the tool.

    ``place`` is the arc length s [mm] on a profile ``element``, or the angle [rad] on the edge that ends it.
    """

    ray: NDArray
    piece: NDArray
    t: NDArray
    element: NDArray
    place: NDArray
    branch: NDArray


def probes(rays: RayBundle, thorough: bool, slack: float = _SLACK) -> tuple[NDArray, NDArray, NDArray]:
    """Points to look from, shape (n, 3), their rays, and how far to look [mm].

    The rays' origins; if ``thorough``, points all along the windows instead. ``slack`` [mm]: how far samples lie apart.
    """
    every = np.arange(len(rays))
    if not thorough:
        return rays.origin, every, np.maximum(rays.end, -rays.start) + slack
    count = np.ceil((rays.end - rays.start) / _PROBE_STEP).astype(int) + 1
    ray = np.repeat(every, count)
    index = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
    tau = rays.start[ray] + (rays.end - rays.start)[ray] * index / np.maximum(count - 1, 1)[ray]
    return rays.origin[ray] + tau[:, None] * rays.direction[ray], ray, np.full(len(ray), slack)


def envelope_seeds(rays: RayBundle, source: MotionSource, cutter: Profile, thorough: bool) -> Guess:
    """The nearest envelope point of every profile element and branch to each probe."""
    grid = envelope_grid(source, cutter, _POSES, _PER_ELEMENT)
    where = probes(rays, thorough, max(_SLACK, max(e.length for e in cutter.elements) / _PER_ELEMENT))
    guesses = []
    for i in range(len(cutter.elements)):
        columns = np.flatnonzero(grid.element == i)
        for k, branch in enumerate(BRANCHES):
            pose, column = np.nonzero(grid.exists[:, columns, k])
            ray, nearest = _nearest(where, grid.point[pose, columns[column], k])
            pose, column = pose[nearest], columns[column[nearest]]
            same = np.full(len(ray), i), grid.s[column], np.full(len(ray), branch)
            guesses.append(Guess(ray, grid.piece[pose], grid.t[pose], *same))
    return joined(guesses)


def pose_seeds(rays: RayBundle, source: MotionSource, cutter: Profile) -> tuple[Guess, NDArray]:
    """For each ray the pose that comes closest to its origin, and the one that holds the machined surface on it.

    Where grazing curves run along the feed, or joints cut most of a surface, the nearest envelope point may lie many
    pieces away from the pose that cuts. Where the tool all but stands still, or turns about a point of its axis, its
    grazing point races around it, and Newton's method steps over the moment: the pose that comes closest is sought
    instead, and the ray's parameter moved by the distance left until none is. Returns the points, too, shape (n, 3).
    """
    each = max(2, -(-_PER_RAY // source.pieces))
    piece = np.repeat(np.arange(source.pieces), each)
    sampled = piece, np.tile((np.arange(each) + 0.5) / each, source.pieces)
    tau, found = np.zeros(len(rays)), []
    looked: list[NDArray] = []
    for turn in range(_TURNS):
        points = rays.origin + tau[:, None] * rays.direction
        nearest = _closest_sample(points, source, cutter, sampled)
        at, t = sampled[0][nearest], sampled[1][nearest]
        if turn:
            t = _closest_moment(points, source, cutter, at, t, 1.0 / each)
        guess, distance, slope = _touched(rays, points, source, cutter, at, t)
        found.append(guess)
        looked.append(points)
        with np.errstate(divide="ignore", invalid="ignore"):
            step = np.where(slope < -_GRAZES, -distance / slope, distance)
        tau = np.clip(tau + step, rays.start, rays.end)
    return joined([found[-1], found[0]]), np.concatenate([looked[-1], looked[0]])


def _closest_sample(
    points: NDArray, source: MotionSource, cutter: Profile, sampled: tuple[NDArray, NDArray]
) -> NDArray:  # fmt: skip
    """Which of the sampled poses comes closest to each point, shape (n,)."""
    tip, axis = (s.value for s in source.pose(*sampled, 0))
    nearest = np.empty(len(points), dtype=int)
    step = max(1, _CHUNK // len(tip))
    for begin in range(0, len(points), step):
        q = points[begin : begin + step, None] - tip
        z = np.einsum("ijk,jk->ij", q, axis)
        r = np.sqrt(np.maximum(np.einsum("ijk,ijk->ij", q, q) - z * z, 0.0))
        nearest[begin : begin + step] = cutter.signed_distance(r, z).argmin(axis=1)
    return nearest


def _closest_moment(
    points: NDArray, source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray, spacing: float
) -> NDArray:  # fmt: skip
    """When on its piece, within a spacing of t, the tool comes closest to each point: where its approach ends."""
    early, late = np.maximum(t - spacing, 0.0), np.minimum(t + spacing, 1.0)
    for _ in range(_HALVINGS):
        middle = 0.5 * (early + late)
        tip, axis = (s.derivatives() for s in source.pose(piece, middle, 1))
        comes = distance_rate(cutter, points, tip[0], axis[0], tip[1], axis[1])[1] < 0.0
        early, late = np.where(comes, middle, early), np.where(comes, late, middle)
    return 0.5 * (early + late)


def _touched(
    rays: RayBundle, points: NDArray, source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray
) -> tuple[Guess, NDArray, NDArray]:  # fmt: skip
    """The profile's point nearest to each point at a pose; their distance [mm] and its rate along the ray."""
    (tip, tip_rate), (axis, axis_rate) = (s.derivatives() for s in source.pose(piece, t, 1))
    q = points - tip
    z = np.einsum("ij,ij->i", q, axis)
    w = q - z[:, None] * axis
    r = np.linalg.norm(w, axis=1)
    element, s = cutter.nearest(r, z)
    at = cutter.at(element, s)
    lever = (at.z * at.nr - at.r * at.nz)[:, None]
    g = at.nr[:, None] * tip_rate + lever * axis_rate
    branch = np.where(np.einsum("ij,ij->i", w, np.cross(axis, g)) < 0.0, -1.0, 1.0)
    distance, nr, nz = cutter.distance_gradient(r, z)
    normal = (nr / np.maximum(r, 1e-300))[:, None] * w + nz[:, None] * axis
    slope = np.einsum("ij,ij->i", normal, rays.direction)
    return Guess(np.arange(len(rays)), piece, t, element, s, branch), distance, slope


def angle_seeds(
    rays: RayBundle, source: MotionSource, cutter: Profile, elements: Sequence[int], jet: PointsAt, thorough: bool
) -> Guess:
    """The nearest points to each probe of surfaces over (t, angle about the axis), one an element.

    ``jet`` gives a surface's points, first, for (piece, t, element, angle).
    """
    each = max(1, -(-_POSES // source.pieces))
    angles = max(_ANGLES, int(np.ceil(2.0 * np.pi * cutter.max_radius / _ANGLE_SPACING)))
    piece = np.repeat(np.arange(source.pieces), each * angles)
    t = np.tile(np.repeat((np.arange(each) + 0.5) / each, angles), source.pieces)
    angle = np.tile(2.0 * np.pi * np.arange(angles) / angles, source.pieces * each)
    where = probes(rays, thorough, max(_SLACK, 0.5 * _ANGLE_SPACING))
    guesses = []
    for element in elements:
        label = np.full(len(t), element)
        points = jet(piece, t, label, angle)[0]
        exists = np.flatnonzero(np.isfinite(points[:, 0]))
        ray, near = _nearest(where, points[exists])
        near = exists[near]
        guesses.append(Guess(ray, piece[near], t[near], label[near], angle[near], np.zeros(len(ray))))
    return joined(guesses)


def edge_seeds(source: MotionSource, edges: Sequence[int], closest: Guess, points: NDArray) -> Guess:
    """Places on the circles of profile edges that face points, shape (n, 3), at the poses ``closest`` to them."""
    tip, axis = (s.value for s in source.pose(closest.piece, closest.t, 0))
    x, y = (radial_direction(axis, np.full(len(axis), angle)) for angle in (0.0, 0.5 * np.pi))
    q = points - tip
    angle = np.arctan2(np.einsum("ij,ij->i", q, y), np.einsum("ij,ij->i", q, x))
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
    _, first = np.unique(np.stack(columns), axis=1, return_index=True)
    return Guess(*(c[first] for c in guess))


def standing_tools(rays: RayBundle, source: MotionSource, cutter: Profile) -> tuple[NDArray, NDArray]:
    """(ray, joint) pairs where the tool standing in a joint pose comes near the ray's window.

    Joint i is the pose in which piece i begins; the last is the path's end.
    """
    joint = np.arange(source.pieces + 1)
    last = joint == source.pieces
    pose = source.pose(np.where(last, joint - 1, joint), np.where(last, 1.0, 0.0), 0)
    points, ray, _ = probes(rays, thorough=True)
    pairs = []
    step = max(1, _CHUNK // len(joint))
    for begin in range(0, len(points), step):
        q = points[begin : begin + step, None] - pose.tip.value
        z = np.einsum("ijk,jk->ij", q, pose.axis.value)
        r = np.sqrt(np.maximum(np.einsum("ijk,ijk->ij", q, q) - z * z, 0.0))
        i, j = np.nonzero(np.abs(cutter.signed_distance(r, z)) < _PROBE_STEP)
        pairs.append(np.stack([ray[begin + i], joint[j]]))
    found = np.unique(np.concatenate(pairs, axis=1), axis=1) if pairs else np.empty((2, 0), dtype=int)
    return found[0], found[1]


def _nearest(where: tuple[NDArray, NDArray, NDArray], points: NDArray) -> tuple[NDArray, NDArray]:
    """For each probe the nearest points within its reach, as (ray, point) pairs."""
    if not len(points):
        return np.empty(0, dtype=int), np.empty(0, dtype=int)
    probe, ray, reach = where
    k = _SEVERAL if len(np.unique(ray)) < len(ray) else 1
    distance, index = cKDTree(points).query(probe, k=min(k, len(points)))
    near, column = np.nonzero(distance.reshape(len(probe), -1) <= reach[:, None])
    return ray[near], index.reshape(len(probe), -1)[near, column]


def joined(guesses: list[Guess]) -> Guess:
    """Guesses one after the other."""
    return Guess(*(np.concatenate(column) for column in zip(*guesses, strict=True)))
