"""Newton's method on the charts, and crossings of the tool at rest, in NumPy: the twins of kernels/crossing.py."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.swept import Guess
from gearsim.geometry.rays import RayBundle
from gearsim.motion.sources import MotionSource
from tests.envelope.twins.roots import roots, sign_changes

_LONGEST_STEP = 1.0
_BEYOND = 0.5
_CONVERGED = 1e-9
_SETTLED = 1e-11
_ROUNDING = 1e-15
_PROBES = 48

# Points of a class with their derivatives by t and by place, for (piece, t, element, place, branch).
JetPoints = tuple[NDArray, NDArray, NDArray]
Jet = Callable[..., JetPoints]


def newton(rays: RayBundle, jet: Jet, guess: Guess, steps: int, walk: int = 0) -> tuple[Guess, NDArray, NDArray]:
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


def tool_crossings(rays: RayBundle, source: MotionSource, cutter: Profile, joint: NDArray) -> tuple[NDArray, NDArray]:
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


def _across(direction: NDArray) -> tuple[NDArray, NDArray]:
    """Two unit vectors normal to each direction and to each other."""
    fixed = np.eye(3)[np.argmin(np.abs(direction), axis=1)]
    e1 = np.cross(direction, fixed)
    e1 /= np.linalg.norm(e1, axis=1, keepdims=True)
    return e1, np.cross(direction, e1)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
