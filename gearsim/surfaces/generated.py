"""Surfaces that a head in motion generates, one profile element at a time: envelopes, and the head's own shape.

A sheet is a parametric surface (u, v): v is the arc length on the profile element, u the motion's parameter
on an envelope, the angle about the axis on a head at rest. Its points are candidates: what the slot keeps of
them is what no other pose cuts away. For small motions that is told by the second derivative of the distance
F of a fixed point to the moving head. With n the head's normal, X(s, t) the envelope, F_t = 0 on it, and the
normals of head and envelope common, F's gradient there turns by n_t - H X_t, H the head's shape operator, so

    F_tt = X_t . H X_t - n_t . X_t :

the head's own curvature along X_t less the envelope's. Where it is not positive, poses nearby cut deeper: the
point is undercut. F_tt passes zero at the edge of regression, where the envelope's curvature is infinite.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import pi
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Element
from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.grazing import PoseJet, grazing_points
from gearsim.geometry.jets import Curvature, fundamental_curvature
from gearsim.geometry.pose import FrameSeries, PoseSeries
from gearsim.geometry.series import Series

Poses = Callable[[NDArray, int], PoseSeries]


@dataclass(frozen=True)
class GeneratedJet:
    """Points with tangents, normals (out of the material) and their rates, each of shape (n, 3).

    ``exists``, shape (n,), is False, and all the rest nan, where the head at this pose cuts with no point of
    this profile height. ``closing`` [mm] is the second derivative, by the motion's parameter, of the point's
    distance to the head (inf for a head at rest): positive where the point survives all poses nearby.
    """

    r: NDArray
    ru: NDArray
    rv: NDArray
    normal: NDArray
    normal_u: NDArray
    normal_v: NDArray
    exists: NDArray
    closing: NDArray

    @property
    def undercut(self) -> NDArray:
        """Whether poses nearby cut the point away, shape (n,)."""
        return self.exists & ~(self.closing > 0.0)

    def second_form(self) -> tuple[NDArray, NDArray, NDArray]:
        """L, M, N of the second fundamental form, shape (n,): L = -r_u.n_u and so on (Zhou 2.50)."""
        mixed = _dot(self.ru, self.normal_v) + _dot(self.rv, self.normal_u)
        return -_dot(self.ru, self.normal_u), -0.5 * mixed, -_dot(self.rv, self.normal_v)

    def curvature(self) -> Curvature:
        """Curvatures by the normal's rates (Weingarten); infinite at an edge of regression."""
        return fundamental_curvature(self.ru, self.rv, *self.second_form())


class Sheet(Protocol):
    """A surface that one profile element generates; ``span`` bounds the u worth searching."""

    @property
    def element(self) -> Element: ...

    @property
    def span(self) -> tuple[float, float]: ...

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet:
        """Points at parameters u, v, shape (n,)."""
        ...

    def curve(self, u: Series, v: Series) -> tuple[Series, Series]:
        """Points and normals out of the material along a curve u(t), v(t) on a straight element's sheet."""
        ...

    def pose_parameter(self, u: NDArray) -> NDArray:
        """The motion's parameter at which the head cuts the points of u, shape (n,)."""
        ...


@dataclass(frozen=True)
class Envelope:
    """One branch (+1, -1) of the grazing points of a profile element under a motion; u is its parameter."""

    poses: Poses
    element: Element
    branch: float
    span: tuple[float, float]

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet:
        tip, axis = (s.derivatives() for s in self.poses(u, 2))
        meridian = self.element.at(v)
        g = grazing_points(
            PoseJet(tip[0], axis[0], tip[1], axis[1], tip[2], axis[2]), meridian, np.full(len(u), self.branch)
        )
        around = np.cross(axis[0], g.point - tip[0]) / meridian.r[:, None]
        up = np.cross(around, g.normal)
        own = meridian.curvature * _dot(g.point_t, up) ** 2 + (meridian.nr / meridian.r) * _dot(g.point_t, around) ** 2
        closing = own - _dot(g.normal_t, g.point_t)
        return GeneratedJet(
            g.point, g.point_t, g.point_s, -g.normal, -g.normal_t, -g.normal_s, g.exists, closing
        )  # fmt: skip

    def curve(self, u: Series, v: Series) -> tuple[Series, Series]:
        """As `grazing_points`, in series: the pose's expansion about u(0), and its derivative, composed with u(t)."""
        pose, ahead = self.poses(u.value, u.order + 1), u - u.value
        tip, axis = (series.compose(s, ahead) for s in pose)
        tip_rate, axis_rate = (series.compose(s.derivative(), ahead) for s in pose)
        r, z, nr, nz = _straight(self.element, v)
        g = tip_rate * nr + axis_rate * (z * nr - r * nz).column
        b = series.dot(axis, tip_rate) * nz
        flat = g - axis * series.dot(axis, g).column
        size2 = series.dot(flat, flat)
        root = series.sqrt(size2 - b * b) * self.branch
        radial = (series.cross(axis, flat) * root.column - flat * b.column) / size2.column
        return tip + axis * z.column + radial * r.column, radial * -nr - axis * nz

    def pose_parameter(self, u: NDArray) -> NDArray:
        return u


@dataclass(frozen=True)
class HeadSurface:
    """A profile element of the head at rest at the end of its infeed; u is the angle about the axis.

    u counts from the frame's radial direction, right-handed about the axis; the infeed ends at parameter 0.
    """

    frame: FrameSeries
    element: Element
    span: tuple[float, float] = (-pi, pi)

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet:
        tip, axis, x = (s.value[0] for s in self.frame)
        y = np.cross(axis, x)
        r, z, nr, nz, bend = (a[:, None] for a in self.element.at(v))
        c, s = np.cos(u)[:, None], np.sin(u)[:, None]
        radial, around = c * x + s * y, c * y - s * x
        up = nr * axis - nz * radial
        return GeneratedJet(
            tip + z * axis + r * radial, r * around, up, -nr * radial - nz * axis, -nr * around, -bend * up,
            np.ones(len(u), dtype=bool), np.full(len(u), np.inf),
        )  # fmt: skip

    def curve(self, u: Series, v: Series) -> tuple[Series, Series]:
        tip, axis, x = (s.value[0] for s in self.frame)
        r, z, nr, nz = _straight(self.element, v)
        turn = series.exp(u * 1j)
        radial = turn.real.column * x + turn.imag.column * np.cross(axis, x)
        return z.column * axis + tip + radial * r.column, radial * -nr - nz * axis

    def pose_parameter(self, u: NDArray) -> NDArray:
        return np.zeros(np.shape(u))


def _straight(element: Element, v: Series) -> tuple[Series, Series, float, float]:
    """(r, z) of a line element as series of the arc length v, and its constant normal (nr, nz)."""
    if element.is_arc:
        raise InputError("series along an arc of the profile are not available: only straight elements lie along rules")
    start = element.at(np.array(0.0))
    nr, nz = float(start.nr), float(start.nz)
    return v * -nz + float(start.r), v * nr + float(start.z), nr, nz


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
