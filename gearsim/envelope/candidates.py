"""Where rays meet the closed-form classes of the machined surface, before trimming."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.envelope.roots import roots, sign_changes
from gearsim.envelope.seeds import (
    Guess,
    angle_seeds,
    distinct,
    edge_seeds,
    envelope_seeds,
    joined,
    pose_seeds,
    standing_tools,
    with_neighbours,
)
from gearsim.envelope.surface import arc_jet, disc_jet, edge_jet, envelope_points, line_jet
from gearsim.envelope.trim import distance_rate
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource

_WALKS = 8
_STEPS = 30
_LONGEST_STEP = 1.0
_BEYOND = 0.5
_CONVERGED = 1e-9
_SETTLED = 1e-11
_ROUNDING = 1e-15
_JOINT_SLACK = 1e-3
_EDGE_SLACK = 1e-9
_PROBES = 48
_WIDE = 8.0

# Points of a class with their derivatives by t and by place, for (piece, t, element, place, branch).
JetPoints = tuple[NDArray, NDArray, NDArray]
Jet = Callable[..., JetPoints]


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


def all_candidates(rays: RayBundle, source: MotionSource, cutter: Profile, thorough: bool = False) -> Crossings:
    """Crossings of every class inside the rays' windows.

    Looks near the rays' origins, where a measured surface lies; ``thorough`` looks along the whole windows.
    """
    closest = pose_seeds(rays, source, cutter) if thorough else None
    found, at_joints = _envelope_crossings(rays, source, cutter, closest)
    if thorough:
        at_joints = standing_tools(rays, source, cutter)
    parts = [found, _pose_crossings(rays, source, cutter, at_joints)]
    edges = _circles(cutter, thorough)
    if edges:
        parts.append(_edge_crossings(rays, source, cutter, edges, closest))
    joined = _joined(parts)
    inside = (joined.tau >= rays.start[joined.ray]) & (joined.tau <= rays.end[joined.ray])
    return Crossings(*(column[inside] for column in joined))


def _envelope_crossings(
    rays: RayBundle, source: MotionSource, cutter: Profile, closest: tuple[Guess, NDArray] | None
) -> tuple[Crossings, tuple[NDArray, NDArray]]:
    """ENVELOPE crossings, and the (ray, joint) pairs where a contact may have run off its piece.

    A thorough search starts from the ``closest`` poses, too.
    """
    thorough = closest is not None

    def jet(piece: NDArray, t: NDArray, element: NDArray, s: NDArray, branch: NDArray) -> JetPoints:
        at = envelope_points(source, cutter, piece, t, element, s, branch)
        return at.point, at.point_t, at.point_s

    seeds = distinct(envelope_seeds(rays, source, cutter, thorough), thorough)
    walked = _newton(rays, jet, seeds, _WALKS, source.pieces)[0]
    if closest is not None:
        walked = joined([closest[0], walked])
    guess = distinct(with_neighbours(walked, source.pieces, _BEYOND), thorough)
    solved, tau, settled = _newton(rays, jet, guess, _STEPS)
    early, late = ~settled | (solved.t < _JOINT_SLACK), ~settled | (solved.t > 1.0 - _JOINT_SLACK)
    ray = np.concatenate([solved.ray[early], solved.ray[late]])
    joint = np.concatenate([solved.piece[early], solved.piece[late] + 1])
    found = _on_the_profile(cutter, solved, tau, settled)
    if thorough:
        charts = {"arc": arc_jet, "flat": disc_jet, "line": line_jet}
        found = _joined([found, *(_folded_crossings(rays, source, cutter, *c) for c in charts.items())])
    return found, (ray, joint)


def _folded_crossings(
    rays: RayBundle, source: MotionSource, cutter: Profile, kind: str, chart: Callable[..., tuple[NDArray, ...]]
) -> Crossings:
    """ENVELOPE crossings of one kind of element in the chart that is regular where the usual one folds."""
    elements = [i for i, e in enumerate(cutter.elements) if e.kind == kind]

    def jet(piece: NDArray, t: NDArray, element: NDArray, angle: NDArray, _: NDArray | None = None) -> JetPoints:
        point, by_t, by_angle, *_rest = chart(source, cutter, piece, t, element, angle)
        return point, by_t, by_angle

    if not elements:
        return Crossings(*(np.empty(0, dtype=k) for k in (int, float, int, int, float, int, float, float)))
    solved, tau, settled = _solve_angles(rays, source, cutter, elements, jet, thorough=True)
    *_, s, branch = chart(source, cutter, solved.piece, solved.t, solved.element, solved.place)
    return _on_the_profile(cutter, solved._replace(place=s, branch=branch), tau, settled)


def _circles(cutter: Profile, thorough: bool) -> tuple[int, ...]:
    """Sharp edges of the profile; if ``thorough``, the rims of its discs and annuli too.

    A disc that slides in its own plane has no grazing point, and its rim sweeps what it leaves.
    """
    flats = [i for i, e in enumerate(cutter.elements) if e.is_flat] if thorough else []
    rims = [i for i in flats if cutter.elements[i].end[0] > 0.0]
    rims += [(i - 1) % len(cutter.elements) for i in flats if cutter.elements[i].start[0] > 0.0]
    return tuple(sorted({*cutter.edges, *rims}))


def _edge_crossings(
    rays: RayBundle, source: MotionSource, cutter: Profile, edges: tuple[int, ...],
    closest: tuple[Guess, NDArray] | None,
) -> Crossings:  # fmt: skip
    """EDGE crossings: circles of the profile swept along the motion; thorough ones start from the ``closest`` poses."""

    def jet(piece: NDArray, t: NDArray, edge: NDArray, angle: NDArray, _: NDArray | None = None) -> JetPoints:
        return edge_jet(source, cutter, piece, t, edge, angle)

    extra = edge_seeds(source, edges, *closest) if closest is not None else None
    solved, tau, settled = _solve_angles(rays, source, cutter, edges, jet, closest is not None, extra)
    good = settled & _within(solved.t, 1.0)
    n = int(good.sum())
    return Crossings(
        solved.ray[good], tau[good], np.full(n, Kind.EDGE), solved.piece[good], solved.t[good],
        np.full(n, -1), np.full(n, np.nan), np.zeros(n),
    )  # fmt: skip


def _solve_angles(
    rays: RayBundle, source: MotionSource, cutter: Profile, elements: Sequence[int], jet: Jet, thorough: bool,
    extra: Guess | None = None,
) -> tuple[Guess, NDArray, NDArray]:  # fmt: skip
    """Newton's method on surfaces over (t, angle about the axis), from their nearest points and ``extra`` ones."""
    seeds = angle_seeds(rays, source, cutter, elements, jet, thorough)
    seeds = joined([extra, seeds]) if extra is not None else seeds
    guess = with_neighbours(seeds, source.pieces, _BEYOND)
    return _newton(rays, jet, distinct(guess, fine=True, scale=max(1.0, cutter.max_radius / _WIDE)), _STEPS)


