"""The removal road: cut rays by a compiled motion, on the CPU's cores or a CUDA device."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from time import perf_counter
from types import ModuleType
from typing import NamedTuple

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, NumericalError, Status, explain
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.kernels import removal as kernels
from gearsim.kernels.loading import load_kernels, start_warp
from gearsim.motion.segments import SegmentTable, join
from gearsim.simulation.intervals import IntervalSet, concatenate, from_lists
from gearsim.simulation.tools import (
    GROUP_TRAVEL,
    cutter_data,
    group_data,
    grouped_bvh,
    interval_lists,
    motion_data,
    ring_data,
    row_groups,
    segment_bounds,
)

TILE_BYTES = 1 << 29
SLOT_BYTES = 24
SLICE_RAYS = 2048
_COARSE_STEP = 8
_COARSE_FROM = 4096  # rows; fewer are cut at once faster
_COARSE_TRAVEL = 2.0  # of the tool's radius, over which rows of so many are taken together: most are skipped unseen


@dataclass(frozen=True)
class Removal:
    """What a motion removes from a bundle of rays.

    ``candidates`` counts the ray-segment pairs that the bounding volumes let through, ``pairs`` those
    whose swept interval was computed; ``status`` [Status] is the union over rays, per ray in
    ``ray_status``; ``kernel_s`` the wall time of the launches.
    """

    removed: IntervalSet
    candidates: int
    pairs: int
    ray_status: NDArray[np.integer]
    kernel_s: float

    @property
    def status(self) -> Status:
        return Status(int(np.bitwise_or.reduce(self.ray_status, initial=0)))

    def require_trust(self) -> Removal:
        """Return self, or raise NumericalError with the remedy where a status bit is set."""
        if self.status:
            bad = int(np.count_nonzero(self.ray_status))
            raise NumericalError(
                f"{bad} of {len(self.ray_status)} rays cannot be trusted: " + "; ".join(explain(self.status))
            )
        return self


class Job(NamedTuple):
    """Rays to be cut by one cutter along one motion."""

    rays: RayBundle
    table: SegmentTable
    cutter: Profile


def prepare(device: str, ring: bool = False) -> float:
    """Compile and load the kernels for a device ahead of use, those for rings if ``ring``; seconds taken.

    Raises InputError where Warp knows no such device, or what is compiled cannot be kept.
    """
    started = perf_counter()
    open_device(device)
    load_kernels(_ring_kernels() if ring else kernels, device)
    return perf_counter() - started


def _ring_kernels() -> ModuleType:
    """The kernels for rings, which most jobs have none of."""
    from gearsim.kernels import ring_removal

    return ring_removal


def open_device(device: str) -> None:
    """Start Warp. Raises InputError where it knows no such device or has no place for its kernels."""
    with nullcontext() if device.startswith("cuda") else _silent_stderr():
        start_warp()
    try:
        wp.get_device(device)
    except Exception as error:
        known = ", ".join(str(d) for d in wp.get_devices())
        raise InputError(f"no device {device!r}; this machine has {known}") from error


@contextmanager
def _silent_stderr() -> Iterator[None]:
    """Warp's native part warns of a missing CUDA driver even where nobody asked for one."""
    sys.stderr.flush()
    saved, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)
        os.close(nowhere)


def device_name(device: str) -> str:
    """What Warp calls the device, for reports."""
    prepare(device)
    found = wp.get_device(device)
    return f"{device} ({found.name})"


@contextmanager
def memory_errors() -> Iterator[None]:
    """Warp tells of a full memory by a RuntimeError."""
    try:
        yield
    except RuntimeError as error:
        if "allocate" not in str(error):
            raise
        raise MemoryError(str(error)) from error


