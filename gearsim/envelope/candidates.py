"""Where rays meet the closed-form classes of the machined surface, before trimming."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from gearsim.cutters.profile import Profile
from gearsim.envelope.surface import BRANCHES, envelope_grid, envelope_points
from gearsim.envelope.trim import distance_rate
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource

_POSES = 192
_PER_ELEMENT = 12
_ANGLES = 24
_WALKS = 8
_STEPS = 30
_LONGEST_STEP = 1.0
_BEYOND = 0.5
_CONVERGED = 1e-9
_SETTLED = 1e-11
_JOINT_SLACK = 1e-3
_EDGE_SLACK = 1e-9
_PROBES = 48


class Kind(IntEnum):
    """The closed-form classes of the machined surface."""

    ENVELOPE = 1
    JOINT = 2
    PATH_END = 3
    EDGE = 4


class Crossings(NamedTuple):
    """Candidate crossings, each field of shape (n,): ray index, parameter [mm], class, piece and t.

    ``element``, ``s`` [mm] and ``branch`` locate an ENVELOPE point on the profile; they are -1, nan and 0
    for the other classes.
    """

    ray: NDArray
    tau: NDArray
    kind: NDArray
    piece: NDArray
    t: NDArray
    element: NDArray
    s: NDArray
    branch: NDArray


class _Guess(NamedTuple):
    """Starting points of Newton's method: a ray, a pose, and a place on the tool (s, or an edge angle)."""

    ray: NDArray
    piece: NDArray
    t: NDArray
    element: NDArray
    place: NDArray
    branch: NDArray


def all_candidates(rays: RayBundle, source: MotionSource, cutter: Profile) -> Crossings:
    """Crossings of every class inside the rays' windows."""
    found, at_joints = _envelope_crossings(rays, source, cutter)
    parts = [found, _pose_crossings(rays, source, cutter, at_joints)]
    if cutter.edges:
        parts.append(_edge_crossings(rays, source, cutter))
    joined = Crossings(*(np.concatenate(column) for column in zip(*parts, strict=True)))
    inside = (joined.tau >= rays.start[joined.ray]) & (joined.tau <= rays.end[joined.ray])
    return Crossings(*(column[inside] for column in joined))


def _envelope_crossings(
    rays: RayBundle, source: MotionSource, cutter: Profile
) -> tuple[Crossings, tuple[NDArray, NDArray]]:
    """ENVELOPE crossings, and the (ray, joint) pairs where a contact may have run off its piece."""
    walked = _newton(rays, source, cutter, _seeds(rays, source, cutter), _WALKS, walk=True)[0]
    guess = _with_neighbours(walked, source.pieces)
    solved, tau, settled = _newton(rays, source, cutter, guess, _STEPS, walk=False)
    length = np.array([e.length for e in cutter.elements])[solved.element]
    good = settled & _within(solved.t, 1.0) & _within(solved.place, length)
    chosen = _Guess(*(column[good] for column in solved))
    kind = np.full(len(chosen.ray), Kind.ENVELOPE)
    crossings = Crossings(
        chosen.ray, tau[good], kind, chosen.piece, chosen.t, chosen.element, chosen.place, chosen.branch
    )
    early, late = ~settled | (solved.t < _JOINT_SLACK), ~settled | (solved.t > 1.0 - _JOINT_SLACK)
    ray = np.concatenate([solved.ray[early], solved.ray[late]])
    joint = np.concatenate([solved.piece[early], solved.piece[late] + 1])
    return crossings, (ray, joint)


