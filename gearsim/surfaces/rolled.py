"""The surface that a rolling head leaves, in the coordinates of the head itself.

A cradle carries the head round its axis while the gear turns: the head is a tooth of an imaginary gear, and
each of its points touches the gear's tooth at one cradle angle. So the tooth inherits the head's coordinates,
the angle u about its axis, in the frame that turns with the cradle, and v along its profile. A point r and
its normal n, carried by the frame, cut where

    f(u, v, phi) = n . r' = 0                                       (' by phi)

and the surface is X(u, v) = r at that phi, with X_u = r_u + phi_u r', phi_u = -f_u / f_phi. Over phi instead of u
(as in geometry/grazing.py) a chart folds where the head's circle runs along the tooth's pitch line: at a spiral
angle of 0 in the middle of the face, with one branch towards the toe and one towards the heel. Here it folds
only where f_phi = 0, which for a plane imaginary gear is its apex.

With a plain roll the speeds in the cradle's frame are constant but for turning back with phi, so that f is
a + b cos phi + c sin phi, known from three poses; a modified roll is solved for from there by Newton's method.

Points are candidates: what the slot keeps of them is what no other pose cuts away. For poses nearby that is told
by the second derivative of the distance F of a fixed point to the moving head,

    F'' = r' . H r' - n' . r' - f_phi,

H the head's shape operator. Where it is not positive, poses nearby cut deeper: the point is undercut. F'' passes
zero at the edge of regression, where the surface's curvature is infinite. At a sharp edge H, so F'', is infinite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import pi
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry import series
from gearsim.geometry.grazing import PARALLEL, MeridianPoints
from gearsim.geometry.pose import FrameSeries
from gearsim.geometry.series import Series
from gearsim.surfaces.generated import TURNS, GeneratedJet, Meridian, straight

Frames = Callable[[NDArray, int], FrameSeries]

_STEPS = 40
_SETTLED = 1e-13
_LARGEST_STEP = 0.2
_THIRDS = np.array([0.0, 2.0 * pi / 3.0, -2.0 * pi / 3.0])


class _Carried(NamedTuple):
    """Points and outward normals of the head, carried by its frame: derivatives by phi, each of shape (n, 3).

    ``out``, ``around`` and ``up`` are the radial direction, the one along rising u and the meridian's tangent.
    """

    r: list[NDArray]
    n: list[NDArray]
    out: list[NDArray]
    around: list[NDArray]
    up: list[NDArray]

    @property
    def meeting(self) -> NDArray:
        """f, shape (n,): how fast the points advance along their normals."""
        return _dot(self.n[0], self.r[1])

    @property
    def meeting_rate(self) -> NDArray:
        """f_phi, shape (n,); nan where f does not change with phi, so that no pose or every one would do."""
        rate, scale = _dot(self.n[1], self.r[1]) + _dot(self.n[0], self.r[2]), np.linalg.norm(self.r[1], axis=1)
        with np.errstate(invalid="ignore"):
            return np.where(np.abs(rate) > PARALLEL * scale, rate, np.nan)


@dataclass(frozen=True)
class RolledSurface:
    """What a profile element leaves under a roll; ``branch`` (+1, -1) is the sign of -f_phi.

    ``frames`` gives the head's frame at cradle angles [rad], ``plain`` the same with the plain roll that leads
    to it (itself, where the roll is plain).
    """

    frames: Frames
    plain: Frames
    element: Meridian
    branch: float
    span: tuple[float, float] = TURNS

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet:
        m = self.element.at(v)
        at = self._settled(u, m)[1]
        nr, r, sharp = m.nr[:, None], m.r[:, None], np.isinf(m.curvature)
        slide = np.where(sharp, 0.0, 1.0)[:, None]
        turn = np.where(sharp, 1.0, m.curvature)[:, None]
        rate = at.meeting_rate
        there = np.isfinite(rate)
        with np.errstate(invalid="ignore", divide="ignore"):
            by_u = -(_dot(nr * at.around[0], at.r[1]) + _dot(at.n[0], r * at.around[1])) / rate
            by_v = -(_dot(turn * at.up[0], at.r[1]) + _dot(at.n[0], slide * at.up[1])) / rate
            along, climb = _dot(at.r[1], at.around[0]) ** 2, _dot(at.r[1], at.up[0]) ** 2
            own = np.where(climb > 0.0, m.curvature * climb, 0.0) + m.nr / m.r * along
        by_u, by_v, only = by_u[:, None], by_v[:, None], np.where(there, 1.0, np.nan)[:, None]
        return GeneratedJet(
            only * at.r[0], r * at.around[0] + by_u * at.r[1], slide * at.up[0] + by_v * at.r[1],
            only * -at.n[0], -(nr * at.around[0] + by_u * at.n[1]), -(turn * at.up[0] + by_v * at.n[1]),
            there, own - _dot(at.n[1], at.r[1]) - rate,
        )  # fmt: skip

    def pose_parameter(self, u: NDArray, v: NDArray) -> NDArray:
        return self._settled(u, self.element.at(v))[0]

    def curve(self, u: Series, v: Series) -> tuple[Series, Series]:
        """The cradle angle becomes a series, too: each step makes one more order of f vanish."""
        r, z, nr, nz = straight(self.element, v)
        start, at = self._settled(u.value, self.element.at(v.value))
        frame = self.frames(start, u.order + 1)
        phi, turn = Series(np.zeros_like(u.c)) + start, series.exp(u * 1j)
        for step in range(u.order + 2):
            ahead = phi - start
            tip, axis, x = (series.compose(s, ahead) for s in frame)
            out = x * turn.real.column + series.cross(axis, x) * turn.imag.column
            point, normal = tip + axis * z.column + out * r.column, out * nr + axis * nz
            if step > u.order:
                break
            tip1, axis1, x1 = (series.compose(s.derivative(), ahead) for s in frame)
            y1 = series.cross(axis1, x) + series.cross(axis, x1)
            speed = tip1 + axis1 * z.column + (x1 * turn.real.column + y1 * turn.imag.column) * r.column
            phi = phi - series.dot(normal, speed) / at.meeting_rate
        return point, -normal

    def _settled(self, u: NDArray, m: MeridianPoints) -> tuple[NDArray, _Carried]:
        """The cradle angles at which points of the head cut, and the points there; nan where they never do."""
        phi = self._plain_roll(u, m)
        for _ in range(_STEPS):
            at = _carried(self.frames(phi, 2), u, m)
            with np.errstate(invalid="ignore", divide="ignore"):
                step = np.clip(-at.meeting / at.meeting_rate, -_LARGEST_STEP, _LARGEST_STEP)
            if not (np.abs(step) > _SETTLED).any():
                return phi, at
            phi = phi + step
        phi = np.where(np.abs(step) <= _SETTLED, phi, np.nan)
        return phi, _carried(self.frames(phi, 2), u, m)

    def _plain_roll(self, u: NDArray, m: MeridianPoints) -> NDArray:
        """Where a + b cos phi + c sin phi = 0 on this branch, within half a turn of 0."""
        travel, turning = self._thirds
        c, s = np.cos(u), np.sin(u)
        n, q = np.stack([m.nr * c, m.nr * s, m.nz], axis=-1), np.stack([m.r * c, m.r * s, m.z], axis=-1)
        still, ahead, back = (n @ t + np.sum((n @ w) * q, axis=1) for t, w in zip(travel, turning, strict=True))
        mean = (still + ahead + back) / 3.0
        cosine, sine = still - mean, (ahead - back) / np.sqrt(3.0)
        swing, speed = np.hypot(cosine, sine), np.linalg.norm(travel[0]) + np.linalg.norm(turning[0] @ q.T, axis=0)
        with np.errstate(invalid="ignore", divide="ignore"):
            reach = np.arccos(np.where(swing > PARALLEL * speed, -mean / swing, np.nan))
        return (np.arctan2(sine, cosine) + self.branch * reach + pi) % (2.0 * pi) - pi

    @cached_property
    def _thirds(self) -> tuple[NDArray, NDArray]:
        """Rates of tip, shape (3, 3), and frame, shape (3, 3, 3), in the frame itself at three poses."""
        tip, axis, x, y = (s.derivatives() for s in _axes(self.plain(_THIRDS, 1)))
        frame, rate = (np.stack([x[k], y[k], axis[k]], axis=-1) for k in range(2))
        return np.einsum("kij,ki->kj", frame, tip[1]), np.einsum("kij,kil->kjl", frame, rate)


def _axes(frame: FrameSeries) -> tuple[Series, Series, Series, Series]:
    """Tip, axis, x and y of a frame."""
    return frame.tip, frame.axis, frame.radial, series.cross(frame.axis, frame.radial)


def _carried(frame: FrameSeries, u: NDArray, m: MeridianPoints) -> _Carried:
    """Points of the head at angles u about its axis under frames, one for each."""
    r, z, nr, nz = (a[:, None] for a in m[:4])
    c, s = np.cos(u)[:, None], np.sin(u)[:, None]
    tip, axis, x, y = (t.derivatives() for t in _axes(frame))
    out = [c * a + s * b for a, b in zip(x, y, strict=True)]
    around = [c * b - s * a for a, b in zip(x, y, strict=True)]
    up = [nr * a - nz * o for a, o in zip(axis, out, strict=True)]
    point = [t + z * a + r * o for t, a, o in zip(tip, axis, out, strict=True)]
    return _Carried(point, [nr * o + nz * a for a, o in zip(axis, out, strict=True)], out, around, up)


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
