"""Passes of a ball-ended cutter side by side over a slot's bottom land and fillets, touching them along each pass.

The ball's centre stands its radius off the surface along the normal, so no pass cuts deeper than the surface where
this bends with a larger radius; between two passes a ridge is left, whose height says how far apart they may run.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import ceil

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.motion.sources import CLMotion
from gearsim.surfaces.patch import Tooth, ToothSurface
from gearsim.toolpaths.slot_clearance import SlotClearance

_STATIONS, _ACROSS = 9, 24
_TOUCH = 1e-5  # mm: the ball touches where it cuts, between points of the net
_MOST_PASSES = 1000
_ON_AXIS = 1e-9


@dataclass(frozen=True)
class RootPath:
    """One pass along the root, from ``run`` [mm] before the toe to as far behind the heel, at a place of its width."""

    surface: ToothSurface
    height: float
    ball: float
    run: float

    def poses(self, length: NDArray) -> tuple[NDArray, NDArray]:
        """Tips [mm] and unit axes, shape (n, 3), at shares of the face, 0 the toe and 1 the heel, shape (n,).

        The axis is the pitch cone's normal beside the ball.
        """
        jet = self.surface.jet(*self.surface.locate(length, np.full(len(length), self.height)))
        centre = jet.r + self.ball * jet.normal
        axis = self.surface.blank.cone_directions(centre)[1]
        return centre - self.ball * axis, axis

    def cl_motion(self, points: int) -> CLMotion:
        """The path as CL data with ``points`` points over the face, the run at the same spacing."""
        step = 1.0 / (points - 1)
        more = ceil(self.run / self.surface.blank.face_width / step - 1e-9)
        return CLMotion(*self.poses(step * np.arange(-more, points + more)))


@dataclass(frozen=True)
class RootPlan:
    """The root passes of a slot: ridges of at most ``ridge`` [mm] are left between them."""

    tooth: Tooth
    cutter: Profile
    ridge: float
    run: float

    @cached_property
    def ball(self) -> float:
        """Radius [mm] of the cutter's end. Raises InputError where it is no ball."""
        first = self.cutter.elements[0]
        if not first.is_arc or abs(first.centre[0]) > _ON_AXIS:
            raise InputError(
                f"root passes need a ball-ended cutter, {self.cutter.name!r} has none; choose a ball or a tapered ball"
            )
        return first.radius

    @cached_property
    def paths(self) -> tuple[RootPath, ...]:
        """The passes from the concave fillet's upper edge to the convex one's.

        Raises InputError where the ball does not fit the fillets, the cutter cuts the walls, or there are too many.
        """
        paths = [path for surface in self._surfaces for path in self._side_by_side(*surface)]
        surface, _, last = self._surfaces[-1]
        paths.append(RootPath(surface, last, self.ball, self.run))
        self._check_room(paths)
        return tuple(paths)

    def _side_by_side(self, surface: ToothSurface, first: float, last: float) -> list[RootPath]:
        """The passes over one surface from its first height up to before its last."""
        passes = np.concatenate([[0.0], np.cumsum(self._density(surface, first, last))])
        count = ceil(passes[-1] - 1e-9)
        if count > _MOST_PASSES:
            raise InputError(
                f"ridges of {1e3 * self.ridge:g} um take {count} passes over the {surface.name}; expected "
                f"{_MOST_PASSES} and fewer: allow higher ones, or choose a larger ball"
            )
        height = np.interp(
            np.linspace(0.0, passes[-1], count, endpoint=False), passes, np.linspace(first, last, len(passes))
        )
        return [RootPath(surface, float(h), self.ball, self.run) for h in height]

    @cached_property
    def _surfaces(self) -> tuple[tuple[ToothSurface, float, float], ...]:
        """Fillets and bottom land from the concave wall to the convex one, each with its first and last height."""
        root = [p for p in self.tooth.patches if p.part != "flank"]
        middle = [[_point(p, h) for h in (0.0, 1.0)] for p in root]
        found: list[tuple[ToothSurface, float, float]] = []
        for k, (surface, ends) in enumerate(zip(root, middle, strict=True)):
            beside = middle[k + 1] if k + 1 < len(root) else middle[k - 1]
            near = [min(np.linalg.norm(e - b) for b in beside) for e in ends]
            upward = (near[1] <= near[0]) == (k + 1 < len(root))
            found.append((surface, 0.0, 1.0) if upward else (surface, 1.0, 0.0))
        return tuple(found)

    def _density(self, surface: ToothSurface, first: float, last: float) -> NDArray:
        """How many passes each strip of a surface takes, shape (strips,): the most that any place along the face asks.

        A ball of radius r that touches a surface of curvature k across the pass at distances s leaves ridges of
        s² (1/r - k) / 8.
        """
        length, edges = np.linspace(0.0, 1.0, _STATIONS), np.linspace(first, last, _ACROSS + 1)
        points = np.array([self._along(surface, length, h)[0] for h in edges])
        strips = []
        for (a, b), h in zip(pairwise(points), 0.5 * (edges[1:] + edges[:-1]), strict=True):
            _, way, bend = self._along(surface, length, h)
            across = b - a
            across -= (across * way).sum(axis=1, keepdims=True) * way
            width = np.linalg.norm(across, axis=1)
            strips.append(float((width * np.sqrt(bend / (8.0 * self.ridge))).max()))
        return np.array(strips)

    def _along(self, surface: ToothSurface, length: NDArray, height: float) -> tuple[NDArray, NDArray, NDArray]:
        """Points of a pass, its unit direction there, and by how much the ball bends more [1/mm] than the surface.

        Raises InputError where it bends less in any direction.
        """
        jet = surface.jet(*surface.locate(length, np.full(len(length), height)))
        way = np.gradient(jet.r, length, axis=0)
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        curvature = jet.curvature()
        most = float(curvature.k1.max())
        if not most * self.ball < 1.0:
            raise InputError(
                f"the root cutter's ball of {self.ball:g} mm does not fit the {surface.name}, which bends with a "
                f"radius of {1.0 / most:.4g} mm; choose a smaller one"
            )
        return jet.r, way, 1.0 / self.ball - curvature.normal_curvature(np.cross(jet.normal, way))

    def _check_room(self, paths: Sequence[RootPath]) -> None:
        """Raise InputError where the cutter cuts the slot."""
        length = np.linspace(0.0, 1.0, _STATIONS)
        tips, axes = (np.concatenate(part) for part in zip(*(path.poses(length) for path in paths), strict=True))
        SlotClearance(self.tooth.patches).require_room(
            self.cutter, tips, axes, -_TOUCH, "the root cutter", "choose a smaller taper or ball"
        )


def _point(surface: ToothSurface, height: float) -> NDArray:
    """The surface's point in the middle of the face at a height."""
    return surface.jet(*surface.locate(np.array([0.5]), np.array([height]))).r[0]
