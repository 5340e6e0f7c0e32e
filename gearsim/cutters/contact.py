"""Where a cutter touches a surface: the contact from the normal, the tool's place, and its curvatures there.

``theta`` is the contact's angle on the tool, between the axis and the part's normal n, which points out of the
material and into the tool: 0 at the bottom centre, 90 deg on the shank. The tangent basis at the contact is
``uphill`` = cos(theta) x + sin(theta) a, with the axis a and the direction x across it from the axis to the
contact, and ``n x uphill``; angles count counter-clockwise about n from uphill (Khan 5.1, 6.1).

Curvatures are those of the tool's surface seen along n, positive where the tool curves away from the part (Khan
5.27, 5.28 with their limits; errata: 0/0 for a ball at theta = 0, and not all are positive).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError

ANGLE = 1e-9  # rad: contacts closer to the axis, to the shank or to a cone's angle than this count as there
BEYOND = 1e-6  # rad: walls this much steeper than a flank, by the digits of a file, are touched by it all along
_ON_AXIS = 1e-9  # mm


class Contact(NamedTuple):
    """Contacts on a cutter's meridian, each field of shape (...).

    ``r``, ``z`` [mm] tell the point; ``uphill`` and ``downhill`` [1/mm] the meridian's curvature on the side away
    from the tip and on the tip's, which differ only where two elements meet: inf at a sharp edge, 0 on a flat or
    a line; ``around`` [1/mm] is the normal curvature across the meridian, sin(theta)/r by Meusnier.
    """

    r: NDArray
    z: NDArray
    uphill: NDArray
    downhill: NDArray
    around: NDArray

    @property
    def weaker(self) -> NDArray:
        """The lesser of the meridian's two curvatures [1/mm]: what decides, for f(alpha) has the period pi."""
        return np.minimum(self.uphill, self.downhill)


class Approach(NamedTuple):
    """How axes stand to normals, whatever the cutter: ``theta`` [rad] (...), unit ``out`` and ``uphill`` (..., 3).

    ``out`` points across the axis, from it to the contact.
    """

    theta: NDArray
    out: NDArray
    uphill: NDArray


class Location(NamedTuple):
    """A cutter placed at contact points: its tip (..., 3) [mm], how it stands to the part, and where it touches."""

    tip: NDArray
    approach: Approach
    contact: Contact


def end_mill_contact(shank_radius: ArrayLike, corner_radius: ArrayLike, theta: ArrayLike) -> Contact:
    """Contacts of flat (corner 0), bull-nose and ball (corner = shank radius) end mills [mm], by broadcasting.

    nan where theta is above 90 deg or the corner radius above the shank's: there is no such contact or tool.
    """
    big, small, angle = np.broadcast_arrays(*(np.asarray(x, dtype=float) for x in (shank_radius, corner_radius, theta)))
    sine, cosine = np.sin(angle), np.cos(angle)
    at_bottom, on_shank = angle <= ANGLE, np.abs(angle - 0.5 * np.pi) <= ANGLE
    radius = big - small + small * sine
    is_ball = (small == big) & (big > 0.0)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        corner = 1.0 / small
        around = np.where(is_ball, corner, sine / radius)
    uphill = np.where(on_shank, 0.0, corner)
    downhill = np.where(at_bottom & ~is_ball, 0.0, corner)
    none = (angle > 0.5 * np.pi + ANGLE) | ~(small <= big) | ~(small >= 0.0)
    fields = (radius, small * (1.0 - cosine), uphill, downhill, around)
    return Contact(*(np.where(none, np.nan, x) for x in fields))


def contact_at(cutter: Profile, theta: ArrayLike) -> Contact:
    """Contacts of a convex cutter at angles theta [rad], shape (...); nan where it has none.

    A line is touched all along: the contact is put at its lower end, that of a bottom disc at its rim. Raises
    InputError for a cutter that is not convex.
    """
    if not cutter.is_convex:
        raise InputError(f"cutter {cutter.name!r} is not convex: one direction of the normal may have several contacts")
    shape, angle = np.shape(theta), np.ravel(np.asarray(theta, dtype=float))
    columns = np.full((5, angle.size), np.nan)
    _fill_edges(columns, cutter.elements, angle)
    for i, e in enumerate(cutter.elements):
        if e.is_arc:
            _fill_arc(columns, cutter.elements, i, angle)
    for i, e in enumerate(cutter.elements):
        if not e.is_arc:
            _fill_line(columns, cutter.elements, i, angle)
    return Contact(*columns.reshape(5, *shape))


def cutting_contact(cutter: Profile, theta: ArrayLike) -> Contact:
    """The same for contacts that cut: nan on the rim where the tool is cut off at its top, and beyond it.

    Angles up to `BEYOND` past the flank's own count as the flank's.
    """
    angle, end = np.asarray(theta, dtype=float), end_angle(cutter)
    found = contact_at(cutter, np.where((angle > end) & (angle <= end + BEYOND), end, angle))
    return Contact(*(np.where(angle <= end + BEYOND, x, np.nan) for x in found))


def end_angle(cutter: Profile) -> float:
    """The largest contact angle [rad] below the rim where a convex cutter is cut off at its top."""
    last = cutter.elements[-1]
    return _angles(cutter.elements[-2])[1] if last.is_flat and len(cutter.elements) > 1 else np.pi


def sharp_edges(cutter: Profile) -> list[tuple[float, float, float]]:
    """Sharp edges below the top: first and last contact angle [rad] and radius [mm], 0 at a pointed tip."""
    ends = [(0.0, cutter.elements[0].start[0])] + [(_angles(e)[1], e.end[0]) for e in cutter.elements[:-1]]
    starts, limit = [_angles(e)[0] for e in cutter.elements], end_angle(cutter)
    pairs = ((before, after, r) for (before, r), after in zip(ends, starts, strict=True))
    return [(a, b, r) for a, b, r in pairs if b - a > ANGLE and b <= limit + ANGLE]


