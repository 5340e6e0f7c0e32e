"""Claims of the removal road, judged by the oracle on the CPU's cores."""

from __future__ import annotations

import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.intervals import IntervalSet
from gearsim.verify.torture.meridian import bodies
from gearsim.verify.torture.oracle import claims as oracle

CLEAR, HIT, UNDECIDED = 0, 1, 2
_SLICE = 512
_QUICK = "-mllvm=-inline-threshold=25"
_EPS = float(np.finfo(float).eps)
_NOISE = 64.0 * _EPS


@dataclass(frozen=True)
class Claim:
    """What somebody says that a motion of a cutter removes from rays."""

    rays: RayBundle
    table: SegmentTable
    cutter: Profile
    removed: IntervalSet


@dataclass(frozen=True)
class Judgement:
    """Per ray: ``lost`` and ``spanned`` are CLEAR, HIT or UNDECIDED; the pieces of the ray [mm], the witness pose.

    ``noise`` [mm] is the depth by which float64 lets surfaces be wrong: a piece counts as lost or spanned only if
    the tool made smaller or larger by it still says so.
    """

    lost: NDArray[np.integer]
    lost_from: NDArray[np.floating]
    lost_to: NDArray[np.floating]
    row: NDArray[np.integer]
    body: NDArray[np.integer]
    x: NDArray[np.floating]
    spanned: NDArray[np.integer]
    spanned_from: NDArray[np.floating]
    spanned_to: NDArray[np.floating]
    cells: NDArray[np.integer]
    noise: NDArray[np.floating]

    def part(self, begin: int, end: int) -> Judgement:
        """Some of the rays."""
        return Judgement(*(getattr(self, name)[begin:end] for name in self.__dataclass_fields__))


def prepare(thorough: bool) -> None:
    """Compile the oracle: in a third of the time, or ``thorough``, a third faster, for many rays."""
    flags = None if thorough else _QUICK
    wp.set_module_options({"enable_backward": False, "cpu_compiler_flags": flags}, oracle)
    wp.load_module(oracle, device="cpu")


def judge(claims: Sequence[Claim], tolerance: float, depth: float = 0.0, noise_factor: float = 1.0) -> list[Judgement]:
    """Judge claims to ``tolerance`` [mm] along the rays.

    Surfaces may be off by ``noise_factor`` times the noise, or by ``depth`` [mm] where that is more.
    """
    rays = join_rays([c.rays for c in claims])
    count = np.array([len(c.rays) for c in claims])
    noise = np.maximum(noise_factor * np.concatenate([noise_of(c) for c in claims]), depth)
    data = _claims(claims, rays, count, noise)
    n, slots = len(rays), max(len(c.table) * len(bodies(c.cutter)) * int(oracle.POSES) for c in claims)
    chords = wp.empty((n, slots), dtype=wp.vec2d, device="cpu")
    found = _findings(n)
    inputs = [_tools(claims), _path(claims), tolerance]

    def launch(begin: int) -> None:
        size = min(_SLICE, n - begin)
        wp.launch(oracle.judge_rays, size, [*inputs, begin, data, chords], [found], device="cpu")

    wp.load_module(oracle, device="cpu")
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        list(pool.map(launch, range(0, n, _SLICE)))
    names = [k for k in Judgement.__dataclass_fields__ if k != "noise"]
    columns = {k: getattr(found, k).numpy() for k in names}
    rows, parts = (
        [0, *np.cumsum(c)[:-1]] for c in ([len(c.table) for c in claims], [len(bodies(c.cutter)) for c in claims])
    )
    columns["row"] = columns["row"] - np.repeat(rows, count)
    columns["body"] = columns["body"] - np.repeat(parts, count)
    whole = Judgement(**columns, noise=noise)
    ends = np.cumsum(count)
    return [whole.part(end - size, end) for end, size in zip(ends, count, strict=True)]


