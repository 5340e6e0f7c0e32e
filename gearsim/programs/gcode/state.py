"""The state of the modal language: what every block inherits from those before it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.chain import Machine
from gearsim.programs.gcode.dialect import Dialect
from gearsim.programs.gcode.finish import to_slides, to_tips
from gearsim.programs.gcode.moves import Mode
from gearsim.programs.gcode.offsets import Offsets
from gearsim.programs.gcode.settings import ReadSettings

INCH = 25.4


@dataclass
class State:
    """Modes, words and position in force.

    ``position`` (k) and ``shift`` (k) [mm, rad]: programmed values + ``shift`` = position; under tip control
    (``tip``) linear ones are the programmed tip in the workpiece frame. ``feed`` is the F word (None: none).
    """

    machine: Machine
    dialect: Dialect
    settings: ReadSettings
    offsets: Offsets = field(init=False)
    position: list[float] = field(init=False)
    shift: list[float] = field(init=False)
    motion: int | None = field(init=False)
    scale: float = field(init=False)
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
        self.offsets = Offsets(machine, settings)
        begin = settings.home if settings.start is None else settings.start
        self.position = self.offsets.from_machine(settings.place(begin, machine, "start"))
        self.home = settings.place(settings.home, machine, "home")
        self.shift = self.offsets.shift()
        self.motion = self.dialect.start_motion
        self.scale = INCH if settings.units == "inch" else 1.0

    @property
    def mode(self) -> Mode:
        """What holds for the moves that follow."""
        return Mode(
            self.tip, self.offsets.excess if self.tip else 0.0, self.feed_mode, self.scale, self.spindle, self.plane,
            self.arc_absolute, self.tool, self.operation,
        )  # fmt: skip

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
