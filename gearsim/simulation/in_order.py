"""What every row of an operation takes from a stock: cut row after row, in the program's order."""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from queue import SimpleQueue
from typing import Any, NamedTuple

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.errors import InputError, NumericalError, Status, explain
from gearsim.geometry.rays import RayBundle
from gearsim.kernels import in_order as kernels
from gearsim.kernels.in_order import RowTree
from gearsim.kernels.loading import load_kernels
from gearsim.simulation.intervals import IntervalSet, concatenate, from_lists
from gearsim.simulation.operation import Operation
from gearsim.simulation.removal import SLICE_RAYS, open_device, tile_rays
from gearsim.simulation.tools import (
    RowGroups,
    cutter_data,
    group_data,
    interval_lists,
    material_data,
    motion_data,
    row_groups,
)

_MOST_SLOTS = 256


class Taken(NamedTuple):
    """What an operation removes from rays; the length [mm] of material that each row is the first to take, (rows,)."""

    removed: IntervalSet
    length: NDArray[np.floating]


def cut_in_order(
    rays: RayBundle, material: IntervalSet, operation: Operation, *, device: str = "cpu", tolerance: float = 1e-9,
    slots: int = 16,
) -> Taken:  # fmt: skip
    """Cut rays by an operation's rows, first to last; ``material`` is what there is along each of them before.

    Options and accuracy of ends as of ``simulation.removal.cut``; a row's length is the difference of two such. Raises
    InputError for a ring, whose rows are not cut in order, NumericalError where a status forbids trust.
    """
    if operation.cutter.is_ring:
        raise InputError(f"operation {operation.name}: a ring's rows are not cut in order")
    open_device(device)
    load_kernels(kernels, device)
    groups = row_groups(operation.table, operation.cutter)
    tool = [
        cutter_data([operation.cutter], device), motion_data(operation.table, device), group_data([groups], device),
        row_tree(groups, device), tolerance,
    ]  # fmt: skip
    removed, length = [], np.zeros(len(operation))
    step = tile_rays(max(slots, _MOST_SLOTS))
    for begin in range(0, max(len(rays), 1), step):
        own = slice(begin, min(begin + step, len(rays)))
        part = _roomy(rays.part(own), material.part(own.start, own.stop, 0), tool, len(operation), device, slots)
        removed.append(part.removed)
        length += part.length
    return Taken(concatenate(removed), length)


def _roomy(
    rays: RayBundle, material: IntervalSet, tool: list[Any], rows: int, device: str, slots: int
) -> Taken:  # fmt: skip
    """Rays cut with as many slots as their longest list wants. Raises NumericalError where that is beyond measure."""
    while True:
        part, told = _tile(rays, material, tool, rows, device, slots)
        if not told:
            return part
        if told != Status.INTERVALS_OVERFLOW or slots >= _MOST_SLOTS:
            raise NumericalError(f"rows in order: rays cannot be trusted: {'; '.join(explain(told))}")
        slots *= 2


def _tile(
    rays: RayBundle, material: IntervalSet, tool: list[Any], rows: int, device: str, slots: int
) -> tuple[Taken, Status]:  # fmt: skip
    n, workers = len(rays), os.cpu_count() or 1
    along = [wp.array(a, dtype=wp.vec3d, device=device) for a in (rays.origin, rays.direction)]
    along += [wp.array(a, dtype=wp.float64, device=device) for a in (rays.start, rays.end)]
    along += [material_data(material, device)]
    lists, status = interval_lists(n, slots, device), wp.zeros(n, dtype=wp.int32, device=device)
    length = wp.zeros((workers, rows), dtype=wp.float64, device=device)
    free: SimpleQueue[int] = SimpleQueue()  # each thread adds up on its own: a CPU launch has no atomic additions
    for worker in range(workers):
        free.put(worker)

    def launch(begin: int, size: int) -> None:
        worker = free.get()
        inputs = [*tool, begin, worker, *along]
        try:
            wp.launch(kernels.cut_in_order, dim=size, inputs=inputs, outputs=[lists, length, status], device=device)
        finally:
            free.put(worker)

    if wp.get_device(device).is_cpu:
        with ThreadPoolExecutor(workers) as pool:
            list(pool.map(lambda begin: launch(begin, min(SLICE_RAYS, n - begin)), range(0, n, SLICE_RAYS)))
    else:
        launch(0, n)
    told = Status(int(np.bitwise_or.reduce(status.numpy(), initial=0)))
    columns = (lists.count, lists.lo, lists.hi, lists.lo_segment, lists.hi_segment)
    return Taken(from_lists(*(a.numpy() for a in columns)), length.numpy().sum(axis=0)), told


def row_tree(groups: RowGroups, device: str) -> RowTree:
    """A balanced tree over groups of rows, level after level."""
    count = len(groups.spread)
    size = 2 * count - 1
    lower, upper = np.empty((size, 3), np.float32), np.empty((size, 3), np.float32)
    after, group = np.empty(size, np.int32), np.full(size, -1, np.int32)
    node, begin, end = np.array([0]), np.array([0]), np.array([count])
    low, high = (np.concatenate([b, b[-1:]]) for b in (groups.lower, groups.upper))  # reduceat asks for an end
    while len(node):
        ends = np.stack([begin, end], axis=1).ravel()
        lower[node], upper[node] = np.minimum.reduceat(low, ends)[::2], np.maximum.reduceat(high, ends)[::2]
        after[node] = node + 2 * (end - begin) - 1
        leaf = end - begin == 1
        group[node[leaf]] = begin[leaf]
        node, begin, end = node[~leaf], begin[~leaf], end[~leaf]
        middle = (begin + end) // 2
        node = np.stack([node + 1, node + 2 * (middle - begin)], axis=1).ravel()
        begin, end = np.stack([begin, middle], axis=1).ravel(), np.stack([middle, end], axis=1).ravel()
    tree = RowTree()
    tree.lower, tree.upper = (wp.array(b, dtype=wp.vec3, device=device) for b in (lower, upper))
    tree.after, tree.group = (wp.array(b, dtype=wp.int32, device=device) for b in (after, group))
    return tree
