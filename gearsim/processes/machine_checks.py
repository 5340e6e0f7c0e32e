"""What a scene's machine adds to its job: whether tools touch its bodies, and whether its axes can do the program."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.machines.chain import AT_REST, Machine
from gearsim.machines.path import axis_values
from gearsim.metrology.axis_check import AxisInspection
from gearsim.metrology.body_check import FIXTURE, NOSE, TABLE, BodyInspection
from gearsim.metrology.job import Job
from gearsim.metrology.stock_check import StockInspection
from gearsim.motion.axes import AxisMotion
from gearsim.motion.program import ProgramMotion
from gearsim.motion.real_motion import RealMotion
from gearsim.motion.sources import CLMotion, MotionSource, MovedMotion
from gearsim.processes.frames import CLAMPED
from gearsim.programs.blocks import Blocks
from gearsim.programs.gcode import read_program
from gearsim.scene import FlankMillingScene
from gearsim.simulation.operation import Operation

if TYPE_CHECKING:
    from gearsim.scene import CylindricalGearScene, ProgramScene, SequenceScene
    from gearsim.scene.catalogue import RunMachineTable

    MachineScene = FlankMillingScene | ProgramScene | CylindricalGearScene | SequenceScene

_PROGRAM = "program.nc"
_HOME = re.compile(r"G\s*(28|30)(?![\d.])")


class _Run(NamedTuple):
    """A program as a machine runs it: its blocks, what their operations are called, which of them go home."""

    blocks: Blocks
    names: tuple[str, ...]
    homing: NDArray[np.bool_] | None = None


def with_machine(job: Job, scene: MachineScene) -> Job:
    """The job with what a machine that runs the scene's program must not touch, and cannot do.

    Raises InputError where the machine cannot run it.
    """
    table = _machine(scene)
    frame = CLAMPED if isinstance(scene, FlankMillingScene) else _frame(job)
    copies = next((i.copies for i in job.inspections if isinstance(i, StockInspection)), 1)
    given = {} if table is None else table.bodies()
    bodies = tuple((name, solid) for name, solids in given.items() for solid in solids)
    missing = tuple(name for name in (TABLE, FIXTURE) if name not in given)
    missing += () if table is not None and table.spindle_nose_mm else (NOSE,)
    touched = BodyInspection(job.main, bodies, frame, copies, missing)
    return replace(job, inspections=(*job.inspections, touched, _axes(job, table, frame)))


def _machine(scene: MachineScene) -> RunMachineTable | None:
    if isinstance(scene, FlankMillingScene):
        return None if scene.program is None else scene.program.machine
    found: RunMachineTable | None = scene.machine
    return found


def _axes(job: Job, table: RunMachineTable | None, frame: Rigid) -> AxisInspection:
    if table is None:
        return AxisInspection(job.main, None, frame)
    machine = table.build()
    run = _run(job, machine)
    feed, rapid = table.speeds(machine)
    return AxisInspection(job.main, run.blocks, frame, run.names, feed, rapid, run.homing)


def _run(job: Job, machine: Machine) -> _Run:
    operations = job.variant(job.main).operations
    source = _bare(operations[0].sources[0])
    if isinstance(source, ProgramMotion):
        return _Run(source.blocks, operations[0].headings, _homing(source.blocks, operations[0].text))
    if isinstance(source, AxisMotion):
        return _Run(_linear(operations[0], source), ())
    if _PROGRAM in job.files:
        program = read_program(job.files[_PROGRAM], machine)
        return _Run(program.blocks, program.operations, _homing(program.blocks, job.files[_PROGRAM]))
    return _Run(_along(operations, machine), tuple(o.name for o in operations))


def _homing(blocks: Blocks, text: str) -> NDArray[np.bool_]:
    """The blocks of lines with G28 or G30, which go where the machine's reference points are."""
    lines = [False, *(_HOME.search(line.upper()) is not None for line in text.splitlines())]
    found: NDArray[np.bool_] = np.array(lines)[np.where(blocks.line < len(lines), blocks.line, 0)]
    return found


def _frame(job: Job) -> Rigid:
    """From the frame of a program's motions to the part's."""
    source = job.variant(job.main).operations[0].sources[0]
    return source.rigid if isinstance(source, MovedMotion) else AT_REST


def _bare(source: MotionSource) -> MotionSource:
    """A motion as its program has it: neither moved nor with a machine's errors."""
    while isinstance(source, MovedMotion | RealMotion):
        source = source.source if isinstance(source, MovedMotion) else source.program
    return source


def _linear(operation: Operation, source: AxisMotion) -> Blocks:
    """A table of axis values as blocks, whose times are not known."""
    lines = np.zeros(source.pieces, dtype=int)
    lines[operation.table.piece] = operation.line
    n = source.pieces
    return _blocks(source.machine, source.values, np.zeros(n, bool), lines, np.zeros(n, int), np.full(n, np.nan), False)


def _along(operations: tuple[Operation, ...], machine: Machine) -> Blocks:
    """CL data as the machine runs it with tip control, all moves in the program's order; from one to the next by rapid.

    Raises InputError for poses that are out of the machine's reach, and motions that are no CL data.
    """
    moves = sorted(
        (int(o.step[o.table.path == path][0]), k, int(path))
        for k, o in enumerate(operations)
        for path in np.unique(o.table.path)
    )
    parts = [_points(operations[k], path, k) for _, k, path in moves]
    tips, axes, rapid, line, owner, seconds = (np.concatenate(column) for column in zip(*parts, strict=True))
    values = axis_values(machine, tips, axes).values
    return _blocks(machine, values, rapid[1:], line[1:], owner[1:], seconds[1:], True)


def _points(o: Operation, path: int, number: int) -> tuple[NDArray, ...]:
    """Tips, axes, and of the way to each point whether it is by rapid, its line, the operation's number, its time."""
    source = _bare(o.sources[path])
    if not isinstance(source, CLMotion):
        raise InputError(f"machine: operation {o.name} is no CL data that a machine could run; remove the table")
    n, row = source.pieces + 1, np.flatnonzero(o.table.path == path)
    to = o.table.piece[row] + 1
    rapid, line = np.ones(n, dtype=bool), np.full(n, int(o.line[row[0]]))
    rapid[to], line[to] = o.rapid[row], o.line[row]
    seconds = np.bincount(to, o.seconds[row], minlength=n)
    return source.tips, source.axes, rapid, line, np.full(n, number), seconds


def _blocks(
    machine: Machine, values: NDArray, rapid: NDArray, line: NDArray, owner: NDArray, seconds: NDArray, tip: bool
) -> Blocks:
    n = len(values) - 1
    return Blocks(
        machine, values[0], values[1:], rapid, np.full(n, tip), seconds, line, np.zeros(n, dtype=int), owner,
        np.zeros(n), np.zeros((n, 3)), np.full(n, 2),
    )  # fmt: skip
