"""A slot's tri-dexel as a third witness: dexel ends against rays along the normals at their feet."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import frame
from gearsim.metrology.closest import signed_distance
from gearsim.metrology.grid import GridInspection
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.metrology.samples import SampleGrid, window_rays
from gearsim.metrology.verdict import no_witness
from gearsim.simulation.dexels import DexelBox, DexelStock, machined_stock
from gearsim.simulation.intervals import IntervalSet
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Patch

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_NEAR = (0.05, 0.5, 2.0)
_MOST = 4000
_MARGIN = 1.5


@dataclass(frozen=True)
class DexelMeasurement:
    """The tri-dexel of a box: three bundles, and its agreement with rays along the normals.

    ``check_um`` is the largest distance, over ``checked`` cut dexel ends near a surface, to the nearest end of
    what the variant removes from the ray along the normal at the foot (inf: it removes nothing there).
    """

    variant: str
    box: DexelBox
    bundles: tuple[DexelStock, DexelStock, DexelStock]
    checked: int
    check_um: float
    surface: str = ""
    inspection: str = "tri-dexel"

    @property
    def removed_volumes(self) -> list[float]:
        """Removed volume [mm³] by each of the three bundles; their spread is the grid's error."""
        return [b.removed_volume for b in self.bundles]


@dataclass(frozen=True)
class DexelInspection:
    """A box of the part's stock cut by one variant; its ends are checked on the ``grids``, by their surfaces."""

    variant: str
    box: DexelBox
    grids: tuple[GridInspection, ...]
    name: str = "tri-dexel"

    def steps(self, job: Job) -> Steps[Reading]:
        assert job.part.stock is not None
        variant = job.variant(self.variant, self.grids[0].surface)
        cuts = yield [Cut(self.box.rays(axis), variant) for axis in range(3)]
        bundles = [machined_stock(self.box, axis, job.part.stock, cut) for axis, cut in enumerate(cuts)]
        points = np.concatenate([b.cut_points()[0] for b in bundles])
        for near in _NEAR:
            feet = [_feet(inspection.grid(job), points, near) for inspection in self.grids]
            if any(len(distance) for _, distance in feet):
                break
        removed = yield [Cut(rays, variant) for rays, _ in feet]
        gaps = [_foot_gaps(distance, cut) for (_, distance), cut in zip(feet, removed, strict=True)]
        checked = sum(map(len, gaps))
        worst = max(1e3 * float(gap.max(initial=0.0)) for gap in gaps)
        found = DexelMeasurement(self.variant, self.box, (bundles[0], bundles[1], bundles[2]), checked, worst)
        return Reading((found,), (), tuple(no_witness(checked, worst)))


def slot_box(patches: Sequence[Patch], blank: BevelBlank, pitch: float) -> DexelBox:
    """The box around a slot's patches, along the pitch cone at their middle, with some tooth on every side."""
    middle = patches[len(patches) // 2]
    origin = middle.jet(*middle.locate(np.array([0.5]), np.array([0.5]))).r[0]
    along, normal = blank.cone_directions(origin)
    local = frame(origin, along, normal)
    edges = np.linspace(0.0, 1.0, 33)
    corners = [patch.jet(*patch.locate(edges, np.full(33, tip))).r for patch in patches for tip in (0.0, 1.0)]
    points = local.inverse().point(np.concatenate(corners))
    return DexelBox(local, points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN, pitch)


def _feet(grid: SampleGrid, points: NDArray, within: float) -> tuple[RayBundle, NDArray]:
    """Rays along the normals at the feet of points near a surface, and how far [mm] these lie from it.

    At most a few thousand, evenly picked.
    """
    distance, u, v = signed_distance(grid, points, within)
    near = np.flatnonzero(np.abs(distance) < within)
    near = near[:: max(1, len(near) // _MOST)]
    return window_rays(grid.patch, u[near], v[near], grid.patch.jet(u[near], v[near]).normal), distance[near]


def _foot_gaps(distance: NDArray, removed: IntervalSet) -> NDArray:
    """How far [mm] dexel ends near a surface are from the cuts' ends on the normals at their feet."""
    gaps = np.full(len(distance), np.inf)
    for ends in (removed.lo, removed.hi):
        np.minimum.at(gaps, removed.ray, np.abs(ends - distance[removed.ray]))
    return gaps
