"""Surfaces measured on grids of points along their normals, under any variants, by both roads."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from gearsim.envelope import TRIM_TOLERANCE
from gearsim.geometry.rays import RayBundle
from gearsim.metrology.convergence import Series
from gearsim.metrology.deviation import Crossing, Deviation, measure
from gearsim.metrology.findings import Finding, cross_cut, deeper_than_last, out_of_tolerance, stock_left
from gearsim.metrology.inspection import Cut, Question, Reading, Solve, Steps, together
from gearsim.metrology.last_operation import last_heading, made_last
from gearsim.metrology.roads import LIMIT_UM, RoadGap, road_gap
from gearsim.metrology.samples import SampleGrid, sample_grid
from gearsim.metrology.study import study_steps
from gearsim.metrology.topography import Topography, topography
from gearsim.metrology.verdict import no_agreement, not_compared, partly, untouched
from gearsim.simulation.operation import Variant

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

DENSE, COARSE = "dense grid", "inspection grid"


@dataclass(frozen=True)
class GridMeasurement:
    """A surface on a grid under one variant, ``by``; ``gap``: the two roads held against each other (None: one alone).

    ``missing``: no such point (the intended surface does not exist there); ``trimmed``: the generating motion itself
    cuts deeper there with another pose. Both of shape (rows, columns); such samples are not measured. ``topography``
    only on an inspector's grid of a gear's flank.
    """

    surface: str
    by: Variant
    inspection: str
    grid: SampleGrid
    missing: NDArray[np.bool_]
    trimmed: NDArray[np.bool_]
    deviation: Deviation
    gap: RoadGap | None = None
    topography: Topography | None = None

    @property
    def variant(self) -> str:
        return self.by.name

    @property
    def measurable(self) -> NDArray:
        """Samples that lie on the machined surface of the generating motion, shape (rows, columns)."""
        return ~(self.missing | self.trimmed)

    @property
    def gap_um(self) -> NDArray:
        """The gap of the two roads [um] on the grid, nan where they were not compared."""
        gap = np.full(self.grid.shape, np.nan)
        if self.gap is not None:
            gap[self.measurable] = self.gap.gap_um
        return gap


@dataclass(frozen=True)
class GridInspection:
    """One surface on a grid of ``rows`` x ``columns`` points that leaves ``margin`` (a share) free at every edge.

    It is measured under ``variants``, by both roads under those of ``witnessed``, and held against the surface's
    tolerance under those of ``judged``. ``strangers`` names a variant of operations that should not touch it.
    ``generating``: the variant whose envelope the intended surface is; samples that it trims are left out.
    ``series`` are motions of more and more points; ``window`` scales the measuring windows; ``rotated``: topography
    is read, rotations taken out. ``last``: under that name the rows of the program (the first of ``variants``) that
    made the surface last are asked again, alone, by both roads; those under the program's last heading, or the one
    whose number is ``heading``. ``remark`` must be said with the verdict.
    """

    surface: str
    variants: tuple[str, ...]
    witnessed: tuple[str, ...]
    rows: int
    columns: int
    margin: float = 0.0
    window: float = 1.0
    judged: tuple[str, ...] = ()
    strangers: str = ""
    generating: str = ""
    series: tuple[Series, ...] = ()
    rotated: bool = False
    last: str = ""
    heading: int | None = None
    remark: str = ""
    name: str = DENSE

    def grid(self, job: Job) -> SampleGrid:
        """Where the surface is measured."""
        return sample_grid(job.part.patch(self.surface), self.rows, self.columns, self.margin, self.window)

    def measurable(self, job: Job, grid: SampleGrid) -> NDArray[np.bool_]:
        """Which samples of the grid lie on the machined surface of the generating motion, shape (rows, columns)."""
        missing, trimmed = self._left_out(job, grid)
        return np.asarray(~(missing | trimmed))

    def steps(self, job: Job) -> Steps[Reading]:
        grid = self.grid(job)
        missing, trimmed = self._left_out(job, grid)
        measurable = ~(missing | trimmed)
        rays = grid.rays() if measurable.all() else grid.rays().part(measurable.ravel())
        series = self.series if len(rays) else ()
        (flat, gaps), *converging = yield from together([self._motions(job, rays), *(
            study_steps(job, s.changes, partial(self._along, rays, s.of)) for s in series
        )])  # fmt: skip
        found = {
            name: self._measurement(grid, missing, trimmed, self._variant(job, name), flat[name], gaps.get(name))
            for name in self.variants
        }
        strangers = spread(flat[self.strangers], measurable) if self.strangers else None
        alone = (yield from self._alone(job, rays, flat[self.variants[0]])) if self.last else None
        if alone is not None:
            found[self.last] = self._measurement(grid, missing, trimmed, *alone)
        read = [s.read(self.surface, flat[s.exact], lines) for s, lines in zip(series, converging, strict=True)]
        findings = tuple(self._findings(job, grid, found, strangers))
        remarks = tuple(self._remarks(found)) if self.judged else ()
        return Reading((*found.values(), *read), findings, tuple(self._doubts(found)), self._judged(), remarks)

    def _motions(self, job: Job, rays: RayBundle) -> Steps[Any]:
        """Deviations under the motions by name, and the gaps of the two roads under those that are witnessed."""
        cut = dict.fromkeys([*self.variants, *([self.strangers] if self.strangers else [])])
        asked: list[Question] = [Cut(rays, self._variant(job, name)) for name in cut]
        answers = iter((yield [*asked, *(Solve(rays, self._variant(job, name)) for name in self.witnessed)]))
        flat = {name: measure(rays, next(answers)) for name in cut}
        return flat, {name: road_gap(next(answers), flat[name]) for name in self.witnessed}

    def _along(self, rays: RayBundle, name: str, job: Job) -> Steps[Any]:
        """The deviations under one motion alone."""
        (removed,) = yield [Cut(rays, self._variant(job, name))]
        return measure(rays, removed)

    def _alone(self, job: Job, rays: RayBundle, whole: Deviation) -> Steps[tuple[Variant, Deviation, RoadGap] | None]:
        """Deviation and gap under the rows that made the surface last; None where none of them did."""
        last = made_last(self.last, self._variant(job, self.variants[0]), whole, self.heading)
        if last is None:
            return None
        removed, road = yield [Cut(rays, last), Solve(rays, last)]
        deviation = measure(rays, removed)
        return last, deviation, road_gap(road, deviation)

    def _variant(self, job: Job, name: str) -> Variant:
        return job.variant(name, self.surface)

    def _left_out(self, job: Job, grid: SampleGrid) -> tuple[NDArray, NDArray]:
        missing = ~np.isfinite(grid.point[..., 0])
        trimmed = np.zeros(grid.shape, dtype=bool)
        if self.generating:
            variant = self._variant(job, self.generating)
            least = least_distance(variant, grid.point[~missing])
            trimmed[~missing] = least < -TRIM_TOLERANCE
        return missing, trimmed

    def _measurement(
        self, grid: SampleGrid, missing: NDArray, trimmed: NDArray, by: Variant, flat: Deviation, gap: RoadGap | None
    ) -> GridMeasurement:
        deviation = spread(flat, ~(missing | trimmed))
        turned = topography(grid, 1e3 * deviation.value) if self.rotated else None
        return GridMeasurement(self.surface, by, self.name, grid, missing, trimmed, deviation, gap, turned)

    def _judged(self) -> tuple[str, ...]:
        return (self.surface,) if self.judged else ()

    def _findings(
        self, job: Job, grid: SampleGrid, found: dict[str, GridMeasurement], strangers: Deviation | None
    ) -> Iterator[Finding]:
        tolerance = job.part.surfaces[self.surface].tolerance
        if strangers is not None:
            yield from cross_cut(grid, strangers, tolerance)
        for name in self.judged:
            yield from out_of_tolerance(grid, found[name].deviation, tolerance, f"under {name}")
            yield from stock_left(grid, found[name].deviation, tolerance)
        if self.last in found:
            yield from deeper_than_last(grid, found[self.variants[0]].deviation, found[self.last].deviation)

    def _doubts(self, found: dict[str, GridMeasurement]) -> Iterator[str]:
        any_one = next(iter(found.values()))
        if not any_one.measurable.any():
            yield f"no sample of {self.surface} lies on the machined surface: nothing of it was judged"
            return
        for name in self.judged:
            yield from self._not_judged(found, name)
        first = found[self.variants[0]]
        if self.last and self.last not in found and not untouched(self.surface, first.deviation):
            heading = last_heading(first.by, self.heading)
            last = f"the last operation ({heading})" if heading else "the last operation"
            yield f"{last} cuts no sample of {self.surface}: the two roads compared nothing"
        for name in (*self.witnessed, *([self.last] if self.last in found else [])):
            yield from no_agreement(f"{self.surface} under {name}", found[name].gap)
        if self.generating in found:
            yield from self._not_its_own(found[self.generating])

    def _remarks(self, found: dict[str, GridMeasurement]) -> list[str]:
        """What of the surface was not judged, or not compared under any of the motions."""
        measurable = next(iter(found.values())).measurable
        gaps = [m.gap for m in found.values() if m.gap is not None]
        told = [self.remark] if self.remark else []
        return told + partly(self.surface, measurable.size, int(measurable.sum()), gaps)

    def _not_judged(self, found: dict[str, GridMeasurement], name: str) -> list[str]:
        what = f"{self.surface} under {name}"
        own = found[name].gap
        others = (m.gap for m in found.values() if m.gap is not None and m.variant != self.generating)
        gaps = [own] if own is not None else list(others)
        nothing = untouched(what, found[name].deviation)
        return nothing or ([] if self.last and self.last not in found else not_compared(what, gaps))

    def _not_its_own(self, own: GridMeasurement) -> Iterator[str]:
        """Where the motion that generates the closed form does not cut it."""
        off = 1e3 * float(np.nanmax(np.abs(own.deviation.value[own.measurable]), initial=0.0))
        lost = int(np.count_nonzero(own.measurable & ~own.deviation.measured))
        if off > LIMIT_UM or lost:
            yield (
                f"the closed form of {self.surface} differs from what its own motion removes by {off:.3g} um "
                f"(limit {LIMIT_UM:g}); {lost} samples are not cut near it"
            )


def least_distance(variant: Variant, points: NDArray) -> NDArray:
    """Least signed distance [mm] of points, shape (n, 3), to the variant's cutter over its motions."""
    from gearsim.envelope.swept import Swept

    return np.min([Swept(source, variant.cutter).least_distance(points) for source in variant.motions()], axis=0)


def spread(part: Deviation, where: NDArray) -> Deviation:
    """Deviations of the chosen samples on the whole grid; the others are ABSENT."""
    if where.all():
        return part.reshaped(where.shape)

    def on_grid(values: NDArray, rest: Any) -> NDArray:
        out = np.full(where.shape, rest, dtype=values.dtype)
        out[where] = values
        return out

    return Deviation(
        on_grid(part.value, np.nan), on_grid(part.crossing, Crossing.ABSENT), on_grid(part.segment, -1),
        on_grid(part.multiple, False),
    )  # fmt: skip


def grids(measurements: Sequence[Any], inspection: str = DENSE) -> dict[tuple[str, str], GridMeasurement]:
    """Of some measurements those on grids of one inspection, by surface and variant."""
    mine = (m for m in measurements if isinstance(m, GridMeasurement) and m.inspection == inspection)
    return {(m.surface, m.variant): m for m in mine}
