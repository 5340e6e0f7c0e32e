"""Operations cut from a grid of signed distances, on the CPU's cores or a CUDA device."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, NumericalError, Status, explain
from gearsim.kernels import voxels as kernels
from gearsim.kernels.loading import load_kernels
from gearsim.kernels.voxels import Lattice
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.operation import Operation
from gearsim.simulation.removal import open_device
from gearsim.simulation.tools import motion_data, section_data, segment_bounds
from gearsim.simulation.voxels import (
    AIR,
    MATERIAL,
    SIDE,
    VoxelStock,
    brick_reach,
    require_bricks,
    rounding,
    settled,
)

_TILE = 1 << 11  # bricks whose rows are listed at a time: in a long program tens of thousands each
_SLICE = 32  # bricks of one launch on the CPU
_LEAST_TOLERANCE = 1e-9


def cut_voxels(
    stock: VoxelStock, operations: Sequence[Operation], *, device: str = "cpu", tolerance: float = 1e-6,
    threads: int | None = None,
) -> VoxelStock:  # fmt: skip
    """What operations leave of a stock, one after the other; all rows cut, rapid ones too.

    ``tolerance`` [mm] is how far the passing tool's distance may be from the least over the compiled motion, and how
    near to the new surface a node counts as on it. Raises InputError where there is no memory for what becomes surface,
    NumericalError where a search is not certain.
    """
    if not tolerance >= _LEAST_TOLERANCE:
        raise InputError(f"voxel tolerance {tolerance:g} mm: expected {_LEAST_TOLERANCE:g} mm or more")
    open_device(device)
    load_kernels(kernels, device)
    for operation in operations:
        table = operation.table.moved(stock.box.frame.inverse())
        for part in operation.cutter.parts:
            stock = _Cut(stock, table, part, device, tolerance, threads or os.cpu_count() or 1).stock()
    return stock


class _Tile(NamedTuple):
    """Bricks, whether each is nothing but air now, and the values of those that are not, with their places."""

    air: NDArray[np.integer]
    brick: NDArray[np.integer]
    values: NDArray[np.floating]


class _Cut:
    """One convex tool or ring, moved along one table through a stock."""

    def __init__(
        self, stock: VoxelStock, table: SegmentTable, part: Profile, device: str, tolerance: float, threads: int
    ):
        self.before, self.device, self.tolerance, self.threads = stock, device, tolerance, threads
        extent = float(np.abs(table.tip).sum(axis=1).max(initial=0.0))
        lower, upper = segment_bounds(table, part)
        self.box = lower.min(axis=0) - stock.band, upper.max(axis=0) + stock.band
        self.bvh = wp.Bvh(*(wp.array(b, dtype=wp.vec3, device=device) for b in (lower, upper)))
        self.tool = [section_data(part, extent, device), int(part.is_ring), motion_data(table, device)]
        self.lattice = lattice_data(stock, device)
        self.reach = brick_reach(stock.box)
        self.coarse = 0.05 * self.reach

    def stock(self) -> VoxelStock:
        """What is left."""
        touched = self._touched()
        tiles = [self._cut(touched[begin : begin + _TILE]) for begin in range(0, len(touched), _TILE)]
        if not tiles:
            return self.before
        air, brick, values = (np.concatenate(column) for column in zip(*tiles, strict=True))
        directory = self.before.directory.copy()
        directory[tuple(air.T)] = AIR
        same = np.ones(len(self.before.brick), dtype=bool)
        for gone in (air, brick):
            place = self.before.directory[tuple(gone.T)]
            same[place[place >= 0]] = False
        error = max(self.before.error, 2.0 * self.tolerance + rounding(self.before.band))
        return settled(replace(
            self.before, error=error, directory=directory,
            brick=np.concatenate([self.before.brick[same], brick]),
            values=np.concatenate([self.before.values[same], values]),
        ))  # fmt: skip

    def _touched(self) -> NDArray:
        """Bricks with material, in the box that the tool sweeps."""
        brick = np.argwhere(self.before.directory != AIR).astype(np.int32)
        low = self.before.origin + SIDE * brick * self.before.spacing
        high = low + (SIDE - 1) * self.before.spacing
        return brick[np.all((high >= self.box[0]) & (low <= self.box[1]), axis=1)]

    def _cut(self, brick: NDArray) -> _Tile:
        air, first, row, least = self._rows(brick)
        cut = np.diff(first) > 0
        values = self._values(brick[cut])
        self._cut_nodes(brick[cut], values, first[np.append(cut, True)], row, least)
        return _Tile(brick[air], brick[cut], values)

    def _rows(self, brick: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Which bricks are nothing but air now; per other brick (CSR) the rows that may lower a distance in it, nearest
        first, and what each is at least from its middle."""
        n, place = len(brick), self._array(brick, wp.vec3i)
        nearest = wp.empty(n, dtype=wp.float64, device=self.device)
        count, status = (wp.zeros(n, dtype=wp.int32, device=self.device) for _ in range(2))
        given = [*self.tool, self.bvh.id, self.lattice, self.reach, self.coarse]
        room = np.zeros(n + 1, dtype=int)
        for fill in (0, 1):
            row = wp.empty(int(room[-1]), dtype=wp.int32, device=self.device)
            least = wp.empty(int(room[-1]), dtype=wp.float64, device=self.device)
            lists, found = [place, self._array(room, wp.int32), fill], [nearest, count, row, least, status]
            self._launch(kernels.find_rows, n, 1, given, lists, found)
            if fill == 0:
                room = np.cumsum([0, *count.numpy()])
        _require_trust(status.numpy())
        owner = np.repeat(np.arange(n), count.numpy())
        first = np.cumsum([0, *count.numpy()])
        filled = room[owner] + np.arange(len(owner)) - first[owner]
        rows, distances = row.numpy()[filled], least.numpy()[filled]
        order = np.lexsort((rows, distances, owner))
        return nearest.numpy() <= -self.before.band - self.reach, first, rows[order], distances[order]

    def _values(self, brick: NDArray) -> NDArray:
        """The bricks' distances before the cut."""
        place = self.before.directory[tuple(brick.T)]
        require_bricks(len(self.before.brick) + int(np.count_nonzero(place == MATERIAL)), self.before.box)
        values = np.full((len(brick), SIDE**3), -self.before.band, dtype=np.float32)
        values[place >= 0] = self.before.values[place[place >= 0]]
        return values

    def _cut_nodes(self, brick: NDArray, values: NDArray, first: NDArray, row: NDArray, least: NDArray) -> None:
        """Cut the values, in place."""
        held = wp.array(values, dtype=wp.float32, device=self.device)
        status = wp.zeros(len(brick), dtype=wp.int32, device=self.device)
        lists = [self._array(brick, wp.vec3i), self._array(first, wp.int32), self._array(row, wp.int32),
                 self._array(least, wp.float64)]  # fmt: skip
        given = [*self.tool, self.lattice, self.tolerance]
        self._launch(kernels.cut_nodes, len(brick), SIDE**3, given, lists, [held, status])
        _require_trust(status.numpy())
        values[:] = held.numpy()

    def _array(self, data: NDArray, kind: type) -> Any:
        return wp.array(data, dtype=kind, device=self.device)

    def _launch(
        self, kernel: Any, bricks: int, size: int, given: list[Any], lists: list[Any], outputs: list[Any]
    ) -> None:
        launch_slices(kernel, bricks, size, (given, lists), outputs, self.device, self.threads)


