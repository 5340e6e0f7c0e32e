"""Operations from the blocks of a program: what each of its tools does relative to the part."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.geometry.rigid import Rigid
from gearsim.machines.errors import RealMachine
from gearsim.motion.program import ProgramMotion
from gearsim.motion.real_motion import RealMotion
from gearsim.motion.segments import compile_motion
from gearsim.motion.sources import MovedMotion
from gearsim.programs.blocks import Blocks
from gearsim.simulation.operation import Operation

_STILL = Rigid(np.eye(3), np.zeros(3))


def program_operations(
    blocks: Blocks, cutters: Mapping[int, Profile], tolerance: float, *, shift: Rigid = _STILL, text: str = "",
    headings: tuple[str, ...] = (), holders: Mapping[int, Profile] | None = None, real: RealMachine | None = None,
    chosen: NDArray[np.bool_] | None = None,
) -> tuple[Operation, ...]:  # fmt: skip
    """One operation a tool that the blocks move, in the order of their numbers; a row's step is its block.

    ``shift`` takes what is seen from the program's zero to the part's frame. ``headings`` are the names that
    the blocks' operations go by, ``holders`` what stands above the cutters. ``real`` is the machine that runs them
    where it is not the one they were made for. Blocks of other tools are left out, and those not ``chosen``.
    """
    found = []
    asked = np.ones(len(blocks), dtype=bool) if chosen is None else chosen
    for number in sorted(set(blocks.tool[asked].tolist()) & set(cutters)):
        cutter, program = cutters[number], ProgramMotion(blocks, asked & (blocks.tool == number))
        source = program if real is None else RealMotion(program, real)
        table = compile_motion(source, cutter.reach, tolerance).moved(shift)
        step = source.rows[table.piece]
        seconds = blocks.seconds[step] * source.share[table.piece] * (table.end - table.start)
        found.append(
            Operation(
                f"T{number}", cutter, (MovedMotion(source, shift),), table, blocks.rapid[step], step, blocks.line[step],
                blocks.operation[step], seconds, text=text, headings=headings, holder=(holders or {}).get(number),
            )
        )  # fmt: skip
    return tuple(found)
