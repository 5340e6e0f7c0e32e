"""The volume of a grid of signed distances, with the bounds it is certain to lie between."""

from __future__ import annotations

import os
from typing import NamedTuple

import numpy as np
import warp as wp

from gearsim.kernels import voxel_volume as kernels
from gearsim.kernels.loading import load_kernels
from gearsim.simulation.removal import open_device
from gearsim.simulation.voxel_cut import lattice_data, launch_slices
from gearsim.simulation.voxels import MATERIAL, SIDE, VoxelStock


class VoxelVolume(NamedTuple):
    """The best estimate ``value`` [mm³], of second order in the spacing, and what the volume is certainly between.

    ``least`` and ``most`` are of first order: each about half a spacing, on the whole surface, from the value.
    """

    value: float
    least: float
    most: float

    @property
    def bound(self) -> float:
        """What the value is off by at most [mm³]."""
        return max(self.value - self.least, self.most - self.value)


def voxel_volume(stock: VoxelStock, device: str = "cpu") -> VoxelVolume:
    """How much material there is.

    The surface of each cell is taken as flat in six tetrahedra: exact for planes, and of second order where it bends
    or has an edge. The bounds count what lies in the balls that hold no surface, and what lies in none of air.
    """
    open_device(device)
    load_kernels(kernels, device)
    n = len(stock.brick)
    lattice = lattice_data(stock, device)
    values = wp.array(stock.values, dtype=wp.float32, shape=(n, SIDE**3), device=device)
    brick = wp.array(stock.brick, dtype=wp.vec3i, device=device)
    cells = wp.zeros(n, dtype=wp.vec3d, device=device)
    threads = os.cpu_count() or 1
    launch_slices(kernels.measure_bricks, n, 1, ([lattice, values, brick], []), [cells], device, threads)
    full = SIDE**3 * np.count_nonzero(stock.directory == MATERIAL)
    estimate, least, most = float(np.prod(stock.spacing)) * (full + cells.numpy().sum(axis=0))
    return VoxelVolume(float(np.clip(estimate, least, most)), float(least), float(most))
