"""The error budget: space 0 cut again and again, each time with one cause of deviations alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np

from gearsim.generation_milling.cutting import run_program
from gearsim.generation_milling.disturbance import Disturbance
from gearsim.generation_milling.inspect import inspect
from gearsim.generation_milling.job import GearJob, planned, posted
from gearsim.metrology.machine import MachineFor
from gearsim.programs.blocks import Blocks
from gearsim.programs.operation import Operation
from gearsim.result import BudgetLine
from gearsim.scene.generation_milling import BudgetTable
from gearsim.surfaces.cylindrical_gear import SIDES
from gearsim.toolpaths.cylindrical.settings import Finishing

_NONE = Disturbance()


class Cause(NamedTuple):
    """One cause alone: its ``name`` and ``size``, the blocks cut, by which machine, and how many spaces probed."""

    name: str
    size: str
    blocks: Callable[[], Blocks]
    real: Disturbance = _NONE
    spaces: int = 1


@dataclass(frozen=True)
class _Planner:
    """The finishing operation alone, exact numbers, changed in one way at a time."""

    job: GearJob

    def operation(self, tip_control: bool = False, **changes: float | str) -> Operation:
        finishing = replace(self.job.finishing, **changes)  # type: ignore[arg-type]
        assert isinstance(finishing, Finishing)
        return planned(self.job.gear, self.job.machine, (finishing,), tip_control)[0]

    def one_space(self, tip_control: bool = False, **changes: float | str) -> Blocks:
        return first_space(self.operation(tip_control, **changes), self.job.gear.count).blocks

    def written(self, decimals: int) -> Blocks:
        operation = first_space(self.operation(), self.job.gear.count)
        return posted((operation,), self.job.machine, decimals).blocks


def first_space(operation: Operation, spaces: int) -> Operation:
    """An operation that repeats in every space, in the first one only."""
    blocks = operation.blocks
    own = slice(0, (len(blocks) + 1) // spaces - 1)  # the last block of a space leads to the next
    columns = ("values", "rapid", "tip_control", "seconds", "line", "tool", "operation", "sweep", "centre", "normal")
    return replace(operation, blocks=replace(blocks, **{name: getattr(blocks, name)[own] for name in columns}))


def budget(job: GearJob, sizes: BudgetTable, machine_for: MachineFor) -> tuple[BudgetLine, ...]:
    """Cut every cause alone and inspect it."""
    return tuple(_line(job, cause, machine_for) for cause in causes(job, sizes))


def causes(job: GearJob, sizes: BudgetTable) -> Iterator[Cause]:
    """The causes, from what the method itself costs to what a workshop adds."""
    plan = _Planner(job)
    exact, every = "exact numbers, all axes linear", plan.one_space
    yield Cause("none", exact, every)
    for step in sizes.involute_steps_mm:
        for tip in (False, True):
            text = "tool-centre-point control" if tip else "all axes linear"
            blocks = partial(plan.one_space, tip, involute_step=step, spacing="arc")
            yield Cause("involute step", f"{step:g} mm, {text}", blocks)
    fine = min(sizes.involute_steps_mm, default=job.finishing.involute_step)
    for step in sizes.axial_steps_mm:
        for tip in (False, True):
            text = "tool-centre-point control" if tip else "all axes linear"
            blocks = partial(plan.one_space, tip, axial_step=step, involute_step=fine, spacing="arc")
            yield Cause("axial step", f"{step:g} mm ({fine:g} mm along the involute), {text}", blocks)
    for decimals in sizes.decimals:
        yield Cause("decimals", f"{decimals} (mm and deg)", partial(plan.written, decimals))
    yield from _workshop(plan, sizes)


def _workshop(plan: _Planner, sizes: BudgetTable) -> Iterator[Cause]:
    """What machine, tool and set-up add."""
    radius, run, pivot, off = (
        1e-3 * e for e in (sizes.tool_radius_um, sizes.tool_runout_um, sizes.pivot_um, sizes.eccentricity_um)
    )
    yield Cause("tool radius", f"{sizes.tool_radius_um:+g} um", plan.one_space, Disturbance(tool_radius=radius))
    yield Cause("tool runout", f"{sizes.tool_runout_um:g} um off", plan.one_space, Disturbance(tool_runout=run))
    for axis, place in (("X", (pivot, 0.0, 0.0)), ("Z", (0.0, 0.0, pivot))):
        yield Cause("pivot offset", f"{sizes.pivot_um:+g} um in {axis}", plan.one_space, Disturbance(pivot=place))
    everywhere = plan.job.gear.count
    yield Cause(
        "mounting eccentricity", f"{sizes.eccentricity_um:g} um", lambda: plan.operation().blocks,
        Disturbance(eccentricity=off), everywhere,
    )  # fmt: skip


def _line(job: GearJob, cause: Cause, machine_for: MachineFor) -> BudgetLine:
    metrology = job.scene.metrology.model_copy(update={"spaces": cause.spaces})
    probed = replace(job, scene=job.scene.model_copy(update={"metrology": metrology}))
    tolerance = job.scene.simulation.compile_tolerance_mm
    cut = run_program(cause.blocks(), job.tools, cause.real, machine_for, tolerance)
    found = inspect(probed, cut, cause.name)
    normal = [np.concatenate([t[side].from_design_um.ravel() for t in (found.profile, found.helix)]) for side in SIDES]
    every = np.concatenate(normal)
    whole = cause.spaces == job.gear.count
    return BudgetLine(
        cause.name,
        cause.size,
        {row.parameter: _worst(list(row.value_um.values())) for row in found.rows()},
        largest_um=float(np.nanmax(np.abs(every))),
        mean_um=float(np.nanmean(every)),
        runout_um=found.runout.total if whole else None,
    )


def _worst(values: list[float]) -> float | None:
    known = [v for v in values if np.isfinite(v)]
    return max(known, key=abs) if known else None
