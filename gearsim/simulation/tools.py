"""Cutters and motions as the kernels want them, and the boxes that segments sweep."""

from __future__ import annotations

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.checks import CORNER, joints, turn
from gearsim.cutters.profile import Profile
from gearsim.kernels.pose import Motion
from gearsim.kernels.profile import ARC, LINE, Cutter
from gearsim.kernels.ring import Ring
from gearsim.motion.segments import SegmentTable

_SHRINK = 1e-11


def cutter_data(cutter: Profile, device: str) -> Cutter:
    """The convex parts of a cutter that is no ring: the elements of each that rise along the axis, as slabs."""
    rows, kinds, first = [], [], [0]
    for part in cutter.parts:
        for e in part.elements:
            if e.is_flat:
                continue
            (r0, z0), (r1, z1) = e.start, e.end
            kinds.append(int(ARC if e.is_arc else LINE))
            if e.is_arc:
                rows.append([z0, z1, e.centre[0], e.centre[1], e.radius])
            else:
                rows.append([z0, z1, r0, (r1 - r0) / (z1 - z0), 0.0])
        first.append(len(rows))
    data = Cutter()
    data.kind = wp.array(kinds, dtype=wp.int32, device=device)
    data.slabs = wp.array(np.array(rows), dtype=wp.float64, device=device)
    data.part_first = wp.array(first, dtype=wp.int32, device=device)
    data.parts = len(cutter.parts)
    data.first, data.end, data.middle = 0, first[1], 0.5 * (rows[0][0] + rows[first[1] - 1][1])
    return data


def ring_data(cutter: Profile, device: str) -> Ring:
    """A ring's section as supporting lines and arcs, its sharp edges as arcs of no radius.

    It is made smaller by 1e-11 mm, so that a ray that lies in one of its planes misses cleanly.
    """
    lines, arcs = [], []
    for e, after in joints(cutter.elements, ring=True):
        s = np.array([0.0, e.length])
        p, nr, nz = e.at(s), *e.at(s)[2:4]
        if e.is_arc:
            arcs.append([*e.centre, e.radius - _SHRINK, nr[0], nz[0], nr[1], nz[1]])
        else:
            lines.append([nr[0], nz[0], nr[0] * p.r[0] + nz[0] * p.z[0] - _SHRINK])
        if turn(e, after) > CORNER:
            other = after.at(np.array(0.0))
            arcs.append([*after.start, -_SHRINK, nr[1], nz[1], float(other.nr), float(other.nz)])
    data = Ring()
    data.lines = wp.array(np.reshape(lines, (-1, 3)), dtype=wp.float64, device=device)
    data.arcs = wp.array(np.reshape(arcs, (-1, 7)), dtype=wp.float64, device=device)
    _, data.radius, data.bottom, data.top = cutter.box
    data.reach = cutter.reach
    return data


def motion_data(table: SegmentTable, device: str) -> Motion:
    """The segment table on a device."""
    data = Motion()
    data.tip = wp.array(table.tip, dtype=wp.vec3d, device=device)
    data.axis = wp.array(table.axis, dtype=wp.vec3d, device=device)
    for name in ("speed", "acceleration", "spin"):
        setattr(data, name, wp.array(getattr(table, name), dtype=wp.float64, device=device))
    return data


def segment_bounds(table: SegmentTable, cutter: Profile) -> tuple[NDArray, NDArray]:
    """Axis-aligned boxes, float32 rounded outward, of the cutter swept over every row.

    Each box holds the mid-pose tool's bounding cylinders grown by the row's largest displacement.
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
    pad = table.speed[:, None] * (1.0 + 1e-6) + 1e-4
    return (
        np.nextafter((lower - pad).astype(np.float32), -np.float32(np.inf)),
        np.nextafter((upper + pad).astype(np.float32), np.float32(np.inf)),
    )
