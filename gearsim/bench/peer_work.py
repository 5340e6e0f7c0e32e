"""The work that all peers do: a trough cut through a block, its rays, and our own road through it."""

from __future__ import annotations

from math import pi, radians
from statistics import median
from time import process_time
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.end_mills import ball, tapered_ball
from gearsim.cutters.profile import Profile
from gearsim.envelope.surface import BRANCHES, envelope_points
from gearsim.geometry import series
from gearsim.geometry.pose import PoseSeries
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.series import Series
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import CLMotion, CurveMotion, MotionSource
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet
from gearsim.simulation.removal import cut

LOWER, UPPER = np.array([0.0, -10.0, -12.0]), np.array([60.0, 10.0, 0.0])
_REPEATS = 5
_TRUTH = 1e-9
_DEPTH = 1.0  # how far under the surface rays along normals start [mm]
_WINDOW = 2.5
_CLEAR = 0.5  # how far from the block's faces normals are taken [mm]
_JUMP = 1.0  # a surface this much deeper or higher [mm] is another one: the ray was lost or invented


class Work(NamedTuple):
    """Rays through a block, the motion and the tool that cut it."""

    name: str
    rays: RayBundle
    source: MotionSource
    cutter: Profile


class Ours(NamedTuple):
    """Our road: the first surface along each ray [mm], median CPU time [s] and the spread of its repeats."""

    surface: NDArray
    seconds: float
    spread: float


def trough() -> tuple[MotionSource, Profile]:
    """A tapered ball end mill that crosses the block on an arc, leaning 20 degrees over on the way."""

    def curve(values: NDArray, order: int) -> PoseSeries:
        t = Series.variable(values, order)
        turn = series.exp(t * (1j * pi))
        tip = series.stack([t * 84.0 - 12.0, turn.imag * 3.0, turn.real - 8.0])
        tilt, lead = (series.exp(x * 1j) for x in (turn.real * radians(10.0), turn.imag * radians(5.0)))
        return PoseSeries(tip, series.stack([lead.imag, tilt.imag * lead.real, tilt.real * lead.real]))

    return CurveMotion(curve, 0.0, 1.0), tapered_ball(6.0, radians(5.0), 16.0)


def dexel_work(pitch: float) -> Work:
    """The trough in vertical dexels."""
    return Work("5-axis, dexels", dexels(pitch), *trough())


def normal_work(along: int, across: int) -> Work:
    """The trough along the normals of its surface: error along a ray is distance between surfaces."""
    source, cutter = trough()
    point, normal = trough_points(source, cutter, along, across)
    n = len(point)
    rays = RayBundle(point - _DEPTH * normal, normal, np.zeros(n), np.full(n, _WINDOW))
    return Work("5-axis, normals", rays, source, cutter)


def trough_points(source: MotionSource, cutter: Profile, along: int, across: int) -> tuple[NDArray, NDArray]:
    """Points [mm] of the trough and its normals out of the material, in closed form by the envelope road."""
    t, share = np.linspace(0.1, 0.9, along), (np.arange(across) + 0.5) / across
    grid = np.meshgrid(t, share, [0, 1], BRANCHES, indexing="ij")
    t, share, element, branch = (a.ravel() for a in grid)
    element = element.astype(int)
    length = np.array([e.length for e in cutter.elements])[element]
    g = envelope_points(source, cutter, np.zeros(len(t), dtype=int), t, element, share * length, branch)
    inside = g.exists & np.all((g.point > LOWER + _CLEAR) & (g.point < UPPER - _CLEAR), axis=1)
    return g.point[inside], -g.normal[inside]


def raster_work(points: int, pitch: float) -> Work:
    """A wavy surface in vertical dexels, milled by a ball in three axes: straight lines between points."""
    rows = max(2, round((points / 7) ** 0.5))
    row, k = (a.ravel() for a in np.indices((rows, points // rows)))
    along = k / (points // rows - 1)
    x, y = 61.0 * np.where(row % 2 == 1, 1.0 - along, along) - 0.5, -8.53 + 17.14 * row / (rows - 1)
    tips = np.stack([x, y, -4.0 + 1.5 * np.sin(x / 6.0) * np.cos(y / 5.0)], axis=1)
    axes = np.tile([0.0, 0.0, 1.0], (len(tips), 1))
    return Work(f"3-axis, {len(tips) - 1} lines", dexels(pitch), CLMotion(tips, axes), ball(6.0, 20.0))


def dexels(pitch: float) -> RayBundle:
    """The block's rays along z, from its bottom face to its top."""
    return DexelBox(Rigid(np.eye(3), np.zeros(3)), LOWER, UPPER, pitch).rays(2)


def ours(work: Work, tolerance: float = _TRUTH, repeats: int = _REPEATS) -> Ours:
    """Our removal road on one thread, the motion's compilation included."""
    seconds = []
    for _ in range(repeats):
        started = process_time()
        table = compile_motion(work.source, work.cutter.reach, tolerance)
        done = cut(work.rays, table, work.cutter, tolerance=tolerance, threads=1, slots=64).require_trust()
        seconds.append(process_time() - started)
    middle = median(seconds)
    return Ours(first_surface(work.rays, done.removed), middle, (max(seconds) - min(seconds)) / middle)


def first_surface(rays: RayBundle, removed: IntervalSet) -> NDArray:
    """Where material first ends along each ray [mm]: at a cut, or else at the end of its window."""
    surface = rays.end.copy()
    cut_rays = np.flatnonzero(np.diff(removed.first))
    surface[cut_rays] = removed.lo[removed.first[cut_rays]]
    return np.clip(surface, rays.start, rays.end)


def compare(surface: NDArray, truth: NDArray) -> tuple[float, int]:
    """Largest error [mm], and on how many rays another surface was met first: a lost or an invented hit."""
    error = np.abs(surface - truth)
    lost = ~(error < _JUMP)
    return float(error[~lost].max(initial=0.0)), int(np.count_nonzero(lost))
