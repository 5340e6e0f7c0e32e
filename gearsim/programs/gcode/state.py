"""The state of the modal language: what every block inherits from those before it."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.chain import Machine
from gearsim.programs.gcode.arc_rules import INCH
from gearsim.programs.gcode.block import Block
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.finish import to_slides, to_tips
from gearsim.programs.gcode.moves import Mode
from gearsim.programs.gcode.offsets import Offsets
from gearsim.programs.gcode.placing import Placing
from gearsim.programs.gcode.settings import ReadSettings

DEGREE = pi / 180.0


@dataclass
class State:
    """Modes, words and position in force.

    ``position`` (k) and ``shift`` (k) [mm, rad]: programmed values + ``shift`` = position; under tip control
    (``tip``) linear ones are the programmed tip in the workpiece frame. ``feed`` is the F word (None: none), its
    unit of length ``feed_scale`` [mm]: G20 and G21 leave the feed as fast as it was. ``has_units``: one of them
    has been read. ``column``: of each axis.
    """

    machine: Machine
    dialect: Dialect
    settings: ReadSettings
    offsets: Offsets = field(init=False)
    position: list[float] = field(init=False)
    shift: list[float] = field(init=False)
    motion: int | None = field(init=False)
    scale: float = field(init=False)
    feed_scale: float = field(init=False)
    column: dict[str, int] = field(init=False)
    placing: Placing = field(init=False)
    has_units: bool = False
    plane: int = 17
    absolute: bool = True
    arc_absolute: bool = False
    feed_mode: int = 94
    feed: float | None = None
    spindle: float = 0.0
    tip: bool = False
    tool: int = 0
    next_tool: int | None = None
    operation: int = 0

    def __post_init__(self) -> None:
        settings, machine = self.settings, self.machine
        self.offsets, self.placing = Offsets(machine, settings), Placing(settings, machine)
        begin = settings.home if settings.start is None else settings.start
        self.position = self.offsets.from_machine(settings.place(begin, machine, "start"))
        self.home = settings.place(settings.home, machine, "home")
        self.tool = settings.start_tool
        self.shift = self.offsets.shift()
        self.motion = self.dialect.start_motion
        self.scale = self.feed_scale = INCH if settings.units == "inch" else 1.0
        self.column = {name: i for i, name in enumerate(machine.axes)}
        self._rotary = [joint.is_rotary for joint in machine.joints]

    @property
    def mode(self) -> Mode:
        """What holds for the moves that follow."""
        return Mode(
            self.tip, self.offsets.excess if self.tip else 0.0, self.feed_mode, self.scale, self.feed_scale,
            self.spindle, self.plane, self.arc_absolute, self.tool, self.operation,
        )  # fmt: skip

    def factor(self, column: int) -> float:
        """What a number behind an axis letter is multiplied by, to be in mm or rad."""
        return DEGREE if self._rotary[column] else self.scale

    def stated(self, block: Block) -> dict[int, float]:
        """The axis words of a block by column [mm, rad]."""
        return {(i := self.column[letter]): word.value * self.factor(i) for letter, word in block.axes.items()}

    def target(self, stated: dict[int, float]) -> list[float]:
        """Where axis words lead, from the position in force."""
        target = self.position[:]
        for i, value in stated.items():
            target[i] = value + (self.shift[i] if self.absolute else target[i])
        return target

    def slides(self) -> NDArray[np.floating]:
        """The machine's axis values now, (k,)."""
        position = np.array(self.position)
        return to_slides(self.machine, position[None], self.offsets.excess)[0] if self.tip else position

    def refer(self) -> None:
        """Take account of changed offsets: the position stays, what is programmed for it changes."""
        self.shift = self.offsets.tip_shift() if self.tip else self.offsets.shift()

    def compensate(self, length: float, tip: bool) -> None:
        """Set the length that is compensated, and whether under tip control; the machine stands still."""
        values = self.slides()
        self.offsets.compensated, self.tip = length, tip
        self.position = (to_tips(self.machine, values[None], self.offsets.excess)[0] if tip else values).tolist()
        self.refer()
