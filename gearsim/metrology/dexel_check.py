"""A slot's tri-dexel as a third witness: dexel ends against rays along the normals at their feet."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import frame
from gearsim.geometry.turned import Turned
from gearsim.metrology.closest import signed_distance
from gearsim.metrology.samples import SampleGrid, window_rays
from gearsim.simulation.dexels import DexelBox, DexelStock, machined_stock
from gearsim.simulation.intervals import IntervalSet
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Patch

_NEAR = 0.05
_MOST = 4000
_MARGIN = 1.5


@dataclass(frozen=True)
class DexelResult:
    """The tri-dexel of a slot: three bundles, and its agreement with rays along the normals.

    ``check_um`` is the largest distance, over ``checked`` cut dexel ends near a flank, to the nearest end of
    what the program removes from the ray along the normal at the foot (inf: it removes nothing there).
    """

    box: DexelBox
    bundles: tuple[DexelStock, DexelStock, DexelStock]
    checked: int
    check_um: float

    @property
    def removed_volumes(self) -> list[float]:
        """Removed volume [mm³] by each of the three bundles; their spread is the grid's error."""
        return [b.removed_volume for b in self.bundles]


def slot_box(patches: Sequence[Patch], blank: BevelBlank, pitch: float) -> DexelBox:
    """The box around a slot's patches, along the pitch cone at their middle, with some tooth on every side."""
    middle = patches[len(patches) // 2]
    origin = middle.jet(*middle.locate(np.array([0.5]), np.array([0.5]))).r[0]
    along, normal = blank.cone_directions(origin)
    local = frame(origin, along, normal)
    edges = np.linspace(0.0, 1.0, 33)
    corners = [patch.jet(*patch.locate(edges, np.full(33, tip))).r for patch in patches for tip in (0.0, 1.0)]
    points = local.inverse().point(np.concatenate(corners))
    return DexelBox(local, points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN, pitch)


def measure_dexels(
    cut: Callable[[RayBundle], IntervalSet], box: DexelBox, stock: Turned, grids: list[SampleGrid]
) -> DexelResult:
    """Cut the three dexel bundles of a box out of the stock and check their ends on the surfaces of the grids.

    ``cut`` says what the program removes from rays.
    """
    bundles = []
    for axis in range(3):
        bundles.append(machined_stock(box, axis, stock, cut(box.rays(axis))))
    points = np.concatenate([b.cut_points()[0] for b in bundles])
    checked, worst = 0, 0.0
    for grid in grids:
        gaps = _foot_gaps(cut, grid, points)
        checked += len(gaps)
        worst = max(worst, 1e3 * float(gaps.max(initial=0.0)))
    return DexelResult(box, (bundles[0], bundles[1], bundles[2]), checked, worst)


def _foot_gaps(cut: Callable[[RayBundle], IntervalSet], grid: SampleGrid, points: NDArray) -> NDArray:
    """How far [mm] dexel ends near a flank are from the cuts' ends on the normals at their feet.

    At most a few thousand, evenly picked.
    """
    distance, phi, v = signed_distance(grid, points)
    near = np.flatnonzero(np.abs(distance) < _NEAR)
    near = near[:: max(1, len(near) // _MOST)]
    if not len(near):
        return np.empty(0)
    rays = window_rays(grid.patch, phi[near], v[near], grid.patch.jet(phi[near], v[near]).normal)
    removed = cut(rays)
    gaps = np.full(len(near), np.inf)
    for ends in (removed.lo, removed.hi):
        np.minimum.at(gaps, removed.ray, np.abs(ends - distance[near][removed.ray]))
    return gaps
