"""One cutter along one exact motion, as the envelope road's kernels read it."""

from __future__ import annotations

from enum import IntEnum
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.envelope.poses import pose_table
from gearsim.envelope.stretches import stretch_tree
from gearsim.errors import NumericalError
from gearsim.geometry.rays import RayBundle
from gearsim.kernels import approach, charts, crossing, nearby, pursuit
from gearsim.kernels.exact_pose import ExactMotion
from gearsim.kernels.meridian import Meridian
from gearsim.motion.sources import MotionSource

_MOST_LOOKS = 1_000_000
_SLOTS = 4
_LEAST_POSES = 768


class Chart(IntEnum):
    """Charts of the classes: places are arc lengths [mm] on ENVELOPE, angles [rad] on the others."""

    ENVELOPE = int(charts.ENVELOPE)
    CIRCLE = int(charts.CIRCLE)
    ARC = int(charts.ARC)
    DISC = int(charts.DISC)
    LINE = int(charts.LINE)


class Guess(NamedTuple):
    """Starting points of Newton's method, each field of shape (n,): a ray, a pose, a place on the tool.

    ``place`` is the arc length s [mm] on a profile ``element``, or the angle [rad] on the circle that ends it.
    """

    ray: NDArray
    piece: NDArray
    t: NDArray
    element: NDArray
    place: NDArray
    branch: NDArray


class Solved(NamedTuple):
    """Where Newton's method came to: places, arc lengths ``s`` [mm], parameters ``tau`` [mm], and which settled."""

    at: Guess
    s: NDArray
    tau: NDArray
    settled: NDArray


class Standing(NamedTuple):
    """Crossings of rays with the tool at rest, shape (n,): which pair of ray and joint, the parameter ``tau`` [mm], and
    the distance's rate [mm] at the end of the piece before and at the start of the one after."""

    pair: NDArray
    tau: NDArray
    before: NDArray
    after: NDArray


