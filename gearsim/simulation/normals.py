"""Normals of machined surfaces at the ends of material along rays."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import warp as wp
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import NumericalError
from gearsim.geometry.solid import Solid
from gearsim.kernels import end_normal as kernels
from gearsim.kernels.loading import load_kernels
from gearsim.motion.segments import join
from gearsim.simulation.operation import Operation
from gearsim.simulation.tools import motion_data

_SLICE = 1 << 14
_NEAR = 1e-6


class EndNormals:
    """Outward normals of the material where a blank ends, cut by operations or turned to solids, one after the other.

    Called with points [mm], shape (n, 3), in the part's frame, and the tags of what made the surface there, shape (n,):
    rows of the operations, numbered through all of them (a solid has one), or -1 for the blank. A normal is off by the
    point's distance from the true surface over that one's radius of curvature: 1e-8 rad where rays were cut to 1e-9 mm,
    but for rays that graze the surface. On an edge between two surfaces it is that of the one that the tag names.
    Raises NumericalError where a point does not lie on the tool that is said to have made it, by more than a nanometre
    and four times the ``tolerance`` [mm] that rays were cut to.
    """

    def __init__(self, blank: Solid, makers: Sequence[Operation | Solid], device: str, tolerance: float = 0.0):
        load_kernels(kernels, device)
        self._device, self._near = device, _NEAR + 4.0 * tolerance
        self._solids = [blank, *(maker for maker in makers if not isinstance(maker, Operation))]
        operations = [maker for maker in makers if isinstance(maker, Operation)]
        rows = [len(maker) if isinstance(maker, Operation) else 1 for maker in makers]
        turned = np.array([not isinstance(maker, Operation) for maker in makers], dtype=bool)
        solid, row = np.repeat(turned, rows), np.repeat(~turned, rows)
        self._solid = np.where(solid, np.cumsum(solid), -1)  # by tag; tag -1, the last, is the blank's
        self._solid = np.append(self._solid, 0)
        self._row = np.cumsum(row) - 1
        if operations:
            counts = [len(o.cutter.parts) for o in operations]
            last = np.cumsum(counts)
            self._parts = np.repeat(np.column_stack([last - counts, last]), [len(o) for o in operations], axis=0)
            self._inputs = [face_data([o.cutter for o in operations], device)]
            self._inputs.append(motion_data(join([o.table for o in operations]), device))

    def __call__(self, points: NDArray, tags: NDArray) -> NDArray:
        if tags.max(initial=-1) >= len(self._row):
            raise NumericalError(f"tag {tags.max()} is of no row of these operations: the stock is not of them")
        normals, of = np.empty(points.shape), self._solid[tags]
        for number, solid in enumerate(self._solids):
            normals[of == number] = solid.normals(points[of == number])
        cut = of < 0
        if cut.any():
            normals[cut], gap = self._machined(points[cut], self._row[tags[cut]])
            far = np.abs(gap) > self._near
            if far.any():
                raise NumericalError(
                    f"{np.count_nonzero(far)} of {len(gap)} points of the machined surface do not lie on the tool that "
                    f"made them, by up to {1e6 * float(np.abs(gap).max()):.3g} nm: the stock is not of these operations"
                )
        return normals

    def _machined(self, points: NDArray, rows: NDArray) -> tuple[NDArray, NDArray]:
        device, n = self._device, len(points)
        given = [
            wp.array(points, dtype=wp.vec3d, device=device),
            wp.array(rows, dtype=wp.int32, device=device),
            wp.array(self._parts[rows].astype(np.int32), dtype=wp.vec2i, device=device),
        ]
        out = [wp.empty(n, dtype=kind, device=device) for kind in (wp.vec3d, wp.float64)]

        def launch(begin: int) -> None:
            size = min(_SLICE, n - begin) if wp.get_device(device).is_cpu else n
            wp.launch(kernels.end_normals, size, [*self._inputs, begin, *given], out, device=device)

        with ThreadPoolExecutor() as pool:  # a launch on the CPU runs on one thread
            list(pool.map(launch, range(0, n, _SLICE) if wp.get_device(device).is_cpu else [0]))
        return out[0].numpy(), out[1].numpy()


def face_data(cutters: Sequence[Profile], device: str) -> kernels.Sections:
    """The faces of all convex parts of cutters, one cutter after the other."""
    rows, first = [], [0]
    for part in (part for cutter in cutters for part in cutter.parts):
        for e in part.elements:
            ends = e.at(np.array([0.0, e.length]))
            centre = e.centre if e.is_arc else e.start
            rows.append([*centre, e.radius, ends.nr[0], ends.nz[0], ends.nr[1], ends.nz[1]])
        first.append(len(rows))
    data = kernels.Sections()
    data.faces = wp.array(np.array(rows), dtype=wp.float64, device=device)
    data.first = wp.array(first, dtype=wp.int32, device=device)
    return data