def locate(
    cutter: Profile, point: NDArray, normal: NDArray, axis: ArrayLike = (0.0, 0.0, 1.0), toward: ArrayLike | None = None
) -> Location:
    """The cutter's location (CL) at contact points (CC) [mm] with unit normals out of the material, shape (..., 3).

    ``axis``, ``toward``: see `approach`. Raises InputError for a cutter that is not convex.
    """
    seen = approach(normal, axis, toward)
    contact = contact_at(cutter, seen.theta)
    tip = point - contact.r[..., None] * seen.out - contact.z[..., None] * np.asarray(axis, dtype=float)
    return Location(tip, seen, contact)


def approach(normal: NDArray, axis: ArrayLike = (0.0, 0.0, 1.0), toward: ArrayLike | None = None) -> Approach:
    """Contact angles and tangents for unit normals out of the material, shape (..., 3).

    ``axis``: unit axes away from the tip, (3,) or (..., 3). ``toward``: where normal and axis agree, the direction
    from the axis to the contact, (3,) or (..., 3); left out, some direction across the axis.
    """
    n, a = np.broadcast_arrays(np.asarray(normal, dtype=float), np.asarray(axis, dtype=float))
    height = _dot(n, a)[..., None]
    out = height * a - n
    sine = np.linalg.norm(out, axis=-1)
    given = across(a) if toward is None else np.broadcast_to(np.asarray(toward, dtype=float), a.shape)
    given = given - _dot(given, a)[..., None] * a
    out = np.where((sine > ANGLE)[..., None], out, given)
    out = out / np.linalg.norm(out, axis=-1, keepdims=True)
    theta = np.arctan2(sine, height[..., 0])
    return Approach(theta, out, np.cos(theta)[..., None] * out + np.sin(theta)[..., None] * a)


def across(axis: NDArray) -> NDArray:
    """Some unit vectors across unit axes, shape (..., 3): along +x where the axis is +z."""
    helper = np.where((np.abs(axis[..., 0]) < 0.9)[..., None], (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    side = helper - _dot(helper, axis)[..., None] * axis
    return side / np.linalg.norm(side, axis=-1, keepdims=True)


def _angles(e: Element) -> tuple[float, float]:
    """First and last contact angle theta of an element."""
    if e.is_arc:
        return e.angles[0] + 0.5 * np.pi, e.angles[1] + 0.5 * np.pi
    p = e.at(np.array(0.0))
    angle = float(np.arctan2(p.nr, -p.nz))
    return angle, angle


def _curvature(e: Element) -> float:
    return 1.0 / e.radius if e.is_arc else 0.0


def _beside(elements: tuple[Element, ...], i: int, step: int) -> float:
    """The meridian's curvature beyond an end of element i: of a tangent neighbour, else that of an edge, inf.

    A ball's arc goes on beyond the axis.
    """
    k, mine = i + step, _angles(elements[i])[step > 0]
    if not 0 <= k < len(elements):
        return _curvature(elements[i]) if min(abs(mine), abs(mine - np.pi)) <= ANGLE else np.inf
    smooth = abs(_angles(elements[k])[step < 0] - mine) <= ANGLE
    return _curvature(elements[k]) if smooth else np.inf


def _fill_edges(columns: NDArray, elements: tuple[Element, ...], angle: NDArray) -> None:
    """Sharp edges and a pointed tip, where the normal jumps over the angle."""
    ends = [(0.0, *elements[0].start)] + [(_angles(e)[1], *e.end) for e in elements]
    starts = [_angles(e)[0] for e in elements] + [np.pi]
    for (before, r, z), after in zip(ends, starts, strict=True):
        mine = (angle >= before - ANGLE) & (angle <= after + ANGLE) & (after - before > ANGLE)
        around = np.sin(angle[mine]) / r if r > _ON_AXIS else np.inf
        columns[0][mine], columns[1][mine], columns[2:4, mine], columns[4][mine] = r, z, np.inf, around


def _fill_arc(columns: NDArray, elements: tuple[Element, ...], i: int, angle: NDArray) -> None:
    e = elements[i]
    first, last = _angles(e)
    mine = (angle >= first - ANGLE) & (angle <= last + ANGLE)
    at, k = np.clip(angle[mine], first, last), 1.0 / e.radius
    centre = e.centre[0] if abs(e.centre[0]) > _ON_AXIS else 0.0
    r = centre + e.radius * np.sin(at)
    columns[0][mine], columns[1][mine] = r, e.centre[1] - e.radius * np.cos(at)
    columns[2][mine] = np.where(at >= last - ANGLE, _beside(elements, i, 1), k)
    columns[3][mine] = np.where(at <= first + ANGLE, _beside(elements, i, -1), k)
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
        columns[4][mine] = k if centre == 0.0 else np.sin(at) / r


def _fill_line(columns: NDArray, elements: tuple[Element, ...], i: int, angle: NDArray) -> None:
    e = elements[i]
    theta = _angles(e)[0]
    mine = np.abs(angle - theta) <= ANGLE
    is_bottom = e.is_flat and theta < 0.5 * np.pi
    r, z = e.end if is_bottom else e.start
    uphill, downhill = (_beside(elements, i, 1), 0.0) if is_bottom else (0.0, _beside(elements, i, -1))
    around = np.sin(theta) / r if r > _ON_AXIS else np.inf
    for column, value in zip(columns, (r, z, uphill, downhill, around), strict=True):
        column[mine] = value


def _dot(a: NDArray, b: NDArray) -> NDArray:
    return np.einsum("...i,...i->...", a, b)