def _seeds(rays: RayBundle, source: MotionSource, cutter: Profile) -> _Guess:
    """For each ray the nearest envelope point of every profile element and branch within its window."""
    grid = envelope_grid(source, cutter, _POSES, _PER_ELEMENT)
    guesses = []
    for i in range(len(cutter.elements)):
        columns = np.flatnonzero(grid.element == i)
        for k, branch in enumerate(BRANCHES):
            pose, column = np.nonzero(grid.exists[:, columns, k])
            ray, nearest = _nearest(rays, grid.point[pose, columns[column], k])
            pose, column = pose[nearest], columns[column[nearest]]
            same = np.full(len(ray), i), grid.s[column], np.full(len(ray), branch)
            guesses.append(_Guess(ray, grid.piece[pose], grid.t[pose], *same))
    return _Guess(*(np.concatenate(column) for column in zip(*guesses, strict=True)))


def _nearest(rays: RayBundle, points: NDArray) -> tuple[NDArray, NDArray]:
    """For each ray with a grid point within its window's length of its origin, the nearest one."""
    if not len(points):
        return np.empty(0, dtype=int), np.empty(0, dtype=int)
    distance, index = cKDTree(points).query(rays.origin)
    near = distance <= np.maximum(rays.end, -rays.start) + _LONGEST_STEP
    return np.flatnonzero(near), index[near]


def _with_neighbours(guess: _Guess, pieces: int) -> _Guess:
    """Each guess on its own piece and on the two beside it, without repeats."""
    ray, piece, t, element, place, branch = (np.tile(c, 3) for c in guess)
    shift = np.repeat([0, -1, 1], len(guess.ray))
    piece, t = piece + shift, np.clip(t - shift, -_BEYOND, 1.0 + _BEYOND)
    good = (piece >= 0) & (piece < pieces)
    key = np.stack([ray, piece, element, branch.astype(int)])[:, good]
    _, first = np.unique(key, axis=1, return_index=True)
    return _Guess(*(c[good][first] for c in (ray, piece, t, element, place, branch)))


def _newton(
    rays: RayBundle, source: MotionSource, cutter: Profile, guess: _Guess, steps: int, walk: bool
) -> tuple[_Guess, NDArray, NDArray]:
    """Solve X(t, s) = origin + tau direction; returns the solutions, tau, and which of them settled.

    ``walk``: a solution that runs off its piece goes on in the next one.
    """
    ray, piece, t, element, s, branch = (np.array(c) for c in guess)
    origin, direction = rays.origin[ray], rays.direction[ray]
    e1, e2 = _across(direction)
    live = np.arange(len(ray))
    for _ in range(steps):
        at = envelope_points(source, cutter, piece[live], t[live], element[live], s[live], branch[live])
        dt, ds, miss = _step(at.point - origin[live], at.point_t, at.point_s, e1[live], e2[live])
        s[live] += ds
        after = t[live] + dt
        if walk:
            onward = np.clip(np.floor(after).astype(int), -piece[live], source.pieces - 1 - piece[live])
            piece[live] += onward
            after -= onward
        t[live] = np.clip(after, -_BEYOND, 1.0 + _BEYOND)
        live = live[np.isfinite(miss) & (miss > _CONVERGED)]
    at = envelope_points(source, cutter, piece, t, element, s, branch)
    *_, miss = _step(at.point - origin, at.point_t, at.point_s, e1, e2)
    tau = _dot(at.point - origin, direction)
    return _Guess(ray, piece, t, element, s, branch), tau, np.nan_to_num(miss, nan=np.inf) < _SETTLED


