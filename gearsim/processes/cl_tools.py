"""The tools of a CL file as cutters, and its paths as operations of one tool each."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.motion.segments import SegmentTable
from gearsim.motion.sources import MotionSource
from gearsim.programs.cldata import RAPID, CLProgram, CLTool, check_cutter, cutter_of, is_apt, sizes_of
from gearsim.simulation.operation import Operation, operation
from gearsim.toolpaths.links import APPROACH, WITHDRAWAL

LINKS = (APPROACH, WITHDRAWAL)
_NUMBERS = re.compile(r"(-\d+)?(\.\d+)?$")  # of a pass among its like, and of the space it cuts


def cl_cutters(
    program: CLProgram, file: str, one: Profile | None = None, named: Mapping[int, Profile] | None = None
) -> tuple[tuple[Profile, ...], tuple[str, ...]]:
    """The cutter of each of a program's tools, and what a reader must be told of them.

    ``one`` is a scene's [cutter], ``named`` are its [[tools]] by their numbers. A single tool is the scene's [cutter],
    or its only one where it has no number; of several each is that of its number, or the scene's cutter of its sizes,
    or the one that CUTTER states. Raises InputError naming ``file`` and line for a tool that is none of these, or
    another than the scene's of its number.
    """
    named = named or {}
    if len(named) == 1 and not program.tools[0].number:
        (one,) = named.values()
    if one is not None and len(program.tools) == 1:
        return (one,), check_cutter(program.tools[0].sizes, one, file)
    found = [_cutter(tool, file, one, named) for tool in program.tools]
    return tuple(cutter for cutter, _ in found), tuple(note for _, notes in found for note in notes)


def _cutter(
    tool: CLTool, file: str, one: Profile | None, named: Mapping[int, Profile]
) -> tuple[Profile, tuple[str, ...]]:
    number = int(tool.number) if tool.number.isdecimal() else 0
    if number in named:
        return named[number], check_cutter(tool.sizes, named[number], file, f"tool {number}")
    where = f"{file}, line {tool.line}: {tool}" if tool.line else f"{file}: its tool"
    if tool.sizes is None:
        there = f"tools has {', '.join(map(str, sorted(named)))}" if named else "no CUTTER states its sizes"
        raise InputError(
            f"{where} is not known: {there}; give it seven numbers by CUTTER, or an entry of [[tools]] in a scene of "
            'toolpath.kind = "program"'
        )
    ours = (cutter for cutter in (*named.values(), *([one] if one else [])) if is_apt(cutter))
    alike = [cutter for cutter in ours if not tool.sizes.differs(sizes_of(cutter))]
    if alike:
        return alike[0], check_cutter(tool.sizes, alike[0], file)
    try:
        return cutter_of(tool.sizes), (f"{tool} (line {tool.line}) is cut as CUTTER states it, to its printed digits",)
    except InputError as error:
        raise InputError(f"{where} is none of the scene's: {error}") from error


def cl_operations(
    program: CLProgram, cutters: Sequence[Profile], sources: Sequence[MotionSource], tolerance: float,
    holders: Sequence[Profile | None], tables: Sequence[SegmentTable] = (),
) -> tuple[Operation, ...]:  # fmt: skip
    """An operation a tool, in the order of their first moves; ``sources`` are the program's paths, steps as well.

    ``holders`` stand above the cutters; ``tables``: what the sources are compiled to, where that is known.
    """
    made = []
    for k, (tool, cutter, holder) in enumerate(zip(program.tools, cutters, holders, strict=True)):
        mine = [i for i, path in enumerate(program.paths) if path.tool == k]
        if mine:
            rapid = [program.paths[i].name == RAPID for i in mine]
            name = "CL data" if len(program.tools) == 1 else str(tool)
            lines = [program.paths[i].lines or [0] * len(program.paths[i].tips) for i in mine]
            seconds = [program.paths[i].seconds or [nan] * len(program.paths[i].tips) for i in mine]
            alone = operation(
                name, cutter, [sources[i] for i in mine], tolerance, rapid=rapid, holder=holder, lines=lines,
                seconds=seconds, tables=[tables[i] for i in mine] if tables else (),
            )  # fmt: skip
            headings, section = _headings([program.paths[i].name for i in mine])
            columns: dict[str, Any] = {"step": np.array(mine)[alone.step], "section": section[alone.step]}
            made.append(replace(alone, headings=headings, **columns))
    return tuple(made)


def _headings(passes: Sequence[str]) -> tuple[tuple[str, ...], NDArray[np.integer]]:
    """What a program's passes are called without their numbers, and of each pass under which of these it stands.

    Moves to a pass stand under the next one's, the last away under the last one's.
    """
    named = [None if name in (RAPID, *LINKS) else _NUMBERS.sub("", name) for name in passes]
    headings = tuple(dict.fromkeys(name for name in named if name is not None))
    section, following = np.zeros(len(named), dtype=int), len(headings) - 1
    for i in reversed(range(len(named))):
        name = named[i]
        following = following if name is None else headings.index(name)
        section[i] = following
    return headings, section