def tile_rays(slots: int) -> int:
    """Rays cut at a time, so that their interval lists stay within half a gigabyte."""
    return max(SLICE_RAYS, TILE_BYTES // (SLOT_BYTES * slots))


def cut(
    rays: RayBundle,
    table: SegmentTable,
    cutter: Profile,
    *,
    device: str = "cpu",
    tolerance: float = 1e-9,
    slots: int = 16,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> Removal:
    """Sweep the cutter along the motion through all rays.

    ``tolerance`` [mm] bounds the error of each interval's end in the ray's window (what escapes it is cut
    no deeper than a ten-thousandth of it, see kernels/search.py, or by a ring than coordinates are rounded to); of an
    end beyond the window only that is known.
    ``slots`` is the longest interval list of a ray; ``threads`` the CPU threads (default: all cores);
    ``progress`` is told of rays done. Check ``Removal.status`` or call ``require_trust``. Raises
    MemoryError where the device has no room.
    """
    job = Job(rays, table, cutter)
    return cut_jobs([job], device=device, tolerance=tolerance, slots=slots, threads=threads, progress=progress)[0]


@memory_errors()
def cut_jobs(
    jobs: Sequence[Job],
    *,
    device: str = "cpu",
    tolerance: float = 1e-9,
    slots: int = 16,
    threads: int | None = None,
    progress: Callable[[int], None] | None = None,
) -> list[Removal]:
    """Cut many bundles, each by its own motion and cutter, in joint launches; options as of ``cut``.

    The results are those of one ``cut`` for each, but for ``kernel_s``, which is that of the launches a job
    shared. Jobs with rings are launched one by one.
    """
    convex = [i for i, job in enumerate(jobs) if not job.cutter.is_ring]
    rings = [[i] for i, job in enumerate(jobs) if job.cutter.is_ring]
    done: dict[int, Removal] = {}
    for batch in [convex, *rings] if convex else rings:
        loaded = Loaded([(jobs[i].table, jobs[i].cutter) for i in batch], device, tolerance, slots)
        results = loaded.cut([(jobs[i].rays, k) for k, i in enumerate(batch)], threads, progress)
        done.update(zip(batch, results, strict=True))
    return [done[i] for i in range(len(jobs))]


class _Tile(NamedTuple):
    """What launches over some rays gave: intervals, and per ray the two counts and the status bits."""

    removed: IntervalSet
    candidates: NDArray[np.integer]
    pairs: NDArray[np.integer]
    status: NDArray[np.integer]
    kernel_s: float


def _whole(tiles: list[_Tile]) -> _Tile:
    if len(tiles) == 1:
        return tiles[0]
    return _Tile(
        concatenate([t.removed for t in tiles]),
        np.concatenate([t.candidates for t in tiles]),
        np.concatenate([t.pairs for t in tiles]),
        np.concatenate([t.status for t in tiles]),
        sum(t.kernel_s for t in tiles),
    )


class Loaded:
    """Motions of cutters on a device, each with its own table, to cut rays by as often as wanted.

    All cutters are convex, or there is one, a ring.
    """

    def __init__(self, motions: Sequence[tuple[SegmentTable, Profile]], device: str, tolerance: float, slots: int):
        if slots < 1 or not tolerance > 0.0:
            raise InputError(f"slots and tolerance must be positive, got {slots} and {tolerance:g}")
        tables, cutters = [table for table, _ in motions], [cutter for _, cutter in motions]
        self.device, self.slots, self.ring = device, slots, cutters[0].is_ring
        self.first_row = np.cumsum([0, *map(len, tables)])
        prepare(device, self.ring)
        motion = motion_data(join(tables), device)
        if self.ring:
            bounds = segment_bounds(tables[0], cutters[0])
            self.bvh = wp.Bvh(*(wp.array(b, dtype=wp.vec3, device=device) for b in bounds))
            extent = float(np.abs(tables[0].tip).sum(axis=1).max(initial=0.0))
            self.kernel, tool = _ring_kernels().cut_rays_by_ring, [ring_data(cutters[0], extent, device), motion]
        else:
            coarsely = [len(table) >= _COARSE_FROM for table in tables]
            travels = [_COARSE_TRAVEL if long else GROUP_TRAVEL for long in coarsely]
            groups = [row_groups(*pair, travel) for pair, travel in zip(motions, travels, strict=True)]
            self.bvh = grouped_bvh(groups, device)
            steps = [_COARSE_STEP if long else 1 for long in coarsely]
            coarse = np.stack([self.first_row[:-1], steps], axis=1)
            self.coarse = wp.array(coarse, dtype=wp.vec2i, device=device)
            self.kernel, tool = kernels.cut_rays, [cutter_data(cutters, device), motion, group_data(groups, device)]
        self.inputs = [*tool, self.bvh.id, tolerance]

    @memory_errors()
    def cut(
        self, asked: Sequence[tuple[RayBundle, int]], threads: int | None = None,
        progress: Callable[[int], None] | None = None,
    ) -> list[Removal]:  # fmt: skip
        """What motions, each given by its place in the list, remove from bundles of rays, all in one go."""
        rays = join_rays([bundle for bundle, _ in asked])
        number = np.repeat([motion for _, motion in asked], [len(bundle) for bundle, _ in asked])
        step = tile_rays(self.slots)
        tiles = [slice(begin, begin + step) for begin in range(0, max(len(rays), 1), step)]
        threads, progress = threads or os.cpu_count() or 1, progress or (lambda n: None)
        whole = _whole([self._cut(rays.part(tile), number[tile], threads, progress) for tile in tiles])
        results, ray = [], 0
        for bundle, motion in asked:
            end = ray + len(bundle)
            candidates, pairs = (int(c[ray:end].sum(dtype=np.int64)) for c in (whole.candidates, whole.pairs))
            removed = whole.removed.part(ray, end, int(self.first_row[motion]))
            results.append(Removal(removed, candidates, pairs, whole.status[ray:end], whole.kernel_s))
            ray = end
        return results

    def _cut(self, rays: RayBundle, number: NDArray, threads: int, progress: Callable[[int], None]) -> _Tile:
        n = len(rays)
        inputs = [
            wp.array(rays.origin, dtype=wp.vec3d, device=self.device),
            wp.array(rays.direction, dtype=wp.vec3d, device=self.device),
            wp.array(rays.start, dtype=wp.float64, device=self.device),
            wp.array(rays.end, dtype=wp.float64, device=self.device),
        ]
        if not self.ring:
            inputs += [wp.array(number, dtype=wp.int32, device=self.device), self.coarse]
        lists = interval_lists(n, self.slots, self.device)
        counters = [wp.zeros(n, dtype=wp.int32, device=self.device) for _ in range(3)]

        def launch(begin: int, size: int) -> int:
            wp.launch(
                self.kernel,
                dim=size,
                inputs=[*self.inputs, begin, *inputs],
                outputs=[lists, *counters],
                device=self.device,
            )
            return size

        started = perf_counter()
        if wp.get_device(self.device).is_cpu:
            self._launch_slices(launch, n, threads, progress)
        else:
            launch(0, n)
            wp.synchronize_device(self.device)
            progress(n)
        kernel_s = perf_counter() - started
        columns = (lists.count, lists.lo, lists.hi, lists.lo_segment, lists.hi_segment)
        candidates, pairs, status = (a.numpy() for a in counters)
        return _Tile(from_lists(*(a.numpy() for a in columns)), candidates, pairs, status, kernel_s)

    @staticmethod
    def _launch_slices(
        launch: Callable[[int, int], int], n: int, threads: int, progress: Callable[[int], None]
    ) -> None:
        """Warp runs a CPU launch on one thread but releases the interpreter: slices use every core."""
        slices = [(b, min(SLICE_RAYS, n - b)) for b in range(0, n, SLICE_RAYS)]
        with ThreadPoolExecutor(threads) as pool:
            for done in as_completed([pool.submit(launch, *s) for s in slices]):
                progress(done.result())
