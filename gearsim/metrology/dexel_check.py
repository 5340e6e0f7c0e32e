"""The slot's tri-dexel as a third witness: dexel ends against rays along the normals at their feet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rigid import frame
from gearsim.metrology.closest import signed_distance
from gearsim.metrology.machine import MeasuringMachine
from gearsim.metrology.samples import SampleGrid, window_rays
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.dexels import DexelBox, DexelStock, machined_stock
from gearsim.surfaces.ruled_bevel import RuledBevelTooth

_NEAR = 0.05
_MOST = 4000
_MARGIN = 1.5


@dataclass(frozen=True)
class DexelResult:
    """The tri-dexel of the slot: three bundles, and its agreement with rays along the normals.

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


def slot_box(tooth: RuledBevelTooth, pitch: float) -> DexelBox:
    """The box around one slot, in the profile frame of the mean point, with some tooth on every side."""
    spine = tooth.spine(np.zeros(1), 0)
    local = frame(spine.origin.value[0], spine.x.value[0], spine.z.value[0])
    edges = np.linspace(0.0, 1.0, 33)
    corners = [patch.jet(*patch.locate(edges, np.full(33, tip))).r for patch in tooth.patches for tip in (0.0, 1.0)]
    points = local.inverse().point(np.concatenate(corners))
    return DexelBox(local, points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN, pitch)


def measure_dexels(
    machine: MeasuringMachine, tooth: RuledBevelTooth, program: SegmentTable, pitch: float,
    flanks: list[SampleGrid],
) -> DexelResult:  # fmt: skip
    """Cut the slot's three dexel bundles out of the blank and check their ends on the flanks."""
    box = slot_box(tooth, pitch)
    bundles = []
    for axis in range(3):
        removed = machine.removed(box.rays(axis), program)
        bundles.append(machined_stock(box, axis, tooth.blank.stock, removed))
    points = np.concatenate([b.cut_points()[0] for b in bundles])
    checked, worst = 0, 0.0
    for grid in flanks:
        gaps = _foot_gaps(machine, grid, points, program)
        checked += len(gaps)
        worst = max(worst, 1e3 * float(gaps.max(initial=0.0)))
    return DexelResult(box, (bundles[0], bundles[1], bundles[2]), checked, worst)


def _foot_gaps(machine: MeasuringMachine, grid: SampleGrid, points: NDArray, program: SegmentTable) -> NDArray:
    """How far [mm] dexel ends near a flank are from the cuts' ends on the normals at their feet.

    At most a few thousand, evenly picked.
    """
    distance, phi, v = signed_distance(grid, points)
    near = np.flatnonzero(np.abs(distance) < _NEAR)
    near = near[:: max(1, len(near) // _MOST)]
    if not len(near):
        return np.empty(0)
    rays = window_rays(grid.patch, phi[near], v[near], grid.patch.jet(phi[near], v[near]).normal)
    removed = machine.removed(rays, program)
    gaps = np.full(len(near), np.inf)
    for ends in (removed.lo, removed.hi):
        np.minimum.at(gaps, removed.ray, np.abs(ends - distance[near][removed.ray]))
    return gaps