def _step(miss: NDArray, by_t: NDArray, by_s: NDArray, e1: NDArray, e2: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """Newton step (dt, ds) that carries the point onto the ray, shortened to 1 mm; 0 where there is none."""
    m1, m2 = _dot(miss, e1), _dot(miss, e2)
    a, b, c, d = _dot(by_t, e1), _dot(by_s, e1), _dot(by_t, e2), _dot(by_s, e2)
    with np.errstate(invalid="ignore", divide="ignore"):
        det = a * d - b * c
        dt, ds = (b * m2 - d * m1) / det, (c * m1 - a * m2) / det
        moved = np.linalg.norm(by_t * dt[:, None] + by_s * ds[:, None], axis=1)
        scale = np.minimum(1.0, _LONGEST_STEP / np.maximum(moved, 1e-300))
    return np.nan_to_num(dt * scale), np.nan_to_num(ds * scale), np.hypot(m1, m2)


def _pose_crossings(rays: RayBundle, source: MotionSource, cutter: Profile, near: tuple[NDArray, NDArray]) -> Crossings:
    """JOINT and PATH_END crossings at the given (ray, joint) pairs; joint i is where piece i begins."""
    ray, joint = np.unique(np.stack(near), axis=1)
    tau, which = _tool_crossings(rays.part(ray), source, cutter, joint)
    ray, joint = ray[which], joint[which]
    point = rays.origin[ray] + tau[:, None] * rays.direction[ray]
    before = _rate_at(source, cutter, point, np.maximum(joint - 1, 0), np.ones(len(ray)))
    after = _rate_at(source, cutter, point, np.minimum(joint, source.pieces - 1), np.zeros(len(ray)))
    ends = (joint == 0) | (joint == source.pieces)
    lowest = ((before <= 1e-9) | (joint == 0)) & ((after >= -1e-9) | (joint == source.pieces))
    kind = np.where(ends, Kind.PATH_END, Kind.JOINT)
    last = joint == source.pieces
    n = int(lowest.sum())
    return Crossings(
        ray[lowest], tau[lowest], kind[lowest], np.where(last, joint - 1, joint)[lowest],
        np.where(last, 1.0, 0.0)[lowest], np.full(n, -1), np.full(n, np.nan), np.zeros(n),
    )  # fmt: skip


def _rate_at(source: MotionSource, cutter: Profile, point: NDArray, piece: NDArray, t: NDArray) -> NDArray:
    tip, axis = (s.derivatives() for s in source.pose(piece, t, 1))
    return distance_rate(cutter, point, tip[0], axis[0], tip[1], axis[1])[1]


def _tool_crossings(rays: RayBundle, source: MotionSource, cutter: Profile, joint: NDArray) -> tuple[NDArray, NDArray]:
    """Parameters where each ray crosses the tool standing at its joint, and which ray each belongs to."""
    last = joint == source.pieces
    pose = source.pose(np.where(last, joint - 1, joint), np.where(last, 1.0, 0.0), 0)
    tip, axis = pose.tip.value, pose.axis.value

    def distance(row: NDArray, tau: NDArray) -> NDArray:
        q = rays.origin[row] + tau[..., None] * rays.direction[row] - tip[row]
        z = _dot(q, axis[row])
        return cutter.signed_distance(np.linalg.norm(q - z[..., None] * axis[row], axis=-1), z)

    fraction = np.linspace(0.0, 1.0, _PROBES)
    tau = rays.start[:, None] + (rays.end - rays.start)[:, None] * fraction
    f = distance(np.arange(len(rays))[:, None], tau)
    row, k = np.nonzero((f[:, :-1] > 0.0) != (f[:, 1:] > 0.0))
    return _root(lambda x: distance(row, x), tau[row, k], tau[row, k + 1], f[row, k], f[row, k + 1]), row


def _root(f, a: NDArray, b: NDArray, fa: NDArray, fb: NDArray) -> NDArray:  # type: ignore[no-untyped-def]
    """Roots in brackets [a, b] by bisection with secant steps."""
    for i in range(80):
        x = 0.5 * (a + b) if i % 3 == 2 else (a * fb - b * fa) / (fb - fa)
        x = np.clip(np.where(np.isfinite(x), x, 0.5 * (a + b)), np.minimum(a, b), np.maximum(a, b))
        fx = f(x)
        left = (fx > 0.0) == (fa > 0.0)
        a, fa = np.where(left, x, a), np.where(left, fx, fa)
        b, fb = np.where(left, b, x), np.where(left, fb, fx)
        if np.max(np.minimum(np.abs(b - a), np.minimum(np.abs(fa), np.abs(fb))), initial=0.0) < 1e-14:
            break
    return np.where(np.abs(fa) < np.abs(fb), a, b)


def _edge_crossings(rays: RayBundle, source: MotionSource, cutter: Profile) -> Crossings:
    """EDGE crossings: sharp circles of the profile swept along the motion."""
    guesses = []
    each = max(1, -(-_POSES // source.pieces))
    angles = 2.0 * np.pi * np.arange(_ANGLES) / _ANGLES
    piece = np.repeat(np.arange(source.pieces), each * _ANGLES)
    t = np.tile(np.repeat((np.arange(each) + 0.5) / each, _ANGLES), source.pieces)
    angle = np.tile(angles, source.pieces * each)
    for edge in cutter.edges:
        label = np.full(len(t), edge)
        points = _edge_jet(source, cutter, piece, t, label, angle)[0]
        ray, nearest = _nearest(rays, points)
        no_branch = np.zeros(len(ray))
        guesses.append(_Guess(ray, piece[nearest], t[nearest], label[nearest], angle[nearest], no_branch))
    seed = _Guess(*(np.concatenate(column) for column in zip(*guesses, strict=True)))
    seed = _with_neighbours(seed, source.pieces)
    return _solve_edges(rays, source, cutter, seed)


def _solve_edges(rays: RayBundle, source: MotionSource, cutter: Profile, guess: _Guess) -> Crossings:
    ray, piece, t, edge, angle, _ = (np.array(c) for c in guess)
    origin, direction = rays.origin[ray], rays.direction[ray]
    e1, e2 = _across(direction)
    for _ in range(_STEPS):
        point, by_t, by_angle = _edge_jet(source, cutter, piece, t, edge, angle)
        dt, da, _ = _step(point - origin, by_t, by_angle, e1, e2)
        t, angle = np.clip(t + dt, -_BEYOND, 1.0 + _BEYOND), angle + da
    point, by_t, by_angle = _edge_jet(source, cutter, piece, t, edge, angle)
    *_, miss = _step(point - origin, by_t, by_angle, e1, e2)
    good = (np.nan_to_num(miss, nan=np.inf) < _SETTLED) & _within(t, 1.0)
    n = int(good.sum())
    return Crossings(
        ray[good], _dot(point - origin, direction)[good], np.full(n, Kind.EDGE), piece[good], t[good],
        np.full(n, -1), np.full(n, np.nan), np.zeros(n),
    )  # fmt: skip


def _edge_jet(
    source: MotionSource, cutter: Profile, piece: NDArray, t: NDArray, edge: NDArray, angle: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Points of a profile edge's circle and their derivatives by t and by the angle about the axis.

    The angle counts from the projection of a fixed direction, whose own turning with the axis adds only
    a motion along the circle; the derivative by t leaves it out.
    """
    tip, axis = (s.derivatives() for s in source.pose(piece, t, 1))
    ends = np.array([cutter.elements[e].end for e in range(len(cutter.elements))])[edge]
    fixed = np.eye(3)[np.argmin(np.abs(axis[0]), axis=1)]
    x = fixed - _dot(fixed, axis[0])[:, None] * axis[0]
    x /= np.linalg.norm(x, axis=1, keepdims=True)
    y = np.cross(axis[0], x)
    c, s = np.cos(angle)[:, None], np.sin(angle)[:, None]
    u, around = c * x + s * y, c * y - s * x
    r, z = ends[:, :1], ends[:, 1:]
    u_rate = -_dot(u, axis[1])[:, None] * axis[0]
    return tip[0] + z * axis[0] + r * u, tip[1] + z * axis[1] + r * u_rate, r * around


def _within(value: NDArray, length: NDArray | float) -> NDArray:
    return (value >= -_EDGE_SLACK) & (value <= length + _EDGE_SLACK)


def _across(direction: NDArray) -> tuple[NDArray, NDArray]:
    """Two unit vectors normal to each direction and to each other."""
    fixed = np.eye(3)[np.argmin(np.abs(direction), axis=1)]
    e1 = np.cross(direction, fixed)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return e1, np.cross(direction, e1)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
