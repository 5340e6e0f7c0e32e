"""One part at one error bound: seconds and memory as a tri-dexel, as voxels, and as a mesh by booleans.

Each representation runs at several resolutions. Its error is the largest distance between its surface and the true one,
at points of the true one: of the tri-dexel linear between rays, of the voxels linear between nodes, of the mesh along
normals. Laws through error, time and memory say what an error not run would take.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from statistics import median
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.bench.peer_hulls import cast, hull_sweep
from gearsim.bench.peer_law import Level, fit_law, fit_laws
from gearsim.bench.peer_work import LOWER, UPPER, Work, compare, normal_work, ours
from gearsim.bench.peers import package
from gearsim.bench.stock_rows import against, stock_row
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import Operation, operation
from gearsim.simulation.stock import Stock, blank_stock, cut_stock
from gearsim.simulation.voxel_cut import cut_voxels
from gearsim.simulation.voxels import VoxelStock, blank_voxels
from gearsim.simulation.workshop import Workshop

TARGET = 1e-3
GOAL = 1000.0
CASE = "5-axis trough"
_TOLERANCE = 1e-2 * TARGET
_TWIST = 5  # facets² by steps of the hulls: both errors are then of one size
BLOCK = Block(LOWER, UPPER)


class Size(NamedTuple):
    """The grid of points, and the resolutions: cells a mm of rays and voxels, facets of the mesh's tool."""

    points: tuple[int, int]
    dexels: tuple[float, ...]
    voxels: tuple[float, ...]
    facets: tuple[int, ...]


SIZES = {
    "small": Size((120, 30), (2.5, 5.0, 9.5), (1.5, 3.0, 6.5), (20, 29, 41)),
    "large": Size((240, 60), (2.5, 5.0, 10.0), (1.5, 3.0, 7.0), (24, 34, 48, 68)),
}


class Method(NamedTuple):
    """A representation to measure: ``make`` at a resolution is timed; ``error`` [mm] and ``bytes`` of what it made."""

    name: str
    resolutions: Sequence[float]
    make: Callable[[Any], Any]
    error: Callable[[Any], float]
    bytes: Callable[[Any], int]
    repeats: int = 3


