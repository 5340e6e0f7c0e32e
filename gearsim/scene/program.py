"""Table [program]: a toolpath as a program for a machine's controller, too."""

from __future__ import annotations

from pydantic import Field

from gearsim.machines.chain import Machine
from gearsim.programs.post_options import FeedMode, PostOptions
from gearsim.scene.catalogue import AnyMachine
from gearsim.scene.tables import Length, Table


class PostTable(Table):
    """How a program is written: its number, tool-centre-point control, decimals and feeds."""

    number: int = Field(default=1, ge=1, le=9999)
    tip_control: bool = True
    feed_mode: FeedMode = "inverse-time"
    linear_decimals: int = 4
    rotary_decimals: int = 4
    work_offset: str = "G54"

    def options(self) -> PostOptions:
        """Raises InputError for values that no control takes."""
        return PostOptions(
            linear_decimals=self.linear_decimals,
            rotary_decimals=self.rotary_decimals,
            feed_mode=self.feed_mode,
            work_offset=self.work_offset,
        )


class ProgramTable(PostTable):
    """Table [program]: the machine, its spindle speed and the cutter's flutes, beside how it is written."""

    machine: AnyMachine
    spindle_rpm: Length
    flutes: int = Field(ge=1, le=100)

    def controlled(self) -> Machine:
        machine: Machine = self.machine.build()
        return machine
