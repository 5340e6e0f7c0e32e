"""A surface cut by one tool along its passes, set against its predicted local gouging, contact by contact."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, cast

import numpy as np

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle
from gearsim.gouging.attribution import (
    Attribution,
    Cause,
    attribute,
    nearest_moves,
    segment_ends,
    straight_distance,
)
from gearsim.gouging.prediction import Prediction, predict, predict_path
from gearsim.gouging.rings import RingResult, read_rings, rings
from gearsim.metrology.deviation import Crossing, Deviation, measure
from gearsim.metrology.findings import Finding
from gearsim.metrology.grid import DENSE, GridMeasurement
from gearsim.metrology.inspection import Cut, Reading, Steps
from gearsim.metrology.roads import LIMIT_UM
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.metrology.study import Change, study_steps
from gearsim.metrology.verdict import untouched
from gearsim.motion.segments import SegmentTable
from gearsim.simulation.operation import Variant, operation
from gearsim.surfaces.nurbs import NurbsSurface
from gearsim.toolpaths.sculptured import SculpturedPath

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_CHECKED = 300
_LEFT_MM = 1e-6
_WORDS = {
    Cause.LOCAL: "gouges locally, where its curvature is predicted to be less than the part's",
    Cause.TIE: "overcuts where the curvatures tie",
    Cause.GLOBAL: "hits another part of the surface: the contact itself is clear (global gouging)",
    Cause.UNPREDICTED: "overcuts where nothing is predicted to gouge",
    Cause.UNKNOWN: "cuts through the measuring window: raise metrology.window_mm",
}


@dataclass(frozen=True)
class ToolCut:
    """A surface cut by one tool: what its curvatures predicted and what was found.

    ``contacts`` are predicted at the path's, ``samples`` at the grid's points (row-major); ``check_um``: how far
    machined points lie off the tool by a search of its own.
    """

    cutter: Profile
    path: SculpturedPath
    segments: int
    grid: SampleGrid
    contacts: Prediction
    samples: Prediction
    deviation: Deviation
    made: Attribution
    rings: RingResult
    check_um: float


@dataclass(frozen=True)
class GougingMeasurement:
    """Prediction and cut of one tool, a variant, on a surface."""

    surface: str
    variant: str
    cut: ToolCut
    inspection: str = "gouging"


@dataclass(frozen=True)
class GougingInspection:
    """A surface on a grid under one variant, all its contacts cut one by one; the same under tools beside its own.

    ``compared`` are a study: the tools that stand in the variant's place one after the other. Overcut deeper than
    ``tolerance_um`` is attributed; it fails under the variant's own tool alone. ``paths`` are the passes of all tools
    by their operations' names; ``ring`` [mm]: how far beside a contact is looked.
    """

    surface: str
    variant: str
    paths: Mapping[str, SculpturedPath]
    compared: tuple[Change, ...]
    rows: int
    columns: int
    margin: float
    ring: float
    tolerance_um: float
    name: str = "gouging"

    def steps(self, job: Job) -> Steps[Reading]:
        cuts = yield from study_steps(job, [Change(self.variant, "", {}), *self.compared], self._cut)
        variants = [job.variant(self.variant), *(self._beside(job, change) for change in self.compared)]
        found = list(zip(variants, cuts, strict=True))
        return Reading(
            tuple(chain.from_iterable(self._measured(variant, cut) for variant, cut in found)),
            tuple(chain.from_iterable(self._findings(variant.name, cut) for variant, cut in found)),
            tuple(chain.from_iterable(self._doubts(variant.name, cut) for variant, cut in found)),
            (self.surface,),
            tuple(self._remarks(cuts[0])),
        )

    def _beside(self, job: Job, change: Change) -> Variant:
        """What stands in the variant's place, under the change's name."""
        return replace(job.under(change.variants).variant(self.variant), name=change.name)

    def _cut(self, job: Job) -> Steps[ToolCut]:
        """The surface cut by the tool that stands in the variant's place."""
        surface, variant = cast(NurbsSurface, job.part.patch(self.surface)), job.variant(self.variant)
        cutter, (made_by,) = variant.cutter, variant.operations
        path = self._path(made_by.name)
        grid = sample_grid(surface, self.rows, self.columns, self.margin)
        found, rays = predict_path(surface, cutter, path), grid.rays()
        asked = rings(surface, cutter, path, found, self.ring)
        standing = Variant("standing", "", (operation("contacts", cutter, [asked.standing], 1e-9),))
        whole, alone = yield [Cut(rays, variant), Cut(asked.rays, standing)]
        deviation, at = measure(rays, whole), (grid.u.ravel(), grid.v.ravel())
        made = attribute(surface, cutter, path, made_by.table, deviation, at, 1e-3 * self.tolerance_um)
        return ToolCut(
            cutter=cutter,
            path=path,
            segments=len(made_by),
            grid=grid,
            contacts=found,
            samples=predict(surface, cutter, *at),
            deviation=deviation.reshaped(grid.shape),
            made=Attribution(*(x.reshape(grid.shape) for x in (made.cause, made.contact, made.apart))),
            rings=read_rings(asked, found, measure(asked.rays, alone), self.ring),
            check_um=_check(cutter, path, made_by.table, rays, deviation),
        )

    def _path(self, tool: str) -> SculpturedPath:
        if tool not in self.paths:
            raise InputError(
                f"gouging of {self.surface}: the contacts of {tool!r} are not known; in the place of {self.variant!r} "
                f"may stand {', '.join(map(repr, self.paths))}"
            )
        return self.paths[tool]

    def _measured(self, variant: Variant, cut: ToolCut) -> tuple[GridMeasurement, GougingMeasurement]:
        nowhere = np.zeros(cut.grid.shape, dtype=bool)
        grid = GridMeasurement(self.surface, variant, DENSE, cut.grid, nowhere, nowhere, cut.deviation)
        return grid, GougingMeasurement(self.surface, variant.name, cut)

    def _findings(self, tool: str, cut: ToolCut) -> Iterator[Finding]:
        """The deepest overcut of each cause; it fails where the tool is the variant's own."""
        depth = np.where(cut.deviation.crossing == Crossing.THROUGH, -cut.grid.inward, cut.deviation.value)
        for cause, text in _WORDS.items():
            mine = cut.made.cause == cause
            if not mine.any():
                continue
            worst = np.unravel_index(int(np.argmin(np.where(mine, depth, np.inf))), cut.grid.shape)
            x, y, z = (float(c) for c in cut.grid.point[worst])
            kind = f"{cause.name.lower()}_gouging" if cause <= Cause.GLOBAL else "overcut"
            text = f"the {tool} {text} ({int(mine.sum())} samples)"
            own = tool == self.variant
            yield Finding(kind, self.surface, 1e3 * float(depth[worst]), (x, y, z), None, None, own, text)

    def _remarks(self, cut: ToolCut) -> Iterator[str]:
        """Where the judged tool does not come, what it leaves, and what was not looked at."""
        away = int(np.count_nonzero(~np.isfinite(cut.path.touches.tip[:, 0])))
        if away:
            yield f"the {self.variant} reaches {len(cut.path) - away:,} of {len(cut.path):,} contacts of its passes"
        size = cut.deviation.crossing.size
        uncut = int(np.count_nonzero(cut.deviation.crossing == Crossing.UNCUT))
        if uncut:
            yield f"{uncut:,} of {size:,} samples are met by no cut within metrology.window_mm"
        left = float(np.nanmax(cut.deviation.value, initial=0.0))
        if left > _LEFT_MM:
            yield f"up to {1e3 * left:.4g} um of material is left, which nothing is held against"
        alone, near, touching = len(cut.rings.contact), int(cut.rings.near.sum()), int(cut.contacts.touches.sum())
        if alone < touching or near:
            tied = f", {near:,} of them too near a tie to tell" if near else ""
            yield f"prediction and cut were compared at {alone:,} of {touching:,} contacts{tied}"
        if self.margin > 0.0:
            yield f"{100.0 * self.margin:g} % of the surface was left out at every edge"

    def _doubts(self, tool: str, cut: ToolCut) -> Iterator[str]:
        """Where the variant's own tool cuts nothing, or prediction, cut and search disagree."""
        if tool == self.variant:
            yield from untouched(f"the surface with the {tool}", cut.deviation)
            if not len(cut.rings.contact):
                yield f"no contact of the {tool} was cut alone: prediction and cut were compared nowhere"
        if cut.check_um > LIMIT_UM:
            yield f"{tool}: machined points lie {cut.check_um:.3g} um off the tool (limit {LIMIT_UM:g})"
        unknown, unpredicted = cut.made.count(Cause.UNKNOWN), cut.made.count(Cause.UNPREDICTED)
        if unknown:
            yield f"{tool}: {unknown} samples are cut through the window; raise metrology.window_mm"
        if unpredicted or cut.rings.disagree.any():
            yield (
                f"{tool}: prediction and cut disagree at {int(cut.rings.disagree.sum())} contacts cut alone; "
                f"{unpredicted} samples are overcut where nothing is predicted to gouge"
            )


def _check(
    cutter: Profile, path: SculpturedPath, table: SegmentTable, rays: RayBundle, deviation: Deviation
) -> float:  # fmt: skip
    """Largest distance [um] of machined points from the tool over the whole path, by a search that shares no code.

    A machined point must touch the tool at the nearest move and be inside it at none.
    """
    measured = np.flatnonzero(deviation.measured)
    chosen = measured[:: max(1, len(measured) // _CHECKED)]
    points = rays.origin[chosen] + deviation.value[chosen, None] * rays.direction[chosen]
    ends = segment_ends(path, table)
    start, end = path.touches.tip[ends[:, 0]], path.touches.tip[ends[:, 1]]
    point, move = nearest_moves(cutter, start, end, points)
    distance = straight_distance(cutter, start[move], end[move], points[point])
    nearest = np.full(len(points), np.inf)
    np.minimum.at(nearest, point, distance)
    return 1e3 * float(np.max(np.abs(nearest), initial=0.0))