def same_part(device: str, size: str) -> tuple[list[dict[str, Any]], list[str]]:
    """Rows and notes of the section."""
    s = SIZES[size]
    work = normal_work(*s.points)
    truth = ours(work, repeats=1).surface
    surface = work.rays.origin + truth[:, None] * work.rays.direction
    dexels = Method("tri-dexel", s.dexels, lambda n: _dexels(work, n, device),
                    lambda made: dexel_error(made, surface, work.rays.direction), lambda made: made.nbytes)  # fmt: skip
    voxels = Method("voxels", s.voxels, lambda n: _voxels(work, n, device),
                    lambda made: float(np.abs(made.distance(surface)).max()), lambda made: made.nbytes)  # fmt: skip
    manifold3d = package("manifold3d")
    mesh = Method("manifold3d hulls", s.facets, lambda n: hull_sweep(manifold3d, work, n, max(1, n * n // _TWIST)),
                  lambda made: compare(cast(made, work), truth)[0], mesh_bytes, 1)  # fmt: skip
    for method in (dexels, voxels):
        method.make(1.0)  # loads the kernels
    clock = process_time if device == "cpu" else perf_counter
    rows = [at_target(method, clock) for method in (dexels, voxels, *([mesh] if manifold3d else []))]
    rows = [_beside(row, rows[0]["seconds"]) for row in rows]
    if not manifold3d:
        rows.append(stock_row(CASE, mesh.name, **{"from": "not installed: pip install manifold3d"}))
    return rows, _notes()


def at_target(method: Method, clock: Callable[[], float]) -> dict[str, Any]:
    """A method's row: what laws through its runs say of the error TARGET."""
    levels, sizes = [], []
    for n in method.resolutions:
        seconds = []
        for _ in range(method.repeats):
            started = clock()
            made = method.make(n)
            seconds.append(clock() - started)
        levels.append(Level(n, median(seconds), method.error(made), 0))
        sizes.append(method.bytes(made))
    laws, memory = fit_laws(levels), fit_law(method.resolutions, sizes)
    resolution = laws.error.inverse(TARGET)
    figures = {
        "seconds": laws.seconds_at(TARGET), "MB": 1e-6 * memory.at(resolution), "error mm": TARGET,
        "from": f"{laws.origin(TARGET)}: error ~ n^{laws.error.order:.2g}, time ~ n^{laws.time.order:.2g}",
    }  # fmt: skip
    runs = [{**level._asdict(), "MB": 1e-6 * size} for level, size in zip(levels, sizes, strict=True)]
    return stock_row(CASE, method.name, **figures, resolution=resolution, levels=runs)


def _beside(row: dict[str, Any], seconds: float) -> dict[str, Any]:
    ratio, unit = row["seconds"] / seconds, "times the tri-dexel's seconds"
    if row["method"].startswith("manifold3d"):
        return {**row, **against(ratio, unit, GOAL)}
    return {**row, "figure": ratio, "unit": unit}


def _box(n: float) -> DexelBox:
    return DexelBox(Rigid(np.eye(3), np.zeros(3)), LOWER, UPPER, 1.0 / n)


def _operation(work: Work) -> Operation:
    return operation(work.name, work.cutter, [work.source], _TOLERANCE)


def _dexels(work: Work, n: float, device: str) -> Stock:
    return cut_stock(blank_stock(_box(n), BLOCK), [_operation(work)], Workshop(device, _TOLERANCE))


def _voxels(work: Work, n: float, device: str) -> VoxelStock:
    return cut_voxels(blank_voxels(_box(n), BLOCK), [_operation(work)], device=device, tolerance=_TOLERANCE)


def mesh_bytes(machined: Any) -> int:
    """A mesh at rest [bytes]: its vertices and triangles."""
    mesh = machined.to_mesh()
    return int(mesh.vert_properties.nbytes + mesh.tri_verts.nbytes)


def dexel_error(stock: Stock, points: NDArray, normals: NDArray) -> float:
    """Largest distance [mm] along normals of points of the true surface from a tri-dexel's, linear between its rays.

    Each point is looked at in the bundle most nearly along its normal, between the four rays around it.
    """
    along = np.abs(normals).argmax(axis=1)
    worst = 0.0
    for axis in range(3):
        mine = along == axis
        if mine.any():
            off = np.abs(_between_rays(stock, axis, points[mine]) - points[mine, axis])
            worst = max(worst, float((off * np.abs(normals[mine, axis])).max()))
    return worst


def _between_rays(stock: Stock, axis: int, points: NDArray) -> NDArray:
    """Where the surface nearest to each point is along one axis [mm]: bilinear between the ends on four rays."""
    others = [k for k in range(3) if k != axis]
    counts, step = stock.box.counts[others], ((stock.box.upper - stock.box.lower) / stock.box.counts)[others]
    at = (points[:, others] - stock.box.lower[others]) / step - 0.5
    low = np.clip(np.floor(at).astype(int), 0, counts - 2)
    share, total = at - low, np.zeros(len(points))
    for corner in ((0, 0), (0, 1), (1, 0), (1, 1)):
        i, j = (low + corner).T
        weight = np.where(np.array(corner) == 1, share, 1.0 - share).prod(axis=1)
        total += weight * _nearest_end(stock, axis, i * counts[1] + j, points[:, axis] - stock.box.lower[axis])
    return stock.box.lower[axis] + total


def _nearest_end(stock: Stock, axis: int, ray: NDArray, at: NDArray) -> NDArray:
    """The end of material on each ray that is nearest to a place along it."""
    left = stock.left[axis]
    count = np.diff(left.first)[ray]
    best = np.full(len(ray), np.inf)
    for k in range(int(count.max(initial=0))):
        row = np.minimum(left.first[ray] + k, len(left.lo) - 1)
        for end in (left.lo[row], left.hi[row]):
            nearer = (k < count) & (np.abs(end - at) < np.abs(best - at))
            best = np.where(nearer, end, best)
    return best


def _notes() -> list[str]:
    return [
        "Same part: a block of 60 x 20 x 12 mm with a trough by a tapered ball end mill in five axes. CPU seconds of "
        "all threads (on CUDA wall seconds), motion's compilation, blank and cut included; MB at rest; both by laws "
        "through several resolutions n (cells a mm; facets around the tool) of the largest distance between the two "
        "surfaces. The hulls' error is that of facets and of steps, whose number goes with the square of n.",
    ]
