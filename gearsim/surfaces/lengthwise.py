"""The lengthwise curve of a generated slot and the profiles along it (Zhou 2015, 3.2.2, 3.3 and 4.4.1).

A generated slot has no curve given in advance: its lengthwise curve is the middle between its walls on the pitch
cone. A profile lies in the plane through one of the curve's points, normal to the pitch cone's generator there, as
the ruled tooth's does; its heights count from the root cone along the pitch cone's normal at that point.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin, tan
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry import series
from gearsim.geometry.series import Series
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.generated import GeneratedJet, Sheet
from gearsim.surfaces.ruled_bevel import Spine

_STEPS = 40
_WALK = 12
_SETTLED = 1e-12
_FOUND = 1e-9

Parameters = tuple[NDArray, NDArray]
Misses = Callable[[Series], tuple[Series, Series]]
Directions = Callable[[NDArray], tuple[NDArray, NDArray]]


class Wall(Protocol):
    """What is asked of a generated flank."""

    @property
    def blank(self) -> BevelBlank: ...

    @property
    def sheet(self) -> Sheet: ...

    def jet(self, u: NDArray, v: NDArray) -> GeneratedJet: ...

    def meet(self, cone: NDArray, above: NDArray) -> Parameters: ...


class ProfilePoints(NamedTuple):
    """A wall's parameters, shape (n,), and series of its points and normals (out of the material) there."""

    u: NDArray
    v: NDArray
    point: Series
    normal: Series


def lengthwise_curve(walls: tuple[Wall, Wall], near: tuple[Parameters, Parameters], cone: NDArray, order: int) -> Spine:
    """Profile frames at cone distances [mm], shape (n,), as series in the cone distance.

    ``near``: parameters of the walls near the pitch cone there (`Wall.meet` at height 0); nan where these lead to none.
    """
    blank, target = walls[0].blank, Series.variable(cone, order)
    a, b = (_around(_on_the_pitch_cone(wall, at, target)) for wall, at in zip(walls, near, strict=True))
    middle = series.unit(a + b)
    pitch, nil = blank.pitch, Series(np.zeros_like(target.c))
    c, s = Series(middle.c[..., 0]), Series(middle.c[..., 1])
    x = series.stack([c * sin(pitch), s * sin(pitch), nil + cos(pitch)])
    z = series.stack([c * cos(pitch), s * cos(pitch), nil - sin(pitch)])
    depth = target * tan(pitch - blank.root_angle) + float(blank.dedendum_at(0.0))
    return Spine(target, x * target.column - z * depth.column, x, series.stack([s, -c, nil]), z)


def profile_points(wall: Wall, spine: Spine, height: Series, near: Parameters) -> ProfilePoints:
    """Where profiles of a wall have given heights [mm] over the root: one on each of the spine's (n,) frames.

    nan where parameters ``near`` them lead to none.
    """

    def misses(point: Series) -> tuple[Series, Series]:
        off = point - spine.origin
        return -series.dot(off, spine.x), height - series.dot(off, spine.z)

    return _followed(wall, near, misses, lambda _: (spine.x.value, spine.z.value), spine.cone.order)


def mean_profile(walls: tuple[Wall, Wall], wall: Wall, heights: NDArray) -> tuple[NDArray, NDArray, NDArray]:
    """u, v of the mean profile's points at heights [mm] over the root, shape (n,), and the plane's normal (3,).

    Led from the pitch cone to the heights in steps. Raises InputError where a wall does not reach its middle.
    """
    blank, cone = wall.blank, np.full(len(heights), wall.blank.mean)
    a, b = (w.meet(cone, np.zeros(len(heights))) for w in walls)
    spine = lengthwise_curve(walls, (a, b), cone, 0)
    at, start = wall.meet(cone, np.zeros(len(heights))), float(blank.dedendum_at(blank.mean))
    for share in np.linspace(0.0, 1.0, _WALK + 1):
        at = profile_points(wall, spine, Series((start + share * (heights - start))[None]), at)[:2]
    return *at, spine.x.value[0]


def _on_the_pitch_cone(wall: Wall, near: Parameters, cone: Series) -> Series:
    """Points of a wall on the pitch cone at cone distances."""
    blank = wall.blank

    def misses(point: Series) -> tuple[Series, Series]:
        radius, z = series.sqrt(_square(point)), Series(point.c[..., 2])
        found, above = (
            radius * sin(blank.pitch) + z * cos(blank.pitch),
            radius * cos(blank.pitch) - z * sin(blank.pitch),
        )
        return cone - found, -above

    return _followed(wall, near, misses, blank.cone_directions, cone.order).point


def _square(point: Series) -> Series:
    x, y = Series(point.c[..., 0]), Series(point.c[..., 1])
    return x * x + y * y


def _around(point: Series) -> Series:
    """Unit vectors in the transverse plane towards points."""
    return series.unit(Series(point.c * np.array([1.0, 1.0, 0.0])))


def _followed(wall: Wall, near: Parameters, misses: Misses, directions: Directions, order: int) -> ProfilePoints:
    """Where a wall's points miss nothing along two directions, as series; nan where it has no such point.

    The point first, by Newton's method; then each step with the first derivatives at the point itself makes one more
    order come right.
    """
    u0, v0 = (np.array(p, dtype=float) for p in near)
    for _ in range(_STEPS):
        jet = wall.jet(u0, v0)
        at_u, at_v = (s.value for s in _step(jet, directions(jet.r), misses(Series(jet.r[None]))))
        u0, v0 = u0 + at_u, v0 + at_v
        moved = np.abs(at_u) * np.linalg.norm(jet.ru, axis=1) + np.abs(at_v)
        if not (moved > _SETTLED * wall.blank.cone_distance).any():
            break
    found = moved < _FOUND
    u0, v0 = np.where(found, u0, np.nan), np.where(found, v0, np.nan)
    jet, nil = wall.jet(u0, v0), Series(np.zeros((order + 1, len(u0))))
    ways, u, v = directions(jet.r), nil + u0, nil + v0
    for _ in range(order):
        du, dv = _step(jet, ways, misses(wall.sheet.curve(u, v)[0]))
        u, v = u + du, v + dv
    return ProfilePoints(u0, v0, *wall.sheet.curve(u, v))


def _step(jet: GeneratedJet, ways: tuple[NDArray, NDArray], missing: tuple[Series, Series]) -> tuple[Series, Series]:
    """Steps of u and v that move points by what is missing along two directions, to first order."""
    a, b, c, d = (np.einsum("ij,ij->i", p, q) for p in ways for q in (jet.ru, jet.rv))
    e, f = missing
    det = a * d - b * c
    return (e * d - f * b) / det, (f * a - e * c) / det
