"""Whole bundles of a tri-dexel cut tile by tile: what one operation leaves of the material along their rays."""

from __future__ import annotations

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import NumericalError, Status, explain
from gearsim.kernels import tiles as kernels
from gearsim.kernels.lattice import LISTS, RAYS, SIDE, Lattice
from gearsim.kernels.loading import load_kernels
from gearsim.kernels.material import Material
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.branches import branch_data, halved, roots_of
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.intervals import IntervalSet, concatenate, from_lists
from gearsim.simulation.removal import SLICE_RAYS, memory_errors, open_device, tile_rays
from gearsim.simulation.tools import cutter_data, interval_lists, material_data, motion_data

_MOST_SLOTS = 1024


class TileCutter:
    """A motion of a convex cutter, or one of convex parts, on a device, to cut bundles of a tri-dexel by.

    ``tolerance`` [mm] as of ``simulation.removal.cut``. ``looks`` and ``pairs`` count what was done: branches of the
    motion held against squares of rays, and rows searched along single rays.
    """

    def __init__(self, table: SegmentTable, cutter: Profile, device: str, tolerance: float):
        open_device(device)
        load_kernels(kernels, device)
        levels = halved(table, cutter.reach)
        roots, lower, upper = roots_of(levels, cutter)
        self.device, self.looks, self.pairs = device, 0, 0
        self._bvh = wp.Bvh(*(wp.array(b, dtype=wp.vec3, device=device) for b in (lower, upper)))
        self._inputs = [
            cutter_data([cutter], device), motion_data(table, device), branch_data(levels, roots, device),
            self._bvh.id, tolerance,
        ]  # fmt: skip

    @memory_errors()
    def cut(
        self, box: DexelBox, axis: int, left: IntervalSet, first_tag: int, slots: int = 16,
        threads: int | None = None, progress: Callable[[int], None] | None = None,
    ) -> IntervalSet:  # fmt: skip
        """What the motion leaves of the material ``left`` along a box's bundle; its rows' tags begin at ``first_tag``.

        ``slots`` are the pieces more that a ray may fall into before its slice is cut again with more room. Threads do
        not change the result. Raises NumericalError where a status forbids trust.
        """
        lattice, material = _lattice(box, axis, self.device), material_data(left, self.device)
        slots += int(np.diff(left.first).max(initial=0))

        def work(rows: tuple[int, int]) -> tuple[IntervalSet, NDArray]:
            part, counts = self._slice(lattice, material, rows, first_tag, slots)
            if progress:
                progress(len(part.first) - 1)
            return part, counts

        slices = _slices(len(lattice.first), len(lattice.second), self._slice_rays(slots))
        with ThreadPoolExecutor((threads or os.cpu_count() or 1) if self._on_cpu else 1) as pool:
            parts, counts = zip(*pool.map(work, slices), strict=True)
        looks, pairs = (int(n) for n in np.sum(counts, axis=0))
        self.looks, self.pairs = self.looks + looks, self.pairs + pairs
        return concatenate(parts)

    @property
    def _on_cpu(self) -> bool:
        return wp.get_device(self.device).is_cpu

    def _slice_rays(self, slots: int) -> int:
        return SLICE_RAYS if self._on_cpu else tile_rays(slots)

    def _slice(
        self, lattice: Lattice, material: Material, rows: tuple[int, int], first_tag: int, slots: int
    ) -> tuple[IntervalSet, NDArray]:
        """The rays of some rows of tiles, begin to end, and what was counted."""
        count, columns = len(lattice.second), -(-len(lattice.second) // SIDE)
        tiles = (rows[1] - rows[0]) * columns
        lists = interval_lists(tiles * LISTS, slots, self.device)
        counts = wp.zeros((tiles, 2), dtype=wp.int32, device=self.device)
        status = wp.zeros(tiles, dtype=wp.int32, device=self.device)
        wp.launch(
            kernels.cut_tiles,
            dim=tiles,
            inputs=[*self._inputs, first_tag, lattice, material, rows[0] * columns],
            outputs=[lists, counts, status],
            device=self.device,
        )
        bits = Status(int(np.bitwise_or.reduce(status.numpy())))
        if bits & Status.INTERVALS_OVERFLOW and slots < _MOST_SLOTS:
            return self._slice(lattice, material, rows, first_tag, 2 * slots)
        if bits:
            bad = int(np.count_nonzero(status.numpy()))
            raise NumericalError(f"{bad} of {tiles} tiles of rays cannot be trusted: " + "; ".join(explain(bits)))
        order = _ray_order(rows[1] - rows[0], columns, count)[: (len(lattice.first) - rows[0] * SIDE) * count]
        columns_of = (lists.count, lists.lo, lists.hi, lists.lo_segment, lists.hi_segment)
        return from_lists(*(a.numpy()[order] for a in columns_of)), counts.numpy().sum(axis=0)


def _slices(first: int, second: int, rays: int) -> list[tuple[int, int]]:
    """Rows of tiles, begin to end, that hold about so many rays and no fewer than one row."""
    step, rows = max(1, rays // (SIDE * second)), -(-first // SIDE)
    return [(begin, min(begin + step, rows)) for begin in range(0, rows, step)]


def _ray_order(rows: int, columns: int, count: int) -> NDArray:
    """The list of every ray in some rows of tiles, rays in their own order."""
    lists = np.arange(rows * columns * LISTS).reshape(rows * columns, LISTS)[:, :RAYS]
    by_row = lists.reshape(rows, columns, SIDE, SIDE).transpose(0, 2, 1, 3).reshape(rows * SIDE, columns * SIDE)
    return by_row[:, :count].ravel()


def _lattice(box: DexelBox, axis: int, device: str) -> Lattice:
    """A bundle's rays, as ``DexelBox.rays`` makes and numbers them."""
    first, second = (k for k in range(3) if k != axis)
    turn = box.frame.rotation
    data = Lattice()
    data.origin = wp.vec3d(*(box.frame.translation + box.lower[axis] * turn[:, axis]))
    data.u, data.v, data.direction = (wp.vec3d(*turn[:, k]) for k in (first, second, axis))
    data.first = wp.array(box.centres(first), dtype=wp.float64, device=device)
    data.second = wp.array(box.centres(second), dtype=wp.float64, device=device)
    return data
