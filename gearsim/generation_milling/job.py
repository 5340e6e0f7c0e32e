"""A gear to be milled by generation, planned and posted: what will be cut is what its program says."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError, read_input
from gearsim.generation_milling.disturbance import Disturbance
from gearsim.generation_milling.probing import Probing, probing
from gearsim.machines.chain import Machine
from gearsim.metrology.gear_inspection import gear_size
from gearsim.programs.gcode import Program, ReadSettings, read_program
from gearsim.programs.operation import Operation, Tool
from gearsim.programs.post import write_program
from gearsim.programs.post_options import Header, PostOptions
from gearsim.scene.generation_milling import ErrorsTable, GenerationMillingScene
from gearsim.surfaces.cylindrical_gear import SIDES, CylindricalGear, Side
from gearsim.toolpaths.cylindrical.feed import fastest_axis
from gearsim.toolpaths.cylindrical.limits import reached_range
from gearsim.toolpaths.cylindrical.plan import plan_gear
from gearsim.toolpaths.cylindrical.settings import Finishing, Settings

_HEIGHTS = 41
_PASSES_BY = 200


@dataclass(frozen=True)
class GearJob:
    """A scene made ready: ``steps`` are what the operations were told, finishing last.

    ``operations`` is empty where the program came from a file; ``text`` is the program and ``program`` what reading
    it gives. ``reached``: the rolls [rad], at the root and at the tip, between which finishing reaches each side's
    flanks over the whole facewidth.
    """

    scene: GenerationMillingScene
    gear: CylindricalGear
    machine: Machine
    steps: tuple[Settings, ...]
    operations: tuple[Operation, ...]
    text: str
    program: Program
    reached: dict[Side, tuple[float, float]]

    @property
    def finishing(self) -> Finishing:
        """What the last operation is told."""
        return self.scene.finishing()

    @property
    def spaces(self) -> tuple[int, ...]:
        """The spaces that are probed."""
        return tuple(range(self.scene.metrology.spaces or self.gear.count))

    @cached_property
    def tools(self) -> dict[int, Tool]:
        """The tools by their numbers."""
        return {t.number: t.build() for t in self.scene.tools}

    @cached_property
    def probing(self) -> dict[Side, Probing]:
        """Lines on the flanks of both sides."""
        return {side: probing(self.gear, side, self.reached[side], self.scene.metrology.points) for side in SIDES}

    def ray_count(self) -> int:
        """Rays the run will cut, about; those of the budget, the section and the tri-dexel left out."""
        m = self.scene.metrology
        return 2 * (len(self.spaces) * (6 * m.points + 1) + 2 * m.rows * m.columns)

    def segment_count(self) -> int:
        """Rows of the program's table, about: one or two a block."""
        return len(self.program.blocks)

    def envelope_samples(self) -> int:
        """Samples the envelope road will solve for."""
        return 2 * self.scene.metrology.rows * self.scene.metrology.columns

    def ring_pairs(self) -> int:
        """Pairs that no culling spares: every pass at a lower height goes by the rays above it."""
        return _PASSES_BY * self.ray_count()


def plan(scene: GenerationMillingScene, folder: Path) -> GearJob:
    """Plan and post a scene's gear and read the program back; or read the user's own, relative to ``folder``.

    Raises InputError where the gear cannot be cut this way or has no tolerances, or for a program that cannot be read
    or moves without a tool of the scene, a length or an offset that is known (``ReadSettings.tools``).
    """
    gear, machine, steps = scene.gear(), scene.controller(), scene.paths()
    gear_size(gear)
    operations: tuple[Operation, ...] = ()
    settings = ReadSettings(workpiece=scene.program.work_offset, tools=tuple(t.number for t in scene.tools))
    if scene.program.file:
        file = folder / scene.program.file
        text = read_input(file, "program")
        program = read_program(file, machine, dialect=scene.program.dialect, settings=settings)
    else:
        exact = planned(gear, machine, steps, scene.program.tip_control)
        options = scene.program.options()
        operations = tuple(as_printed(op, options, step.cutting.feed) for op, step in zip(exact, steps, strict=True))
        text = write_program(operations, _header(scene, gear), options)
        program = read_program(text, machine, settings=settings)
    job = GearJob(scene, gear, machine, steps, operations, text, program, {})
    if not set(np.unique(program.blocks.tool).tolist()) & set(job.tools):
        tools = ", ".join(f"T{number} M06" for number in sorted(job.tools))
        raise InputError(f"program: it moves none of the scene's tools; expected {tools} and moves behind it")
    finishing = job.finishing
    return replace(job, reached={s: _reached(gear, s, finishing) for s in SIDES})