def noise_of(claim: Claim) -> NDArray:
    """Depth [mm] to which float64 coordinates decide about a surface, and the table's axes are unit vectors."""
    table, rays, reach = claim.table, claim.rays, claim.cutter.reach
    place = np.abs(table.tip).sum(axis=1).max() + reach
    far = np.abs(rays.origin).max(axis=1) + np.maximum(np.abs(rays.start), np.abs(rays.end))
    powers = np.vander(np.linspace(-1.0, 1.0, 33), 6, increasing=True)
    long = np.abs(np.linalg.norm(np.einsum("xk,nkc->nxc", powers, table.axis), axis=2) - 1.0).max()
    return _NOISE * (place + far) + 8.0 * reach * long


def _tools(claims: Sequence[Claim]) -> oracle.Tools:
    sections = [bodies(c.cutter) for c in claims]
    flat = [b for s in sections for b in s]
    data = oracle.Tools()
    data.planes = wp.array(np.concatenate([b.planes for b in flat]), dtype=wp.float64, device="cpu")
    data.wedges = wp.array(np.concatenate([b.wedges for b in flat]), dtype=wp.float64, device="cpu")
    data.plane_first = _offsets([len(b.planes) for b in flat])
    data.wedge_first = _offsets([len(b.wedges) for b in flat])
    data.first = _offsets([len(s) for s in sections])
    data.hollow = wp.array([int(c.cutter.is_ring) for c in claims], dtype=wp.int32, device="cpu")
    data.reach = wp.array([c.cutter.reach for c in claims], dtype=wp.float64, device="cpu")
    return data


def _path(claims: Sequence[Claim]) -> oracle.Path:
    tip = np.concatenate([c.table.tip for c in claims])
    axis = np.concatenate([c.table.axis for c in claims])
    k = np.arange(6.0)
    factors = [k, k * (k - 1.0), k * (k - 1.0) * (k - 2.0)]
    lengths = [np.linalg.norm(c, axis=2) for c in (tip, axis)]
    data = oracle.Path()
    data.tip = wp.array(tip, dtype=wp.vec3d, device="cpu")
    data.axis = wp.array(axis, dtype=wp.vec3d, device="cpu")
    bounds = np.stack([length @ f for length in lengths for f in factors], axis=1)
    data.bounds = wp.array(bounds, dtype=wp.float64, device="cpu")
    data.first = _offsets([len(c.table) for c in claims])
    return data


def _claims(claims: Sequence[Claim], rays: RayBundle, count: NDArray, noise: NDArray) -> oracle.Claims:
    data = oracle.Claims()
    for name, kind in (("origin", wp.vec3d), ("direction", wp.vec3d), ("start", wp.float64), ("end", wp.float64)):
        setattr(data, name, wp.array(getattr(rays, name), dtype=kind, device="cpu"))
    data.noise = wp.array(noise, dtype=wp.float64, device="cpu")
    data.job = wp.array(np.repeat(np.arange(len(claims)), count), dtype=wp.int32, device="cpu")
    data.first = _offsets(np.concatenate([np.diff(c.removed.first) for c in claims]))
    data.lo = wp.array(np.concatenate([c.removed.lo for c in claims]), dtype=wp.float64, device="cpu")
    data.hi = wp.array(np.concatenate([c.removed.hi for c in claims]), dtype=wp.float64, device="cpu")
    return data


def _findings(n: int) -> oracle.Findings:
    found = oracle.Findings()
    for name in ("lost", "spanned", "row", "body", "cells"):
        setattr(found, name, wp.zeros(n, dtype=wp.int32, device="cpu"))
    for name in ("lost_from", "lost_to", "x", "spanned_from", "spanned_to"):
        setattr(found, name, wp.zeros(n, dtype=wp.float64, device="cpu"))
    return found


def _offsets(counts: Sequence[int] | NDArray) -> wp.array:
    return wp.array(np.concatenate([[0], np.cumsum(counts)]), dtype=wp.int32, device="cpu")