def launch_slices(
    kernel: Any, bricks: int, size: int, inputs: tuple[list[Any], list[Any]], outputs: list[Any], device: str,
    threads: int,
) -> None:  # fmt: skip
    """Launch a kernel over bricks of ``size`` threads each; its first thread's number stands between the ``inputs``.

    Warp runs a launch on the CPU on one thread, but releases the interpreter: slices use every core.
    """
    on_cpu = wp.get_device(device).is_cpu
    step = _SLICE if on_cpu else max(bricks, 1)

    def launch(begin: int) -> None:
        dim, before, after = size * min(step, bricks - begin), *inputs
        wp.launch(kernel, dim=dim, inputs=[*before, size * begin, *after], outputs=outputs, device=device)

    with ThreadPoolExecutor(threads if on_cpu else 1) as pool:
        list(pool.map(launch, range(0, bricks, step)))
    wp.synchronize_device(device)


def lattice_data(stock: VoxelStock, device: str) -> Lattice:
    """A stock's lattice on a device."""
    data = Lattice()
    data.origin, data.spacing = wp.vec3d(*stock.origin), wp.vec3d(*stock.spacing)
    data.band, data.error = stock.band, stock.error
    data.directory = wp.array(stock.directory, dtype=wp.int32, device=device)
    return data


def _require_trust(status: NDArray[np.integer]) -> None:
    if status.any():
        bad = int(np.count_nonzero(status))
        raise NumericalError(
            f"{bad} of {len(status)} bricks of voxels cannot be trusted: {'; '.join(explain(Status.NOT_CONVERGED))}"
        )