def planned(
    gear: CylindricalGear, machine: Machine, steps: tuple[Settings, ...], tip_control: bool
) -> tuple[Operation, ...]:
    """The operations, their blocks run with or without tool-centre-point control."""
    operations = plan_gear(gear, machine, steps)
    if not tip_control:
        return operations
    return tuple(with_tip_control(op) for op in operations)


def with_tip_control(operation: Operation) -> Operation:
    """The same blocks, the tip straight on the workpiece between their ends."""
    blocks = operation.blocks
    return replace(operation, blocks=replace(blocks, tip_control=np.ones(len(blocks), dtype=bool)))


def as_printed(operation: Operation, options: PostOptions, feed: float) -> Operation:
    """The operation with its numbers rounded as a program prints them, and slowed down where that lengthens a block."""
    blocks = operation.blocks
    slides = sum(not joint.is_rotary for joint in blocks.machine.joints)

    def rounded(values: NDArray) -> NDArray:
        out = np.round(values, options.linear_decimals)
        out[..., slides:] = np.radians(np.round(np.degrees(values[..., slides:]), options.rotary_decimals))
        return out

    printed = replace(blocks, start=rounded(blocks.start), values=rounded(blocks.values))
    way = fastest_axis(blocks.machine, printed.before, printed.values - printed.before)
    straight = ~blocks.rapid & (blocks.sweep == 0.0)
    seconds = np.where(straight, np.maximum(blocks.seconds, 60.0 * way / feed), blocks.seconds)
    return replace(operation, blocks=replace(printed, seconds=seconds))


def posted(operations: tuple[Operation, ...], machine: Machine, decimals: int) -> Program:
    """Operations written with so many decimals and read back."""
    options = PostOptions(linear_decimals=decimals, rotary_decimals=decimals)
    tools = tuple({operation.tool.number for operation in operations})
    return read_program(write_program(operations, Header(), options), machine, settings=ReadSettings(tools=tools))


def disturbance(errors: ErrorsTable) -> Disturbance:
    """The scene's errors in mm."""
    x, y, z = (1e-3 * e for e in errors.pivot_um)
    return Disturbance(
        1e-3 * errors.tool_radius_um, 1e-3 * errors.tool_runout_um, (x, y, z), 1e-3 * errors.eccentricity_um
    )  # fmt: skip


def _reached(gear: CylindricalGear, side: Side, finishing: Finishing) -> tuple[float, float]:
    """Rolls at the root and the tip end of what finishing reaches at every height of a flank.

    Raises InputError where no part is reached over the whole facewidth.
    """
    heights = np.linspace(-gear.facewidth, 0.0, _HEIGHTS)
    low, high = reached_range(gear, side, heights, finishing.cutting.radius, finishing.axial_step)
    first, last = float(np.max(low)), float(np.min(high))
    if not first < last:
        raise InputError(
            f"the tool of {finishing.cutting.tool.diameter:g} mm reaches no part of the {side} flank over the whole "
            "facewidth; take a thinner one or a narrower gear"
        )
    return (last, first) if gear.is_internal else (first, last)


def _header(scene: GenerationMillingScene, gear: CylindricalGear) -> Header:
    kind = "internal" if gear.is_internal else "external"
    return Header(
        scene.program.number,
        scene.name,
        (
            f"{kind} gear, {gear.count} teeth, normal module {gear.module:.6g}, normal pressure angle "
            f"{np.degrees(gear.pressure_angle):.6g} deg, helix angle {np.degrees(gear.helix_angle):.6g} deg",
            f"facewidth {gear.facewidth:g}, tip radius {gear.tip_radius:.4f}, root radius {gear.root_radius:.4f}",
            "z = 0 at the top face, space 1 on +X",
        ),
    )
