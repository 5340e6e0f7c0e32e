"""Cutters and motions as the kernels want them, and the boxes that segments sweep."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.checks import CORNER, joints, turn
from gearsim.cutters.element import Element
from gearsim.cutters.profile import Profile
from gearsim.kernels.cull import Groups
from gearsim.kernels.interval import IntervalLists
from gearsim.kernels.material import Material
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import ARC, LINE, Cutters
from gearsim.kernels.ring import Ring
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.intervals import IntervalSet

_ROUNDING = 4e-15
GROUP_TRAVEL = 0.6
_WIDER = 1e-9  # normals of an arc beyond its own [rad]: a distance is off by half the square of it


def cutter_data(cutters: Sequence[Profile], device: str) -> Cutters:
    """The convex parts of cutters that are no rings, one cutter a job: the elements that rise, as slabs."""
    rows, first, size, job_first = [], [0], [], [0]
    for cutter in cutters:
        for part in cutter.parts:
            rows += [_slab(e) for e in part.elements if not e.is_flat]
            first.append(len(rows))
            size.append(2.0 * cutter.reach)
        job_first.append(len(size))
    data = Cutters()
    data.slabs = wp.array(np.array(rows), dtype=wp.float64, device=device)
    data.part_first = wp.array(first, dtype=wp.int32, device=device)
    data.part_size = wp.array(size, dtype=wp.float64, device=device)
    data.job_first = wp.array(job_first, dtype=wp.int32, device=device)
    return data


def _slab(e: Element) -> list[float]:
    """A row of Cutters.slabs."""
    (r0, z0), (r1, z1) = e.start, e.end
    if e.is_arc:
        return [z0, z1, e.centre[0], e.centre[1], e.radius, float(ARC)]
    slope = (r1 - r0) / (z1 - z0)
    return [z0, z1, r0, slope, float(np.hypot(1.0, slope)), float(LINE)]


def ring_data(cutter: Profile, extent: float, device: str) -> Ring:
    """A ring's section as supporting lines and arcs, its sharp edges as arcs of no radius.

    It is made smaller by what coordinates up to ``extent`` [mm] are rounded to, so that a ray that lies in one
    of its planes misses cleanly.
    """
    return _section(cutter, *_supports(cutter, _ROUNDING * (extent + cutter.reach)), extent, device)


def section_data(part: Profile, extent: float, device: str) -> Ring:
    """The same of a ring or a convex cutter, for points anywhere: none falls between two normals by rounding.

    A convex cutter's points on the axis are sharp edges of its section, which goes on beyond the axis.
    """
    skin = _ROUNDING * (extent + part.reach)
    lines, arcs = _supports(part, skin)
    first, last = part.elements[0], part.elements[-1]
    if not part.is_ring:
        for end, (_, _, nr, nz, _) in (
            (first.start, first.at(np.array(0.0))),
            (last.end, last.at(np.array(last.length))),
        ):
            if nr > CORNER:
                side = np.sign(nz) * nr
                arcs.append([*end, -skin, float(side), float(nz), float(-side), float(nz)])
    for arc in arcs:
        for k, turned in ((3, -_WIDER), (5, _WIDER)):
            arc[k], arc[k + 1] = arc[k] - turned * arc[k + 1], arc[k + 1] + turned * arc[k]
    return _section(part, lines, arcs, extent, device)


def _supports(cutter: Profile, skin: float) -> tuple[list[list[float]], list[list[float]]]:
    """A section's lines and arcs as ``Ring`` has them, smaller by ``skin`` [mm]."""
    lines, arcs = [], []
    around = joints(cutter.elements, cutter.is_ring)
    for e, after in around if cutter.is_ring else [*around, (cutter.elements[-1], None)]:
        s = np.array([0.0, e.length])
        p, nr, nz = e.at(s), *e.at(s)[2:4]
        if e.is_arc:
            arcs.append([*e.centre, e.radius - skin, nr[0], nz[0], nr[1], nz[1]])
        else:
            lines.append([nr[0], nz[0], nr[0] * p.r[0] + nz[0] * p.z[0] - skin])
        if after and turn(e, after) > CORNER:
            other = after.at(np.array(0.0))
            arcs.append([*after.start, -skin, nr[1], nz[1], float(other.nr), float(other.nz)])
    return lines, arcs


def _section(
    cutter: Profile, lines: list[list[float]], arcs: list[list[float]], extent: float, device: str
) -> Ring:  # fmt: skip
    data = Ring()
    data.lines = wp.array(np.reshape(lines, (-1, 3)), dtype=wp.float64, device=device)
    data.arcs = wp.array(np.reshape(arcs, (-1, 7)), dtype=wp.float64, device=device)
    _, data.radius, data.bottom, data.top = cutter.box  # larger by the skin: windows are sure
    data.reach = cutter.reach
    data.extent = extent + cutter.reach
    return data


def motion_data(table: SegmentTable, device: str) -> Motion:
    """The segment table on a device."""
    data = Motion()
    data.tip = wp.array(table.tip, dtype=wp.vec3d, device=device)
    data.axis = wp.array(table.axis, dtype=wp.vec3d, device=device)
    for name in ("speed", "acceleration", "spin"):
        setattr(data, name, wp.array(getattr(table, name), dtype=wp.float64, device=device))
    return data


