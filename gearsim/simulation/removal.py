"""The removal road: cut rays by a compiled motion, on the CPU's cores or a CUDA device."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from time import perf_counter

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError, NumericalError, Status, explain
from gearsim.geometry.rays import RayBundle
from gearsim.kernels import removal as kernels
from gearsim.kernels import ring_removal as ring_kernels
from gearsim.kernels.interval import IntervalLists
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.intervals import IntervalSet, from_lists
from gearsim.simulation.tools import cutter_data, motion_data, ring_data, segment_bounds

TILE_BYTES = 1 << 29
SLOT_BYTES = 24
SLICE_RAYS = 2048


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


def prepare(device: str, ring: bool = False) -> float:
    """Compile and load the kernels for a device ahead of use, those for rings if ``ring``; seconds taken.

    Raises InputError where Warp knows no such device.
    """
    started = perf_counter()
    with nullcontext() if device.startswith("cuda") else _silent_stderr():
        wp.init()
    try:
        wp.get_device(device)
    except Exception as error:
        known = ", ".join(str(d) for d in wp.get_devices())
        raise InputError(f"no device {device!r}; this machine has {known}") from error
    wp.load_module(ring_kernels if ring else kernels, device=device)
    return perf_counter() - started


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
def _memory_errors() -> Iterator[None]:
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


@_memory_errors()
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

    ``tolerance`` [mm] bounds the error of each interval's end along its ray (what escapes it is cut no
    deeper than a tenth of it, see kernels/sweep.py); ``slots`` is the longest interval list of a ray;
    ``threads`` the CPU threads (default: all cores); ``progress`` is told of rays done. Check
    ``Removal.status`` or call ``require_trust``. Raises MemoryError where the device has no room.
    """
    prepare(device, cutter.is_ring)
    job = _Job(table, cutter, device, tolerance, slots)
    parts = []
    step = tile_rays(slots)
    for begin in range(0, max(len(rays), 1), step):
        tile = rays.part(slice(begin, begin + step))
        parts.append(job.run(tile, threads or os.cpu_count() or 1, progress or (lambda n: None)))
    return parts[0] if len(parts) == 1 else _concatenate(parts)


def _concatenate(parts: list[Removal]) -> Removal:
    sets = [p.removed for p in parts]
    offsets = np.cumsum([0] + [len(s.lo) for s in sets[:-1]])
    first = np.concatenate([s.first[:-1] + o for s, o in zip(sets, offsets, strict=True)])
    removed = IntervalSet(
        np.append(first, sum(len(s.lo) for s in sets)),
        *(np.concatenate([getattr(s, k) for s in sets]) for k in ("lo", "hi", "lo_segment", "hi_segment")),
    )
    return Removal(
        removed,
        sum(p.candidates for p in parts),
        sum(p.pairs for p in parts),
        np.concatenate([p.ray_status for p in parts]),
        sum(p.kernel_s for p in parts),
    )


class _Job:
    """Device copies of one cutter and motion, and the launches over tiles of rays."""

    def __init__(self, table: SegmentTable, cutter: Profile, device: str, tolerance: float, slots: int):
        self.device, self.tolerance, self.slots = device, tolerance, slots
        self.motion = motion_data(table, device)
        if cutter.is_ring:
            self.kernel, self.tool = ring_kernels.cut_rays_by_ring, [ring_data(cutter, device)]
        else:
            self.kernel, self.tool = kernels.cut_rays, [cutter_data(cutter, device), 2.0 * cutter.reach]
        lower, upper = segment_bounds(table, cutter)
        self.bvh = wp.Bvh(wp.array(lower, dtype=wp.vec3, device=device), wp.array(upper, dtype=wp.vec3, device=device))

    def run(self, rays: RayBundle, threads: int, progress: Callable[[int], None]) -> Removal:
        n = len(rays)
        inputs = [
            wp.array(rays.origin, dtype=wp.vec3d, device=self.device),
            wp.array(rays.direction, dtype=wp.vec3d, device=self.device),
            wp.array(rays.start, dtype=wp.float64, device=self.device),
            wp.array(rays.end, dtype=wp.float64, device=self.device),
        ]
        lists = self._lists(n)
        counters = [wp.zeros(n, dtype=wp.int32, device=self.device) for _ in range(3)]

        def launch(begin: int, size: int) -> int:
            wp.launch(
                self.kernel,
                dim=size,
                inputs=[*self.tool, self.motion, self.bvh.id, self.tolerance, begin, *inputs],
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
        removed = from_lists(*(a.numpy() for a in columns))
        candidates, pairs, status = (a.numpy() for a in counters)
        total = np.int64
        return Removal(removed, int(candidates.sum(dtype=total)), int(pairs.sum(dtype=total)), status, kernel_s)

    @staticmethod
    def _launch_slices(
        launch: Callable[[int, int], int], n: int, threads: int, progress: Callable[[int], None]
    ) -> None:
        """Warp runs a CPU launch on one thread but releases the interpreter: slices use every core."""
        slices = [(b, min(SLICE_RAYS, n - b)) for b in range(0, n, SLICE_RAYS)]
        with ThreadPoolExecutor(threads) as pool:
            for done in as_completed([pool.submit(launch, *s) for s in slices]):
                progress(done.result())

    def _lists(self, n: int) -> IntervalLists:
        lists = IntervalLists()
        shape = (n, self.slots)
        lists.lo = wp.empty(shape, dtype=wp.float64, device=self.device)
        lists.hi = wp.empty(shape, dtype=wp.float64, device=self.device)
        lists.lo_segment = wp.empty(shape, dtype=wp.int32, device=self.device)
        lists.hi_segment = wp.empty(shape, dtype=wp.int32, device=self.device)
        lists.count = wp.zeros(n, dtype=wp.int32, device=self.device)
        lists.slots = self.slots
        return lists