class Swept:
    """A motion and a cutter on a device. Raises NumericalError where the motion is not smooth."""

    def __init__(self, source: MotionSource, cutter: Profile, device: str = "cpu") -> None:
        self.source, self.cutter, self.device = source, cutter, device
        self._motion = _motion_data(source, cutter, device)
        self._meridian = _meridian_data(cutter, device)
        self._parts = [(_meridian_data(p, device), _stretch_data(source, p, device)) for p in cutter.parts]

    def least_distance(self, points: NDArray, floor: float = np.inf, enough: float = -np.inf) -> NDArray:
        """Least signed distance [mm] over the whole motion, shape (n,), of points, shape (n, 3), to 1e-11 mm.

        Above ``floor`` [mm] it is only that, and one below ``enough`` [mm] ends the search.

        Inside a tool with undercuts it is the depth below a part's surface, which can be less than the tool's; beyond
        half the radius of a ring's hole from the ring it is to about 1e-3 mm. Raises NumericalError where the tool
        slides along points, so that it takes too long to tell.
        """
        wanted = approach.Wanted()
        wanted.floor, wanted.enough, wanted.most = min(floor, 1e300), max(enough, -1e300), _MOST_LOOKS
        at = self._array(points, wp.vec3d)
        least = np.full(len(points), np.inf)
        for meridian, stretches in self._parts:
            found, looks = self._empty(len(points), wp.float64), self._empty(len(points), wp.int32)
            self._launch(
                approach.least_distances, len(points), [self._motion, meridian, stretches, at, wanted], [found, looks]
            )
            _refuse_sliding(looks.numpy())
            least = np.minimum(least, found.numpy())
        return least

    def rays(self, rays: RayBundle) -> crossing.Rays:
        """Rays on the device, for ``solve`` and ``standing``."""
        data = crossing.Rays()
        data.origin, data.direction = self._array(rays.origin, wp.vec3d), self._array(rays.direction, wp.vec3d)
        data.start, data.end = self._array(rays.start, wp.float64), self._array(rays.end, wp.float64)
        return data

    def solve(self, rays: crossing.Rays, chart: Chart, guess: Guess, steps: int, walk: bool = False) -> Solved:
        """Newton's method on a chart from each guess; with ``walk`` one that runs off its piece goes on in the next."""
        n = len(guess.ray)
        ray, *places = self._guess(guess)
        s, tau, settled = (self._empty(n, kind) for kind in (wp.float64, wp.float64, wp.int32))
        pieces = self.source.pieces if walk else 0
        self._launch(
            crossing.solve_places, n,
            [self._motion, self._meridian, rays, int(chart), steps, pieces, ray, *places], [s, tau, settled],
        )  # fmt: skip
        at = Guess(guess.ray, *(c.numpy() for c in places))
        return Solved(at, s.numpy(), tau.numpy(), settled.numpy() == 1)

    def points(self, chart: Chart, guess: Guess) -> NDArray:
        """Points of a chart, shape (n, 3), nan where there is none."""
        n = len(guess.ray)
        point = self._empty(n, wp.vec3d)
        places = self._guess(guess)[1:]
        self._launch(crossing.places_at, n, [self._motion, self._meridian, int(chart), *places], [point])
        return point.numpy()

    def pursue(
        self, rays: crossing.Rays, turns: int
    ) -> tuple[tuple[NDArray, NDArray], tuple[NDArray, NDArray], NDArray]:  # fmt: skip
        """Roughly the pose (piece, t) closest to each ray's origin; the one that holds the surface; its tau [mm]."""
        n = rays.start.shape[0]
        out = [self._empty(n, kind) for kind in (wp.int32, wp.float64, wp.int32, wp.float64, wp.float64)]
        self._launch(pursuit.pursue, n, [self._motion, self._meridian, self._close, rays, turns], out)
        first_piece, first_t, piece, t, tau = (c.numpy() for c in out)
        return (first_piece, first_t), (piece, t), tau

    @cached_property
    def _close(self) -> approach.Stretches:
        """Stretches of the whole tool, close enough to follow a contact that races around it."""
        return _stretch_data(self.source, self.cutter, self.device, -(-_LEAST_POSES // self.source.pieces))

    def nearest_circles(
        self, poses: tuple[NDArray, NDArray], circles: NDArray, points: NDArray, reach: NDArray
    ) -> NDArray[np.integer]:
        """For each point and circle (r, z) of the tool the pose that brings it nearest; -1 beyond ``reach`` [mm]."""
        found = wp.empty((len(points), len(circles)), dtype=wp.int32, device=self.device)
        tip, axis, at = (self._array(c, wp.vec3d) for c in (*poses, points))
        r, z, far = (self._array(c, wp.float64) for c in (circles[:, 0], circles[:, 1], reach))
        self._launch(nearby.nearest_circles, found.shape, [tip, axis, r, z, at, far], [found])
        nearest: NDArray[np.integer] = found.numpy()
        return nearest

    def standing(self, rays: crossing.Rays, ray: NDArray, joint: NDArray) -> Standing:
        """Crossings of rays with the tool standing at joints; joint i is where piece i begins."""
        n, slots = len(ray), _SLOTS * len(self.cutter.parts)
        while True:
            count = self._empty(n, wp.int32)
            columns = [wp.empty((n, slots), dtype=wp.float64, device=self.device) for _ in range(3)]
            pairs = [self._array(ray, wp.int32), self._array(joint, wp.int32)]
            self._launch(
                crossing.standing_crossings, n,
                [self._motion, self._meridian, rays, *pairs, self.source.pieces], [count, *columns],
            )  # fmt: skip
            found = count.numpy()
            if found.max(initial=0) <= slots:
                break
            slots = int(found.max())
        there = np.arange(slots) < found[:, None]
        return Standing(np.nonzero(there)[0], *(c.numpy()[there] for c in columns))

    def _guess(self, guess: Guess) -> list[wp.array]:
        kinds = (wp.int32, wp.int32, wp.float64, wp.int32, wp.float64, wp.float64)
        return [self._array(c, kind) for c, kind in zip(guess, kinds, strict=True)]

    def _array(self, values: NDArray, kind: Any) -> wp.array:
        return wp.array(values, dtype=kind, device=self.device)

    def _empty(self, n: int, kind: Any) -> wp.array:
        return wp.empty(n, dtype=kind, device=self.device)

    def _launch(self, kernel: Any, n: int | tuple[int, ...], inputs: list[Any], outputs: list[Any]) -> None:
        if np.prod(n):
            wp.launch(kernel, n, inputs=inputs, outputs=outputs, device=self.device)


def _refuse_sliding(looks: NDArray) -> None:
    """Raise NumericalError where a search did not come to its end."""
    count = int(np.count_nonzero(looks >= _MOST_LOOKS))
    if count:
        raise NumericalError(
            f"the envelope road cannot tell how near {count} points come to the tool: they lie in a surface along "
            "which it slides for a while (the plane of its end?); move the samples a little"
        )


def _motion_data(source: MotionSource, cutter: Profile, device: str) -> ExactMotion:
    table = pose_table(source, cutter.reach)
    data = ExactMotion()
    data.tip, data.axis = (wp.array(c, dtype=wp.vec3d, device=device) for c in (table.tip, table.axis))
    data.terms, data.first = (wp.array(c, dtype=wp.int32, device=device) for c in (table.terms, table.first))
    return data


def _meridian_data(cutter: Profile, device: str) -> Meridian:
    """The rows of kernels/meridian.py."""
    rows = []
    for e in cutter.elements:
        start = e.at(np.array(0.0))
        first, last = e.angles if e.is_arc else (0.0, 0.0)
        middle, half = 0.5 * (first + last), 0.5 * (last - first)
        rows.append([
            *e.start, -float(start.nz), float(start.nr), e.length, *e.centre, e.radius,
            first, np.cos(middle), np.sin(middle), np.cos(half), *e.end,
        ])  # fmt: skip
    data = Meridian()
    data.elements = wp.array(np.array(rows), dtype=wp.float64, device=device)
    return data


def _stretch_data(source: MotionSource, part: Profile, device: str, least: int = 1) -> approach.Stretches:
    tree = stretch_tree(source, part, least=least)
    data = approach.Stretches()
    data.tip, data.axis = (wp.array(c, dtype=wp.vec3d, device=device) for c in (tree.tip, tree.axis))
    data.piece = wp.array(tree.piece, dtype=wp.int32, device=device)
    for name in ("spread", "start", "end", "curvature"):
        setattr(data, name, wp.array(getattr(tree, name), dtype=wp.float64, device=device))
    return data
