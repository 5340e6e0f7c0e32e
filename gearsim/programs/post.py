"""The post-processor: operations written as a program in the Fanuc dialect, for any five-axis machine.

X, Y, Z state the linear axes against the work offset (G43), or the tip on the workpiece under tip control
(G43.4); rotary axes are absolute degrees, never wrapped: a jump of 360 deg would spin the table within a block.
Every operation starts from the Z reference position: rotary axes, then X and Y, then Z with the tool's length.
What the thesis's own post does otherwise is in the errata of Groover 2018, part C.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Sequence
from textwrap import wrap

import numpy as np

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.operation import Operation, Tool
from gearsim.programs.post_options import Clamp, Header, PostOptions
from gearsim.programs.post_words import Words, joined

_UNWRITABLE = re.compile(r"[^A-Z0-9 .,:/+\-=_#*\[\]'<>]")
_HOME_Z = "G91 G28 Z0"
_COMMENT = 72  # characters in a line of comment
_DEFAULT_OPTIONS = PostOptions()


def write_program(operations: Sequence[Operation], header: Header, options: PostOptions = _DEFAULT_OPTIONS) -> str:
    """The program of some operations, as text.

    Raises InputError where the machine's axes have no letters of a program, operations are for different
    machines, tools share a number, or a block cannot be stated (see ``Words``).
    """
    machine, tools = _machine(operations), _tools(operations)
    lines = ["%", *_head(header, machine, tools, options), "G21 G17 G40 G49 G90 G94"]
    tool = None
    for i, operation in enumerate(operations):
        lines += _operation(operation, (i + 1) * options.number_step, operation.tool.number != tool, options)
        tool = operation.tool.number
    clamps = _clamps(machine, options)
    return "\n".join([*lines, _HOME_Z, "G91 G28 X0 Y0", "G90 G49", *(f"M{c.clamp}" for c in clamps), "M30", "%", ""])


def comment(text: str) -> str:
    """A comment as controls take it: upper case ASCII, square brackets for round ones, which must not nest."""
    plain = unicodedata.normalize("NFKD", text.replace("°", " deg")).encode("ascii", "ignore").decode().upper()
    return f"({_UNWRITABLE.sub(' ', plain.replace('(', '[').replace(')', ']'))})"


def _head(header: Header, machine: Machine, tools: Sequence[Tool], options: PostOptions) -> list[str]:
    control = "INVERSE TIME [G93]" if options.feed_mode == "inverse-time" else "PER MINUTE [G94]"
    told = [
        *header.lines,
        f"machine {machine.name}, axes {' '.join(machine.axes)}",
        f"work offset {options.work_offset}, millimetres, degrees, feed {control}",
        *(
            f"T{tool.number} D{tool.diameter:g} {tool.flutes} flutes, flute length {tool.flute_length:g}: {tool.name}"
            for tool in tools
        ),
    ]
    title = f" {comment(header.title)}" if header.title else ""
    return [f"O{header.number:04d}{title}", *_comments(told)]


def _comments(texts: Iterable[str]) -> list[str]:
    """A comment for every text, long ones in several lines."""
    return [comment(line) for text in texts for line in wrap(text, _COMMENT)]


def _operation(operation: Operation, number: int, change: bool, options: PostOptions) -> list[str]:
    """An operation from the Z reference position to the end of its motion, spindle and coolant off."""
    words = Words(operation.blocks, options, operation.name)
    machine, tool = operation.blocks.machine, operation.tool
    clamps = _clamps(machine, options)
    return [
        f"N{number} {comment(operation.name)}",
        *_comments(operation.comments),
        _HOME_Z,
        *([f"T{tool.number} M06"] if change else []),
        f"G90 G94 G49 {options.work_offset}",
        f"S{round(operation.spindle)} M03",
        *(["M08"] if operation.coolant else []),
        *(f"M{c.release}" for c in clamps),
        *_approach(words, tool, [f"M{c.clamp}" for c in clamps if _stands(words, c)]),
        *words.lines,
        *(["M09"] if operation.coolant else []),
        "M05",
        *(["G49"] if words.held else []),
    ]


def _approach(words: Words, tool: Tool, clamping: list[str]) -> list[str]:
    """From the Z reference position to the start: rotary axes, X and Y, then Z along with the tool's length.

    Under tip control X and Y stand already right when it is switched on, so that the tip's straight way to the
    stated position is one along the machine's Z.
    """
    axes, decimals, start = words.blocks.machine.axes, words.decimals, words.stated[0]
    slides = np.rint(words.blocks.start[:3] * words.scale[:3]) + 0.0
    length = f"G43.4 H{tool.number} " if words.held else f"G43 H{tool.number} "
    first = 0 if words.held else 2
    return [
        "G00 " + joined(axes[3:], start[3:], decimals[3:]),
        *clamping,
        "G00 " + joined(axes[:2], slides[:2], decimals[:2]),
        length + joined(axes[first:3], start[first:3], decimals[first:3]),
    ]


def _stands(words: Words, clamp: Clamp) -> bool:
    """Whether an axis keeps still throughout an operation."""
    column = words.stated[:, words.blocks.machine.axes.index(clamp.axis)]
    return bool((column == column[0]).all())


def _clamps(machine: Machine, options: PostOptions) -> list[Clamp]:
    return [c for c in options.clamps if c.axis in machine.axes]


def _machine(operations: Sequence[Operation]) -> Machine:
    """The machine all operations are for."""
    if not operations:
        raise InputError("a program needs at least one operation")
    machine = operations[0].blocks.machine
    if machine.axes[:3] != ("X", "Y", "Z") or not set(machine.axes[3:]) <= set("ABC"):
        raise InputError(
            f"machine {machine.name} has the axes {', '.join(machine.axes)}; a program needs X, Y, Z and rotary "
            "axes among A, B, C"
        )
    other = next((o.blocks.machine for o in operations if o.blocks.machine.axes != machine.axes), machine)
    if other.axes != machine.axes:
        raise InputError(f"operations for machines {machine.name} and {other.name} cannot share a program")
    return machine


def _tools(operations: Sequence[Operation]) -> list[Tool]:
    """The tools in their order of use."""
    tools: dict[int, Tool] = {}
    for operation in operations:
        tool = operation.tool
        if not 1 <= tool.number <= 9999:
            raise InputError(f"tool {tool.name!r}: T{tool.number} is no place in a magazine; expected 1 to 9999")
        if tools.setdefault(tool.number, tool) != tool:
            raise InputError(f"T{tool.number} is both {tools[tool.number].name!r} and {tool.name!r}")
    return list(tools.values())
