"""The whole part as stock: cut from its blank, operation after operation, and held against the intended surfaces."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.solid import Solid
from gearsim.geometry.wedge import Wedge
from gearsim.metrology.blank_check import outside
from gearsim.metrology.findings import Finding, stock_out_of_tolerance, through_material
from gearsim.metrology.inspection import Machine, Reading, Steps
from gearsim.metrology.samples import sample_grid
from gearsim.metrology.stock_surfaces import (
    NEAR_MM,
    SurfaceFigures,
    beside_solid,
    cut_ends,
    near,
    near_surface,
)
from gearsim.simulation.contour.surface import Contour, at_vertices
from gearsim.simulation.dexels import DexelBox
from gearsim.simulation.operation import Operation, turned_copies
from gearsim.simulation.sequence import Machined, Machining, in_sequence
from gearsim.simulation.stock import Stock
from gearsim.simulation.turning import Turning
from gearsim.simulation.work import Work
from gearsim.surfaces.part import NamedFaces, Part, Tolerance

if TYPE_CHECKING:
    from gearsim.metrology.job import Job

_ROWS, _COLUMNS, _MARGIN = 33, 129, 0.01


@dataclass(frozen=True)
class OperationFigures:
    """What an operation did: its ``rows`` and, of each (rows,), ``volume`` [mm³] taken, ``way`` [mm] of the tip and
    ``seconds`` (nan where nothing says them). ``removed`` [mm³] by each bundle of the fine box. ``near``: how many of
    its rows by rapid are not for certain clear of the uncut blank.
    """

    operation: Operation
    removed: tuple[float, float, float]
    volume: NDArray[np.floating]
    way: NDArray[np.floating]
    seconds: NDArray[np.floating]
    near: int

    @property
    def name(self) -> str:
        return self.operation.name

    @property
    def air(self) -> NDArray[np.bool_]:
        """Which rows are fed through air."""
        return ~self.operation.rapid & (self.volume == 0.0)


class TurnedFigures(NamedTuple):
    """Turning before all operations: what it ``removed`` [mm³] by each bundle, and its ``seconds``, if known."""

    name: str
    removed: tuple[float, float, float]
    seconds: float | None


@dataclass(frozen=True)
class StockMeasurement:
    """A whole blank machined: its volumes [mm³] by bundle before, the stock and its surface after, what was found.

    ``deviation`` [mm] at each of the contour's vertices, by the ends of material around it, from what is intended near
    them; nan where nothing is. ``tolerances``: what of an intended solid the ends are held against, by name.
    ``sectors``: of how many alike ones the blank is one; 1: it is whole. ``exact_blank_volume`` [mm³]: nan where
    another run has left the blank. ``intended_volume`` [mm³], where it is known.
    """

    variant: str
    stock: Stock
    contour: Contour
    blank_volumes: tuple[float, float, float]
    exact_blank_volume: float
    deviation: NDArray[np.floating]
    operations: tuple[OperationFigures, ...]
    surfaces: tuple[SurfaceFigures, ...]
    tolerances: Mapping[str, Tolerance] = field(default_factory=dict)
    sectors: int = 1
    intended_volume: float | None = None
    turned: TurnedFigures | None = None
    surface: str = ""
    inspection: str = "stock"


@dataclass(frozen=True)
class StockInspection:
    """A ``blank`` cut by a variant, ``copies`` times about the part's axis, seen by the tri-dexel of a box.

    ``intended``: the solid that the whole stock is held against, where there is one; its faces then stand for the
    part's surfaces. ``rapid_mm_min``: how fast the tip goes by rapid (None: not known). ``saved``: the stock that
    another run has left, which the blank is but for what no ray sees. ``turning`` comes before all operations.
    """

    variant: str
    blank: Solid
    box: DexelBox
    copies: int = 1
    spaces: int = 1
    rapid_mm_min: float | None = None
    intended: NamedFaces | None = None
    saved: Stock | None = None
    turning: Turning | None = None
    name: str = "stock"

    def operations(self, job: Job) -> tuple[Operation, ...]:
        """What is done to the blank, in order."""
        once = in_sequence(job.variant(self.variant))
        return tuple(turned_copies(o, self.copies) for o in once) if self.copies > 1 else once

    def machining(self, job: Job) -> Machining:
        """The same with all that it begins with."""
        return Machining(self.blank, self.box, self.operations(job), self.saved, self.turning)

    def steps(self, job: Job) -> Steps[Reading]:
        machined: Machined = (yield [Machine(self.machining(job))])[0]
        left = np.array([machined.turned_volumes, *(work.left for work in machined.work)])
        figures = tuple(map(self._figures, machined.work, -np.diff(left, axis=0)))
        surfaces: list[SurfaceFigures] = []
        findings: list[Finding] = []
        ends = cut_ends(machined.stock)
        for intended in job.part.surfaces.values():
            grid = sample_grid(intended.patch, _ROWS, _COLUMNS, _MARGIN)
            for blank, known_to in self._begun_with():
                findings += outside(grid, intended.tolerance, blank, self.copies, job.part, known_to)
            if self.intended is None:
                surfaces.append(near_surface(grid, ends, self.spaces))
                findings += list(_judged(surfaces[-1], intended.tolerance, job))
        if self.intended is not None:
            surfaces, doubts = beside_solid(self.intended, machined.stock)
            for found in surfaces:
                findings += list(_judged(found, self.intended.tolerances[found.surface], job))
        findings += self._rapids(machined, job)
        measured = StockMeasurement(
            self.variant, machined.stock, machined.contour, machined.blank_volumes,
            self.blank.volume if self.saved is None else np.nan,
            at_vertices(machined.contour, self._deviation(job, machined)), figures, tuple(surfaces),
            {} if self.intended is None else self.intended.tolerances,
            self.copies if isinstance(self.blank, Wedge) else 1,
            None if self.intended is None else self.intended.volume, self._turned(machined),
        )  # fmt: skip
        if self.intended is None:
            doubts = _none_near(surfaces, job)
            return Reading((measured,), tuple(findings), doubts, remarks=self._remarks())
        judged = tuple(self.intended.tolerances)
        return Reading((measured,), tuple(findings), doubts, judged, one_road(self.intended, job.part))

    def _turned(self, machined: Machined) -> TurnedFigures | None:
        if self.turning is None:
            return None
        x, y, z = (a - b for a, b in zip(machined.blank_volumes, machined.turned_volumes, strict=True))
        seconds = None if self.turning.rate is None else 60.0 * (x + y + z) / 3.0 / self.turning.rate
        return TurnedFigures(self.turning.name, (x, y, z), seconds)

    def _begun_with(self) -> Iterator[tuple[Solid, float]]:
        """The solids that must hold the part's surfaces, and what their own are known to [mm].

        A saved stock's is joined between rays. Where a solid is intended, all its ends are held against that: no more
        is known.
        """
        if self.saved is None:
            yield self.blank, 0.0
        elif self.intended is None:
            yield self.blank, self._cell
        if self.turning:
            yield self.turning.kept, 0.0

    @property
    def _cell(self) -> float:
        """From corner to corner of a cell [mm]."""
        return 3.0**0.5 * self.box.pitch

    def _remarks(self) -> tuple[str, ...]:
        saved = f"whether the saved stock holds the surfaces to be cut is known to {self._cell:.3g} mm alone"
        return (*[self._said()] * (self.copies > 1), *[saved] * (self.saved is not None))

    def _said(self) -> str:
        which = "one sector of them is" if isinstance(self.blank, Wedge) else "beside one they are"
        seen = f"at the ends of rays {self.box.pitch:g} mm apart, by one road"
        return f"all {self.copies} spaces are cut by the same program, indexed; {which} judged {seen}"

    def _deviation(self, job: Job, machined: Machined) -> NDArray:
        """Signed distances of a contour's hits from the intended solid, or of those cut from the nearest surface."""
        found = machined.contour
        points = found.hit
        if self.intended is not None:
            distance = self.intended.signed_distance(points)
            return np.where(np.abs(distance) < NEAR_MM, distance, np.nan)
        cut, out = np.zeros(len(points), dtype=bool), np.full(len(points), np.nan)
        cut[found.of[machined.stock.cut(found.mesh.tag)]] = True
        for intended in job.part.surfaces.values():
            close, distance = near(sample_grid(intended.patch, _ROWS, _COLUMNS, 0.0), points, self.spaces)
            nearer = cut[close] & ~(np.abs(out[close]) <= np.abs(distance))
            out[close[nearer]] = distance[nearer]
        return out

    def _figures(self, work: Work, removed: NDArray) -> OperationFigures:
        operation, ends = work.operation, []
        for x in (-1.0, 1.0):
            ends.append((operation.table.tip * x ** np.arange(operation.table.tip.shape[1])[:, None]).sum(axis=1))
        way = np.linalg.norm(ends[1] - ends[0], axis=1)
        seconds = operation.seconds
        if self.rapid_mm_min is not None:
            seconds = np.where(operation.rapid, 60.0 * way / self.rapid_mm_min, seconds)
        x, y, z = (float(v) for v in removed)
        return OperationFigures(operation, (x, y, z), work.volume, way, seconds, work.near)

    def _rapids(self, machined: Machined, job: Job) -> Iterator[Finding]:
        for work in machined.work:
            if work.touch is not None:
                line = int(work.operation.line[work.touch.row])
                called = f"a rapid move of {work.operation.name}" + (f" in line {line}" if line else "")
                yield through_material(job.part, work.touch.place, 1e3 * work.touch.depth, called)