def _on_the_profile(cutter: Profile, solved: Guess, tau: NDArray, settled: NDArray) -> Crossings:
    """The settled solutions that lie on their piece of the path and their element of the profile.

    Past the axis a ball's arc or a disc runs back over itself: such places are turned back onto the element.
    """
    length = np.array([e.length for e in cutter.elements])[solved.element]
    starts, ends = np.array([_on_the_axis(e) for e in cutter.elements])[solved.element].T
    place = np.where(starts, np.abs(solved.place), solved.place)
    place = np.where(ends, length - np.abs(length - place), place)
    good = settled & _within(solved.t, 1.0) & _within(place, length)
    ray, piece, t, element, place, branch = (column[good] for column in solved._replace(place=place))
    return Crossings(ray, tau[good], np.full(len(ray), Kind.ENVELOPE), piece, t, element, place, branch)


def _on_the_axis(e: Element) -> tuple[bool, bool]:
    """Whether the element crosses the axis at right angles where it starts, and where it ends."""
    square = e.is_flat or (e.is_arc and abs(e.centre[0]) < 1e-12)
    return square and e.start[0] < 1e-12, square and e.end[0] < 1e-12


def _joined(parts: list[Crossings]) -> Crossings:
    return Crossings(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _newton(rays: RayBundle, jet: Jet, guess: Guess, steps: int, walk: int = 0) -> tuple[Guess, NDArray, NDArray]:
    """Solve point(t, place) = origin + tau direction; returns solutions, tau, and which of them settled.

    A step to where no point exists is taken back by halves: solutions can lie close to the surface's end.

    ``walk``: number of pieces; a solution that runs off its piece goes on in the next one (0: it stays).
    """
    ray, piece, t, element, place, branch = (np.array(c) for c in guess)
    origin, direction = rays.origin[ray], rays.direction[ray]
    e1, e2 = _across(direction)
    live, last = np.arange(len(ray)), np.zeros((2, len(ray)))
    for _ in range(steps):
        point, by_t, by_place = jet(piece[live], t[live], element[live], place[live], branch[live])
        dt, dplace, miss = _step(point - origin[live], by_t, by_place, e1[live], e2[live])
        lost = ~np.isfinite(miss)
        dt, dplace = (np.where(lost, -0.5 * back, step) for back, step in zip(last[:, live], (dt, dplace), strict=True))
        last[:, live] = np.where(lost, -1.0, 1.0) * np.stack([dt, dplace])
        place[live] += dplace
        after = t[live] + dt
        if walk:
            onward = np.clip(np.floor(after).astype(int), -piece[live], walk - 1 - piece[live])
            piece[live] += onward
            after -= onward
        t[live] = np.clip(after, -_BEYOND, 1.0 + _BEYOND)
        live = live[lost | (miss > _CONVERGED)]
    point, by_t, by_place = jet(piece, t, element, place, branch)
    *_, miss = _step(point - origin, by_t, by_place, e1, e2)
    tau = _dot(point - origin, direction)
    finest = _SETTLED + _ROUNDING * np.nan_to_num(np.linalg.norm(by_t, axis=1))  # t's last bit, where points race
    return Guess(ray, piece, t, element, place, branch), tau, np.nan_to_num(miss, nan=np.inf) < finest


def _step(
    miss: NDArray, by_t: NDArray, by_place: NDArray, e1: NDArray, e2: NDArray
) -> tuple[NDArray, NDArray, NDArray]:
    """Newton step that carries the point onto the ray, shortened to 1 mm; 0 where there is none."""
    m1, m2 = _dot(miss, e1), _dot(miss, e2)
    a, b, c, d = _dot(by_t, e1), _dot(by_place, e1), _dot(by_t, e2), _dot(by_place, e2)
    with np.errstate(invalid="ignore", divide="ignore"):
        det = a * d - b * c
        dt, dplace = (b * m2 - d * m1) / det, (c * m1 - a * m2) / det
        moved = np.linalg.norm(by_t * dt[:, None] + by_place * dplace[:, None], axis=1)
        scale = np.minimum(1.0, _LONGEST_STEP / np.maximum(moved, 1e-300))
    return np.nan_to_num(dt * scale), np.nan_to_num(dplace * scale), np.hypot(m1, m2)


def _pose_crossings(rays: RayBundle, source: MotionSource, cutter: Profile, near: tuple[NDArray, NDArray]) -> Crossings:
    """JOINT and PATH_END crossings at the given (ray, joint) pairs; joint i is where piece i begins."""
    ray, joint = np.unique(np.stack(near), axis=1)
    tau, which = _tool_crossings(rays.part(ray), source, cutter, joint)
    ray, joint = ray[which], joint[which]
    point = rays.origin[ray] + tau[:, None] * rays.direction[ray]
    before = _rate_at(source, cutter, point, np.maximum(joint - 1, 0), np.ones(len(ray)))
    after = _rate_at(source, cutter, point, np.minimum(joint, source.pieces - 1), np.zeros(len(ray)))
    last = joint == source.pieces
    ends = (joint == 0) | last
    lowest = ((before <= 1e-9) | (joint == 0)) & ((after >= -1e-9) | last)
    kind = np.where(ends, Kind.PATH_END, Kind.JOINT)
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
    row = np.repeat(np.arange(len(rays)), _PROBES - 1)
    row, a, b, fa, fb = sign_changes(
        distance, row, *(c.ravel() for c in (tau[:, :-1], tau[:, 1:], f[:, :-1], f[:, 1:]))
    )
    return roots(lambda x: distance(row, x), a, b, fa, fb), row


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
