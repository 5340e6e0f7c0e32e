"""The causes of a cylindrical gear's error budget: space 0 planned again and again, one cause of deviations alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.machines.chain import Machine
from gearsim.metrology.gear_budget import BudgetInspection
from gearsim.metrology.gear_iso import GearProbing, ProbedGear
from gearsim.metrology.study import Change
from gearsim.programs.blocks import Blocks
from gearsim.programs.operation import Operation, Tool
from gearsim.scene.cylindrical import BudgetTable, CylindricalGearScene
from gearsim.simulation.disturbance import Disturbance
from gearsim.simulation.operation import Operation as Machined
from gearsim.simulation.operation import Variant
from gearsim.simulation.program import program_operations
from gearsim.toolpaths.cylindrical.posting import planned, posted
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

    scene: CylindricalGearScene
    probed: ProbedGear
    machine: Machine

    def operation(self, tip_control: bool = False, **changes: float | str) -> Operation:
        finishing = replace(self.scene.finishing(), **changes)  # type: ignore[arg-type]
        assert isinstance(finishing, Finishing)
        return planned(self.probed.gear, self.machine, (finishing,), tip_control)[0]

    def one_space(self, tip_control: bool = False, **changes: float | str) -> Blocks:
        return first_space(self.operation(tip_control, **changes), self.probed.gear.count).blocks

    def written(self, decimals: int) -> Blocks:
        operation = first_space(self.operation(), self.probed.gear.count)
        return posted((operation,), self.machine, decimals).blocks


def first_space(operation: Operation, spaces: int) -> Operation:
    """An operation that repeats in every space, in the first one only."""
    blocks = operation.blocks
    own = slice(0, (len(blocks) + 1) // spaces - 1)  # the last block of a space leads to the next
    columns = ("values", "rapid", "tip_control", "seconds", "line", "tool", "operation", "sweep", "centre", "normal")
    return replace(operation, blocks=replace(blocks, **{name: getattr(blocks, name)[own] for name in columns}))


def gear_budget(
    scene: CylindricalGearScene, probed: ProbedGear, machine: Machine, tools: dict[int, Tool], program: str
) -> tuple[list[Variant], BudgetInspection]:
    """A variant a cause, and the inspection that probes them all; ``program`` names the job's own."""
    assert scene.budget is not None
    m, tolerance = scene.metrology, scene.simulation.compile_tolerance_mm
    variants: list[Variant] = []
    seen_in: dict[int, list[Change]] = {1: [], probed.gear.count: []}
    for cause in causes(_Planner(scene, probed, machine), scene.budget):
        name = f"budget: {cause.name}, {cause.size}"
        operations = disturbed_operations(cause.blocks(), tools, cause.real, tolerance)
        variants.append(Variant(name, f"space 0 alone: {cause.name}, {cause.size}", operations))
        seen_in[cause.spaces].append(Change(cause.name, cause.size, {program: name}))
    probing = GearProbing(program, probed, (0,), m.points, m.iso_class, scene.name)
    one, everywhere = map(tuple, seen_in.values())
    return variants, BudgetInspection(probing, one, everywhere)


def disturbed_operations(
    blocks: Blocks, tools: dict[int, Tool], real: Disturbance, tolerance: float, text: str = "",
    headings: tuple[str, ...] = (), holders: Mapping[int, Profile] | None = None,
    chosen: NDArray[np.bool_] | None = None,
) -> tuple[Machined, ...]:  # fmt: skip
    """A program's operations as a disturbed machine runs them, relative to the gear; of the ``chosen`` blocks."""
    cutters = {number: real.cutter(tool) for number, tool in tools.items() if number in set(blocks.tool.tolist())}
    return program_operations(
        blocks, cutters, tolerance, shift=real.mounting, text=text, headings=headings, holders=holders,
        real=real.machine(blocks.machine), chosen=chosen,
    )  # fmt: skip


def causes(plan: _Planner, sizes: BudgetTable) -> Iterator[Cause]:
    """The causes, from what the method itself costs to what a workshop adds."""
    exact, every = "exact numbers, all axes linear", plan.one_space
    yield Cause("none", exact, every)
    for step in sizes.involute_steps_mm:
        for tip in (False, True):
            text = "tool-centre-point control" if tip else "all axes linear"
            blocks = partial(plan.one_space, tip, involute_step=step, spacing="arc")
            yield Cause("involute step", f"{step:g} mm, {text}", blocks)
    fine = min(sizes.involute_steps_mm, default=plan.scene.finishing().involute_step)
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
    everywhere = plan.probed.gear.count
    yield Cause(
        "mounting eccentricity", f"{sizes.eccentricity_um:g} um", lambda: plan.operation().blocks,
        Disturbance(eccentricity=off), everywhere,
    )  # fmt: skip
