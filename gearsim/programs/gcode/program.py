"""A program read: its blocks, and what it tells about itself."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.blocks import Blocks
from gearsim.programs.gcode.dialect import dialect_named
from gearsim.programs.gcode.reader import Reader
from gearsim.programs.gcode.settings import ReadSettings
from gearsim.programs.gcode.text import open_text
from gearsim.programs.names import distinct

_SETTINGS = ReadSettings()
_AXIS_LETTERS = tuple("ABCDUVWXYZ")


@dataclass(frozen=True)
class Program:
    """A program's ``blocks``; the names of its ``operations`` by their index in the blocks, no two alike, its ``tools``
    in order of use, its ``number`` (O word) and ``title``, and ``notes`` on what was passed over."""

    blocks: Blocks
    operations: tuple[str, ...]
    tools: tuple[int, ...]
    number: int | None
    title: str
    notes: tuple[str, ...]


def read_program(
    source: str | Path,
    machine: Machine,
    *,
    dialect: str = "fanuc",
    settings: ReadSettings = _SETTINGS,
    progress: Callable[[int], None] | None = None,
) -> Program:
    """Read a program, given as text or as a file, for a machine; ``progress`` is told of lines read.

    Rotary words are absolute degrees without rollover. Under G43.4 X, Y, Z state the tip on the workpiece, in its
    frame, whatever the rotary axes do. Seconds of feed blocks are 60 / F under G93; under G94 and G95 see
    ``Dialect.feed_of_all_axes``. G4 makes a block that stands; G28 one or two rapids; M6 a rapid where the new
    tool's length moves the tip. Reading ends at M2, M30 or the second %.
    Raises ProgramError, an InputError, naming line, column and word of the first thing it cannot use.
    """
    for axis in machine.axes:
        if axis not in _AXIS_LETTERS:
            raise InputError(f"machine {machine.name} cannot run a program: axis {axis} has no letter")
    reader = Reader(open_text(source), machine, dialect_named(dialect), settings, progress)
    blocks, journal = reader.read()
    return Program(
        blocks, distinct(journal.operations), tuple(journal.tools), journal.number, journal.title, journal.notes()
    )
