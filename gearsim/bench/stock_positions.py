"""How many tool positions a second are cut from a whole block along a tri-dexel, how that grows, and a ray's memory."""

from __future__ import annotations

import os
from math import log
from time import perf_counter, process_time
from typing import Any, NamedTuple

import numpy as np

from gearsim.bench.stock_rows import against, stock_row
from gearsim.bench.workloads import BALL_HEIGHT_MM, BALL_MM, block_path, block_size, compiled
from gearsim.cutters.end_mills import ball
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Block
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import Operation
from gearsim.simulation.stock import Stock, blank_stock, cut_stock
from gearsim.simulation.workshop import Workshop

CASE = "block, 5-axis ramps"
TOLERANCE = 1e-6
PITCH = 0.1
GOAL = 100_000.0
BYTES = 48.0
SHARE = {"small": 0.02, "large": 1.0}
GROWTH_SHARE = 0.02
RAYS_BY = 3.0  # the pitch of fewer rays over that of more
ROWS_BY = 10
RAY_EXPONENT, ROW_EXPONENT = 1.0, 0.45


class Cut(NamedTuple):
    """A block, cut: tool positions, rays, wall and CPU seconds, and the stock that is left."""

    positions: int
    rays: int
    wall_s: float
    cpu_s: float
    stock: Stock


def ramps(share: float) -> Operation:
    """The path of ``bench.workloads.block_path`` over a share of the block, by a 6 mm ball end mill."""
    cutter, path = ball(BALL_MM, BALL_HEIGHT_MM), block_path(share)
    table = compiled(path, cutter)
    none = np.zeros(len(table), dtype=int)
    return Operation("ramps", cutter, (path,), table, none.astype(bool), none, none, none, np.full(len(table), np.nan))


def cut_block(device: str, share: float, pitch: float, operation: Operation) -> Cut:
    """Cut a share of the block; loading the table onto the device counts, compiling it and making the blank do not."""
    size = np.array(block_size(share))
    blank = blank_stock(DexelBox(Rigid(np.eye(3), np.zeros(3)), np.zeros(3), size, pitch), Block(np.zeros(3), size))
    started, used = perf_counter(), process_time()
    left = cut_stock(blank, [operation], Workshop(device, TOLERANCE))
    wall, cpu = perf_counter() - started, process_time() - used
    return Cut(len(operation), sum(len(k.first) - 1 for k in left.left), wall, cpu, left)


def positions(device: str, size: str) -> tuple[list[dict[str, Any]], list[str]]:
    """The block at 0.1 mm: tool positions a second, growth with rays and with rows, bytes a ray at rest."""
    share, part = SHARE[size], ramps(GROWTH_SHARE)
    few = part.part(np.arange(0, len(part), ROWS_BY))
    cut_block(device, GROWTH_SHARE, 10.0 * PITCH, few)  # compiles the kernels
    whole = cut_block(device, share, PITCH, part if share == GROWTH_SHARE else ramps(share))
    fine, coarse = (cut_block(device, GROWTH_SHARE, pitch, part) for pitch in (PITCH, RAYS_BY * PITCH))
    fewer = cut_block(device, GROWTH_SHARE, PITCH, few)
    cores = (os.cpu_count() or 1) if device == "cpu" else 1
    speeds = (whole.positions / whole.wall_s, cores * whole.positions / whole.cpu_s)
    by_rays = log(fine.cpu_s / coarse.cpu_s) / log(fine.rays / coarse.rays)
    by_rows = log(fine.cpu_s / fewer.cpu_s) / log(fine.positions / fewer.positions)
    method = f"tri-dexel, {whole.rays} rays, {whole.positions} positions"
    rows = [
        stock_row(CASE, method, seconds=whole.wall_s, **against(speeds[0], "positions/s", GOAL)),
        stock_row(CASE, method, seconds=whole.cpu_s, **against(speeds[1], f"positions/s by {cores} cores' time", GOAL)),
        stock_row(CASE, "growth with rays", **_at_most(by_rays, "exponent", RAY_EXPONENT)),
        stock_row(CASE, "growth with rows", **_at_most(by_rows, "exponent", ROW_EXPONENT)),
        stock_row(CASE, "blank at rest", **_at_most(_bytes_of_blank(share), "bytes a ray", BYTES)),
    ]
    return rows, [_NOTE]


def _at_most(figure: float, unit: str, goal: float) -> dict[str, Any]:
    return {"figure": figure, "unit": unit, "goal": f"at most {goal:g}", "met": "yes" if figure <= goal else "no"}


def _bytes_of_blank(share: float) -> float:
    """Bytes a ray, each of which has one interval."""
    size = np.array(block_size(share))
    blank = blank_stock(DexelBox(Rigid(np.eye(3), np.zeros(3)), np.zeros(3), size, PITCH), Block(np.zeros(3), size))
    return blank.nbytes / sum(len(k.first) - 1 for k in blank.left)


_NOTE = (
    "block, 5-axis ramps: 100 x 60 x 20 mm or a share of it (small: 2 %), 500,000 positions to the whole, a 6 mm ball "
    "end mill, 0.1 mm, ends to 1e-6 mm, all cores. Seconds count from the segment table to the stock that is left. By "
    "cores' time: what the CPU time of all threads would give were nothing else running. Exponents are those of CPU "
    f"time, with {RAYS_BY**2:g} and {ROWS_BY} times as many rays and rows over 2 % of the block."
)
