"""Sheets: surfaces that a head leaves, one profile element at a time, and the head's own shape at rest.

A sheet is a parametric surface (u, v) in the head's own coordinates: v is the arc length on the profile
element, u the angle about the head's axis. What a rolling head leaves is in surfaces/rolled.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Element
from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.grazing import MeridianPoints
from gearsim.geometry.jets import Curvature, fundamental_curvature
from gearsim.geometry.pose import FrameSeries
from gearsim.geometry.series import Series

TURNS = (-2.0 * pi, 2.0 * pi)
"""Angles about the axis to look for a tooth in: wherever it lies, one of its images lies whole in two turns."""


class Meridian(Protocol):
    """A smooth piece of a profile over v, `cutters.element.Element` or `cutters.edge.SharpEdge`."""

    @property
    def length(self) -> float: ...

    def at(self, s: NDArray) -> MeridianPoints: ...


@dataclass(frozen=True)
class GeneratedJet:
    """Points with tangents, normals (out of the material) and their rates, each of shape (n, 3).

    ``exists``, shape (n,), is False, and all the rest nan, where this point of the head cuts at no pose.
    ``closing`` [mm] is the second derivative, by the motion's parameter, of the point's distance to the head (inf for
    a head at rest): positive where the point survives all poses nearby.
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
    def element(self) -> Meridian: ...

    @property
    def span(self) -> tuple[float, float]: ...

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet:
        """Points at parameters u, v, shape (n,)."""
        ...

    def curve(self, u: Series, v: Series) -> tuple[Series, Series]:
        """Points and normals out of the material along a curve u(t), v(t) on a straight element's sheet."""
        ...

    def pose_parameter(self, u: NDArray, v: NDArray) -> NDArray:
        """The motion's parameter at which the head cuts the points (u, v), shape (n,); nan where it never does."""
        ...


@dataclass(frozen=True)
class HeadSurface:
    """A profile element of the head at rest at the end of its infeed; u is the angle about the axis.

    u counts from the frame's radial direction, right-handed about the axis; the infeed ends at parameter 0.
    """

    frame: FrameSeries
    element: Element
    span: tuple[float, float] = TURNS

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
        r, z, nr, nz = straight(self.element, v)
        turn = series.exp(u * 1j)
        radial = turn.real.column * x + turn.imag.column * np.cross(axis, x)
        return z.column * axis + tip + radial * r.column, radial * -nr - nz * axis

    def pose_parameter(self, u: NDArray, v: NDArray) -> NDArray:
        return np.zeros(np.shape(u))


def straight(element: Meridian, v: Series) -> tuple[Series, Series, float, float]:
    """(r, z) of a line element as series of the arc length v, and its constant normal (nr, nz)."""
    if not isinstance(element, Element) or element.is_arc:
        raise InputError(
            "series along an arc or edge of the profile are not available: only straight elements lie along rules"
        )
    start = element.at(np.array(0.0))
    nr, nz = float(start.nr), float(start.nz)
    return v * -nz + float(start.r), v * nr + float(start.z), nr, nz


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("ij,ij->i", a, b)
