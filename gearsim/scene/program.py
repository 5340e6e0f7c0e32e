"""Table [program]: a toolpath as a program for a machine's controller, too."""

from __future__ import annotations

import re
from collections.abc import Collection
from math import radians
from typing import Annotated

from pydantic import AfterValidator, Field

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.programs.gcode import ReadSettings
from gearsim.programs.post_options import FeedMode, PostOptions
from gearsim.scene.bevel import Number
from gearsim.scene.catalogue import AnyRunMachine
from gearsim.scene.tables import Length, Table


def _offset_name(text: str) -> str:
    if not re.fullmatch(r"G5[4-9]|G59\.[1-3]|G54\.1 P([1-9]\d?|[12]\d\d|300)", text):
        raise ValueError(f"got {text!r}; expected G54 to G59, G59.1 to G59.3 or G54.1 P1 to G54.1 P300")
    return text


def _tool_number(text: str) -> str:
    if not re.fullmatch(r"[1-9]\d{0,7}", text):
        raise ValueError(f"got {text!r}; expected the number of an H or a T, for instance 12")
    return text


OffsetName = Annotated[str, AfterValidator(_offset_name)]
ToolNumber = Annotated[str, AfterValidator(_tool_number)]


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


class ControlTable(Table):
    """Table [control]: what the control knows beside a G-code program that is read.

    ``work_offsets``: places of zeros by their names (``"G55" = {X = 100.0, C = 90.0}``), mm and degrees in machine
    coordinates, that of the offset on the part among them. ``tool_lengths_mm``: by the numbers of H and T.
    ``start_tool``: the tool in the spindle before the first M6. ``unstated_is_zero``: offsets and lengths that nobody
    states are zero. ``least_increment_mm``: what X1 without a point is on the control (0: 1 mm).
    """

    work_offsets: dict[OffsetName, dict[str, Number]] = Field(default_factory=dict)
    tool_lengths_mm: dict[ToolNumber, Number] = Field(default_factory=dict)
    start_tool: int = Field(default=0, ge=0, le=99_999_999)
    unstated_is_zero: bool = False
    least_increment_mm: float = Field(default=0.0, ge=0.0, le=0.01, allow_inf_nan=False)

    def settings(self, workpiece: str, tools: Collection[int], machine: Machine) -> ReadSettings:
        """What the reader is told; ``workpiece`` is the offset that stands on the part.

        Raises InputError for axes that the machine has not, an unknown tool, and where the part's offset has no place.
        """
        if self.start_tool and self.start_tool not in tools:
            there = ", ".join(map(str, sorted(tools)))
            raise InputError(f"control.start_tool: no tool {self.start_tool}; tools has {there}")
        if self.work_offsets and workpiece not in self.work_offsets:
            raise InputError(
                f"control.work_offsets: {workpiece}, which stands on the part, is missing; the others are seen from it"
            )
        turned = {joint.name for joint in machine.joints if joint.is_rotary}
        reading = ReadSettings(
            workpiece=workpiece,
            offsets={
                name: {axis: radians(value) if axis in turned else value for axis, value in place.items()}
                for name, place in self.work_offsets.items()
            },
            tool_lengths={int(number): length for number, length in self.tool_lengths_mm.items()},
            tools=tuple(tools),
            start_tool=self.start_tool,
            unstated_is_zero=self.unstated_is_zero,
            least_increment=self.least_increment_mm,
        )
        for name, place in reading.offsets.items():
            reading.place(place, machine, f"control.work_offsets.{name}")
        return reading


class ProgramTable(PostTable):
    """Table [program]: the machine, its spindle speed and the cutter's flutes, beside how it is written.

    ``cut``: what is judged is what the machine does with this program; else, and without errors of the machine, the CL
    data.
    """

    cut: bool = False
    machine: AnyRunMachine
    spindle_rpm: Length
    flutes: int = Field(ge=1, le=100)

    def controlled(self) -> Machine:
        machine: Machine = self.machine.build()
        return machine