def one_road(intended: NamedFaces, part: Part) -> tuple[str, ...]:
    """What must be said of the faces that are no surfaces of the part's own, which two roads measure."""
    alone = [name for name in intended.tolerances if name not in part.surfaces]
    return (f"{', '.join(alone)}: by one road only, at the ends of a tri-dexel's rays",) if alone else ()


def _none_near(surfaces: list[SurfaceFigures], job: Job) -> tuple[str, ...]:
    """Why the whole part says nothing of the judged surfaces, if it does not."""
    judged = [found for found in surfaces if job.part.surfaces[found.surface].tolerance is not None]
    if not judged or any(found.ends for found in judged):
        return ()
    return ("no cut end of the whole part's rays lies near a judged surface; a finer stock.pitch_mm may find some",)


def _judged(found: SurfaceFigures, tolerance: Tolerance | None, job: Job) -> Iterator[Finding]:
    """The deepest cut and the most material left, where they are too much."""
    if tolerance is None or not found.ends:
        return
    for value, place, sign in ((found.overcut, found.overcut_place, -1.0), (found.excess, found.excess_place, 1.0)):
        if sign * value > 0.0 and not tolerance.allows(1e3 * value):
            yield stock_out_of_tolerance(job.part, found.surface, place, 1e3 * value)