@dataclass(frozen=True)
class RowGroups:
    """Consecutive rows of a table that lie close together, for the kernels to turn away as one.

    ``first`` [row] has one more entry than there are groups; within a group no point of the tool is farther
    than ``spread`` [mm] from where it is at the pose (``tip``, ``axis``). ``lower`` and ``upper`` [mm] are
    float32 boxes around all of it.
    """

    first: NDArray[np.integer]
    tip: NDArray[np.floating]
    axis: NDArray[np.floating]
    spread: NDArray[np.floating]
    travel: NDArray[np.floating]
    lower: NDArray[np.floating]
    upper: NDArray[np.floating]


def row_groups(table: SegmentTable, cutter: Profile, travel: float = GROUP_TRAVEL) -> RowGroups:
    """Groups of rows over which the tool travels ``travel`` of its radius or so, or one row where that travels more."""
    tip, axis = table.tip[:, 0], table.axis[:, 0]
    _, radius, bottom, top = cutter.box
    centre, size = tip + 0.5 * (bottom + top) * axis, float(np.hypot(radius, 0.5 * (top - bottom)))

    def apart(i: NDArray, j: NDArray) -> NDArray:
        return np.linalg.norm(centre[i] - centre[j], axis=1) + size * np.linalg.norm(axis[i] - axis[j], axis=1)

    rows = np.arange(len(table))
    step = apart(rows, np.maximum(rows - 1, 0))
    _, first = np.unique(np.floor(np.cumsum(np.maximum(step, table.speed)) / (travel * radius)), return_index=True)
    end = np.append(first[1:], len(table))
    middle = (first + end) // 2
    spread = apart(rows, np.repeat(middle, end - first)) + table.speed
    lower, upper = segment_bounds(table, cutter)
    return RowGroups(
        np.append(first, len(table)), tip[middle], axis[middle], np.maximum.reduceat(spread, first), np.cumsum(step),
        np.minimum.reduceat(lower, first), np.maximum.reduceat(upper, first),
    )  # fmt: skip


def group_data(groups: Sequence[RowGroups], device: str) -> Groups:
    """The groups of all jobs, whose tables are joined, on a device."""
    rows = np.cumsum([0] + [g.first[-1] for g in groups])
    first = [g.first[:-1] + row for g, row in zip(groups, rows, strict=False)]
    data = Groups()
    data.first = wp.array(np.concatenate([*first, rows[-1:]]), dtype=wp.int32, device=device)
    for name, kind in (("tip", wp.vec3d), ("axis", wp.vec3d), ("spread", wp.float64), ("travel", wp.float64)):
        setattr(data, name, wp.array(np.concatenate([getattr(g, name) for g in groups]), dtype=kind, device=device))
    return data


def grouped_bvh(groups: Sequence[RowGroups], device: str) -> wp.Bvh:
    """Boxes of all jobs' groups of rows, each job under a root of its own."""
    bounds = [np.concatenate([getattr(g, name) for g in groups]) for name in ("lower", "upper")]
    job = np.repeat(np.arange(len(groups)), [len(g.spread) for g in groups])
    return wp.Bvh(
        *(wp.array(b, dtype=wp.vec3, device=device) for b in bounds),
        groups=wp.array(job, dtype=wp.int32, device=device),
    )


def interval_lists(rays: int, slots: int, device: str) -> IntervalLists:
    """Empty lists of so many rays, with room for so many intervals each."""
    lists, shape = IntervalLists(), (rays, slots)
    lists.lo, lists.hi = (wp.empty(shape, dtype=wp.float64, device=device) for _ in range(2))
    lists.lo_segment, lists.hi_segment = (wp.empty(shape, dtype=wp.int32, device=device) for _ in range(2))
    lists.count = wp.zeros(rays, dtype=wp.int32, device=device)
    lists.slots = slots
    return lists


def segment_bounds(table: SegmentTable, cutter: Profile) -> tuple[NDArray, NDArray]:
    """Axis-aligned boxes, float32 rounded outward, of the cutter swept over every row.

    Each box holds the cutter's bounding cylinders at the row's middle, grown by as far as any of its points moves.
    """
    tip, axis = table.tip[:, 0], table.axis[:, 0]
    spread = np.sqrt(np.clip(1.0 - axis**2, 0.0, 1.0))
    lower, upper = np.full(tip.shape, np.inf), np.full(tip.shape, -np.inf)
    for e in cutter.elements:
        _, radius, *heights = e.box
        for z in heights:
            centre = tip + z * axis
            lower = np.minimum(lower, centre - radius * spread)
            upper = np.maximum(upper, centre + radius * spread)
    return padded(lower - table.speed[:, None], upper + table.speed[:, None])


def padded(lower: NDArray, upper: NDArray) -> tuple[NDArray, NDArray]:
    """Boxes in float32 that hold those given, with room for rounding."""
    pad = (upper - lower).max(axis=1, keepdims=True) * 1e-6 + 1e-4
    return (
        np.nextafter((lower - pad).astype(np.float32), -np.float32(np.inf)),
        np.nextafter((upper + pad).astype(np.float32), np.float32(np.inf)),
    )


def material_data(left: IntervalSet, device: str) -> Material:
    """What is left along rays, on a device; ends carry tags."""
    data = Material()
    data.first = wp.array(left.first, dtype=wp.int64, device=device)
    data.lo, data.hi = (wp.array(a, dtype=wp.float64, device=device) for a in (left.lo, left.hi))
    data.lo_tag, data.hi_tag = (wp.array(a, dtype=wp.int32, device=device) for a in (left.lo_segment, left.hi_segment))
    return data
