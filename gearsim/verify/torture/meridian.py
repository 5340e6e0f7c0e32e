"""A cutter as the half-planes that hold it, written from the profile's definition alone.

A convex section is the intersection of its supporting half-planes n . p <= h(n). Sides and the ends of arcs give
single normals; a corner, or an arc, gives all normals of a wedge, with h = n . centre + radius. A tool whose chain
turns inward somewhere is the union of the bodies between those corners.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile

_TURN = 1e-12
_REENTRANT = 1e-9
_AXIS = 1e-9

Vector = tuple[float, float]


@dataclass(frozen=True)
class Body:
    """One convex section in the (r, z) half plane.

    ``planes`` row: normal (r, z), support h [mm]. ``wedges`` row: centre (r, z), radius [mm], first and last normal
    (r, z), at most 180 deg apart, counterclockwise.
    """

    planes: NDArray[np.floating]
    wedges: NDArray[np.floating]


def bodies(cutter: Profile) -> list[Body]:
    """The convex bodies whose union is the tool; of a ring its section, and the convex body it is cut out of."""
    if cutter.is_ring:
        section = _body(list(cutter.elements), closed=True)
        return [section, _filled(section, [e.box for e in cutter.elements])]
    runs: list[list[Element]] = [[cutter.elements[0]]]
    for before, after in pairwise(cutter.elements):
        if _cross(_normals(before)[1], _normals(after)[0]) < -_REENTRANT:
            runs.append([])
        runs[-1].append(after)
    return [_body(run, closed=False) for run in runs]


def _body(run: list[Element], closed: bool) -> Body:
    planes: list[list[float]] = []
    wedges: list[list[float]] = []
    ends = [(_normals(e), e.start, e.end) for e in run]
    for e, (normals, start, end) in zip(run, ends, strict=True):
        for n in normals if e.is_arc else normals[:1]:
            points = [(e.centre[0] + e.radius * n[0], e.centre[1] + e.radius * n[1])] if e.is_arc else [start, end]
            planes.append([*n, max(n[0] * p[0] + n[1] * p[1] for p in points)])
        if e.is_arc:
            wedges.append([*e.centre, e.radius, *normals[0], *normals[1]])
    joints = [(a[0][1], b[0][0], a[2]) for a, b in pairwise(ends)]
    if closed:
        joints.append((ends[-1][0][1], ends[0][0][0], ends[-1][2]))
    else:
        bottom, top = ends[0][1], ends[-1][2]
        planes += [[0.0, -1.0, -bottom[1]], [0.0, 1.0, top[1]]]
        joints += [((0.0, -1.0), ends[0][0][0], bottom), (ends[-1][0][1], (0.0, 1.0), top)]
    wedges += [[*p, 0.0, *n, *m] for n, m, p in joints if _cross(n, m) > _TURN]
    return Body(np.array(planes), np.array(wedges).reshape(-1, 7))


def _filled(section: Body, boxes: list[tuple[float, float, float, float]]) -> Body:
    """A ring's body with its hole filled: the half-planes whose normals do not point to the axis."""
    ends = [[0.0, -1.0, -min(b[2] for b in boxes)], [0.0, 1.0, max(b[3] for b in boxes)]]
    planes = np.vstack([section.planes[section.planes[:, 0] >= 0.0], ends])
    wedges = section.wedges.copy()
    wedges[wedges[:, 3] < 0.0, 3:5] = [0.0, -1.0]
    wedges[wedges[:, 5] < 0.0, 5:7] = [0.0, 1.0]
    outward = np.maximum(section.wedges[:, 3], section.wedges[:, 5]) > 0.0
    return Body(planes, wedges[outward])


def _normals(e: Element) -> tuple[Vector, Vector]:
    """Outward normals at an element's start and end, from its points."""
    if e.is_arc:
        first, last = ((p[0] - e.centre[0], p[1] - e.centre[1]) for p in (e.start, e.end))
        return _unit(first), _unit(last)
    tangent = _unit((e.end[0] - e.start[0], e.end[1] - e.start[1]))
    normal = (tangent[1], -tangent[0])
    return normal, normal


def _unit(v: Vector) -> Vector:
    length = float(np.hypot(*v))
    return v[0] / length, v[1] / length


def _cross(a: Vector, b: Vector) -> float:
    return a[0] * b[1] - a[1] * b[0]
