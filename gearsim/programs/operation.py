"""An operation: what one tool does in one part of a program, and under which cutting conditions."""

from __future__ import annotations

from dataclasses import dataclass

from gearsim.programs.blocks import Blocks


@dataclass(frozen=True)
class Tool:
    """An entry of the tool table: a cylindrical end mill.

    ``diameter`` and ``flute_length`` in mm; ``number`` is its place (T, and H of its length offset).
    """

    number: int
    name: str
    diameter: float
    flute_length: float
    flutes: int


@dataclass(frozen=True)
class Operation:
    """``blocks`` run with one tool at one spindle speed [1/min]; ``comments`` are told in the program."""

    name: str
    tool: Tool
    spindle: float
    blocks: Blocks
    coolant: bool = True
    comments: tuple[str, ...] = ()
