"""Measuring a bevel tooth slot: flanks, fillets and bottom land under the motions of a job."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle
from gearsim.metrology.deviation import Deviation
from gearsim.metrology.machine import MeasuringMachine
from gearsim.metrology.roads import RoadGap, compare_roads
from gearsim.metrology.samples import SampleGrid, profile_rays, sample_grid
from gearsim.metrology.topography import Topography, topography
from gearsim.motion.segments import SegmentTable
from gearsim.motion.sources import MotionSource
from gearsim.surfaces.patch import Side, Tooth, ToothSurface


@dataclass(frozen=True)
class FlankMotion:
    """One way to finish a flank: the exact motions, and the table compiled from them."""

    sources: Sequence[MotionSource]
    table: SegmentTable


@dataclass(frozen=True)
class FlankPlan:
    """What is measured on one flank, and under which motions.

    ``theory`` is the planner's continuous motion (None: the path came from a file), ``cl`` the flank's own
    pass as CL data, ``program`` the whole program, ``others`` all of it but the own pass (None: nothing).
    """

    patch: ToothSurface
    grid: SampleGrid
    inspection: SampleGrid
    contact_height: float
    profile_offsets: NDArray[np.floating]
    theory: FlankMotion | None
    cl: FlankMotion
    program: SegmentTable
    others: SegmentTable | None


@dataclass(frozen=True)
class Convergence:
    """Largest change of the deviation [um] from the theoretical motion to one given by N points."""

    points: tuple[int, ...]
    worst_um: tuple[float, ...]

    @property
    def orders(self) -> list[float]:
        """Observed order between consecutive N, by the ratio of the spacings (N - 1)."""
        n, w = np.array(self.points) - 1.0, np.array(self.worst_um)
        with np.errstate(divide="ignore", invalid="ignore"):
            return [float(q) for q in np.log(w[:-1] / w[1:]) / np.log(n[1:] / n[:-1])]


@dataclass(frozen=True)
class FlankResult:
    """One flank measured on the dense grid, the inspector's grid and the mean profile.

    ``own`` (theoretical motion), ``own_cl``, ``all_passes`` (the program) and ``others`` are on the dense
    grid, as are the gaps of the two roads; ``inspection_gaps`` and ``topography`` are on the inspector's, the
    latter by the motions' names; profiles [um] of the theoretical motion
    (of the CL data where there is none) go by L0, L1, ...
    """

    side: Side
    grid: SampleGrid
    inspection: SampleGrid
    own: Deviation | None
    own_cl: Deviation
    all_passes: Deviation
    others: Deviation | None
    gap: RoadGap | None
    gap_cl: RoadGap
    inspection_gaps: tuple[RoadGap, ...]
    topography: dict[str, Topography]
    profile_um: dict[str, float]
    profile_inplane_um: dict[str, float]
    convergence: Convergence | None


@dataclass(frozen=True)
class PatchResult:
    """Fillet or bottom land after all passes."""

    grid: SampleGrid
    deviation: Deviation


def measure_flank(machine: MeasuringMachine, plan: FlankPlan, convergence: Convergence | None) -> FlankResult:
    """Measure one flank by both roads."""
    grid, inspection = plan.grid, plan.inspection
    lines = profile_rays(plan.patch, plan.profile_offsets, plan.contact_height)
    finest = plan.theory or plan.cl
    dense, coarse, normal, in_plane = machine.measure([grid.rays(), inspection.rays(), *lines], finest.table)
    finest_dense, finest_coarse = dense.reshaped(grid.shape), coarse.reshaped(inspection.shape)
    cl_dense, cl_coarse = finest_dense, finest_coarse
    if plan.theory:
        cl_dense, cl_coarse = _on_grids(machine, plan.cl.table, grid, inspection)
    all_dense, all_coarse = _on_grids(machine, plan.program, grid, inspection)
    others = machine.measure([grid.rays()], plan.others)[0].reshaped(grid.shape) if plan.others else None
    maps = {"own_pass_cl": cl_coarse, "all_passes": all_coarse}
    if plan.theory:
        maps["own_pass"] = finest_coarse
    names = [f"L{i}" for i in range(len(plan.profile_offsets))]
    on_inspection = [(plan.cl, cl_coarse)] + ([(plan.theory, finest_coarse)] if plan.theory else [])
    return FlankResult(
        side=plan.patch.side,
        grid=grid,
        inspection=inspection,
        own=finest_dense if plan.theory else None,
        own_cl=cl_dense,
        all_passes=all_dense,
        others=others,
        gap=_roads(machine, grid, plan.theory, finest_dense) if plan.theory else None,
        gap_cl=_roads(machine, grid, plan.cl, cl_dense),
        inspection_gaps=tuple(_roads(machine, inspection, m, d) for m, d in on_inspection),
        topography={k: topography(inspection, 1e3 * d.value) for k, d in maps.items()},
        profile_um=dict(zip(names, (1e3 * normal.value).tolist(), strict=True)),
        profile_inplane_um=dict(zip(names, (1e3 * in_plane.value).tolist(), strict=True)),
        convergence=convergence,
    )


def _roads(machine: MeasuringMachine, grid: SampleGrid, motion: FlankMotion, removal: Deviation) -> RoadGap:
    gap = compare_roads(grid, machine.cutter, motion.sources, removal)
    machine.progress(removal.value.size)
    return gap


def _on_grids(machine: MeasuringMachine, table: SegmentTable, *grids: SampleGrid) -> list[Deviation]:
    measured = machine.measure([g.rays() for g in grids], table)
    return [d.reshaped(g.shape) for d, g in zip(measured, grids, strict=True)]


def measure_convergence(
    machine: MeasuringMachine, rays: RayBundle, theory: SegmentTable,
    table: Callable[[int], SegmentTable], points: Sequence[int],
) -> Convergence:  # fmt: skip
    """How the deviation under a motion of N points approaches that of the theoretical motion."""
    exact = machine.measure([rays], theory)[0].value
    worst = [float(np.nanmax(1e3 * np.abs(machine.measure([rays], table(n))[0].value - exact))) for n in points]
    return Convergence(tuple(points), tuple(worst))


def measure_root(
    machine: MeasuringMachine, tooth: Tooth, program: SegmentTable, rows: int, columns: int,
    margin: float, window: float,
) -> dict[str, PatchResult]:  # fmt: skip
    """Both fillets and the bottom land after all passes, by name."""
    grids = [sample_grid(p, rows, columns, margin, window) for p in tooth.patches if p.part != "flank"]
    deviations = _on_grids(machine, program, *grids)
    return {g.patch.name: PatchResult(g, d) for g, d in zip(grids, deviations, strict=True)}
