"""The path of a flank-milled tooth as a program for a five-axis machine.

The gear lies on its back: the program's frame has the gear frame's x, and its y and z turned over, so that the
teeth look up to the spindle. Its origin is that of the gear frame, the apex of the pitch cone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import count, groupby, pairwise

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.processes.frames import CLAMPED
from gearsim.programs.cldata import RAPID, CLProgram, apt_parameters
from gearsim.programs.gcode import read_program
from gearsim.programs.operation import Operation, Tool
from gearsim.programs.path_blocks import blocks_from_cl
from gearsim.programs.post import write_program
from gearsim.programs.post_options import Header
from gearsim.scene import FlankMillingScene
from gearsim.scene.program import ControlTable, ProgramTable
from gearsim.simulation.operation import Operation as Machined
from gearsim.simulation.program import program_operations

MOST_TOOLS = 9999  # the largest T number


def machine_program(scene: FlankMillingScene, table: ProgramTable, cl: CLProgram, cutters: Sequence[Profile]) -> str:
    """The CL program, gear frame, as text for the table's machine, an operation whenever the tool changes.

    ``cutters`` are those of the program's tools, of which neither tip nor top exceeds the feed. Raises InputError where
    the CL data states no feed, or the machine or its control cannot do it.
    """
    if cl.feed is None:
        raise InputError("the CL data has no FEDRAT; a program for a machine needs a feed")
    paths = (replace(p, tips=CLAMPED.point(p.tips), axes=CLAMPED.direction(p.axes)) for p in cl.paths)
    numbers = _numbers(cl)
    operations = []
    for k, run in groupby(paths, key=lambda path: path.tool):
        program = replace(cl, paths=tuple(run))
        feed = min((p.feed for p in program.paths if p.feed is not None), default=cl.feed)
        blocks = blocks_from_cl(table.controlled(), program, feed, table.tip_control, reach=cutters[k].height)
        sizes = apt_parameters(cutters[k])
        shape = ", ".join(f"{value:.6g}" for value in sizes)
        tool = Tool(numbers[k], f"APT cutter {shape}", sizes[0], cutters[k].height, table.flutes)
        passes = ", ".join(p.name for p in program.paths if p.name != RAPID)
        operations.append(
            Operation(
                "flank milling", tool, table.spindle_rpm, blocks, comments=(f"passes {passes}",) if passes else ()
            )
        )
    lines = (scene.scene.summary, "gear on its back: x, -y, -z of the gear frame, origin at the pitch apex")
    header = Header(table.number, scene.name, tuple(line for line in lines if line))
    return write_program(operations, header, table.options())


def run_operations(
    scene: FlankMillingScene, cl: CLProgram, cutters: Sequence[Profile], holders: Sequence[Profile | None], text: str
) -> tuple[Machined, ...] | None:
    """What the scene's machine does with its program's ``text``, read back, gear frame; None where CL data is judged.

    ``cutters``, with their errors, and ``holders`` are those of the CL program's tools.
    """
    real, table = scene.faulty(), scene.program
    if table is None or not scene.runs_program:
        return None
    nominal = table.controlled()
    numbers, frame, off = _numbers(cl), CLAMPED.inverse(), scene.errors.mounting
    if off is not None:
        frame = Rigid(off.rotation @ frame.rotation, off.point(frame.translation))
    program = read_program(
        text, nominal, settings=ControlTable().settings(table.work_offset, numbers, nominal)
    )  # fmt: skip
    above = {number: body for number, body in zip(numbers, holders, strict=True) if body is not None}
    return program_operations(
        program.blocks, dict(zip(numbers, cutters, strict=True)), scene.simulation.compile_tolerance_mm,
        shift=frame, text=text, headings=program.operations, holders=above, real=real,
    )  # fmt: skip


def operation_of(cl: CLProgram, path: int) -> int:
    """Which operation of the machine's program, one a tool change, one of the CL program's paths belongs to."""
    return sum(a.tool != b.tool for a, b in pairwise(cl.paths[: path + 1]))


def _numbers(cl: CLProgram) -> list[int]:
    """A T number for each tool: 1 of a single one, else the file's, else the next that is free."""
    if len(cl.tools) == 1:
        return [1]
    given = [int(t.number) if t.number.isdecimal() and 0 < int(t.number) <= MOST_TOOLS else 0 for t in cl.tools]
    free = (n for n in count(1) if n not in given)
    return [number or next(free) for number in given]
