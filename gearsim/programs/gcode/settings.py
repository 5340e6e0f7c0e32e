"""What a control knows beside the program: offsets, tool lengths, where home is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite
from typing import Literal

from gearsim.errors import InputError
from gearsim.machines.chain import Machine

_HOME_Z = 500.0


def _home() -> dict[str, float]:
    return {"Z": _HOME_Z}


@dataclass(frozen=True)
class ReadSettings:
    """The control's tables. Positions are by axis name, [mm] and [rad]; what is not named is zero.

    | setting | meaning |
    | --- | --- |
    | ``offsets`` | work offsets by name (``G54``, ``G54.1 P7``, ``G59.1``): the program's zero, machine coordinates |
    | ``workpiece`` | the offset that stands on the workpiece's origin: axis values count from it |
    | ``tool_lengths`` | by number: the length that stands in H and that tool T has; with none given all are zero |
    | ``home`` | where G28 goes, machine coordinates of the spindle nose (default: Z 500 mm, all others zero) |
    | ``start`` | where the spindle nose is before the first block, machine coordinates (default: at home) |
    | ``block_delete`` | whether lines that start with ``/`` are skipped |
    | ``units`` | what holds before G20 or G21 |
    | ``arc_tolerance`` | how far an arc's end may lie off its circle [mm] (None: the control's own limit) |
    | ``tools`` | the tools there are (None: any). With them given the program is meant to be cut: see ``Placing`` |
    | ``start_tool`` | the tool that is in the spindle before the first M6 (0: none) |
    | ``unstated_is_zero`` | whether, with ``tools``, offsets and lengths that nobody states are zero (else refused) |
    | ``least_increment`` | what a length without a decimal point counts in [mm]; an inch's is a tenth of that in |
    | | inches, an angle's as many degrees (0: numbers are read as a pocket calculator does: X10 is X10.) |
    | ``block_limit`` | how many lines may be executed before a loop counts as endless |

    Raises InputError for numbers that are not finite.
    """

    offsets: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    workpiece: str = "G54"
    tool_lengths: Mapping[int, float] = field(default_factory=dict)
    home: Mapping[str, float] = field(default_factory=_home)
    start: Mapping[str, float] | None = None
    block_delete: bool = False
    units: Literal["mm", "inch"] = "mm"
    arc_tolerance: float | None = None
    tools: tuple[int, ...] | None = None
    start_tool: int = 0
    unstated_is_zero: bool = False
    least_increment: float = 0.0
    block_limit: int = 1_000_000

    def __post_init__(self) -> None:
        places = [*self.offsets.items(), ("home", self.home), ("start", self.start or {})]
        numbers = [(f"{name}, axis {axis}", value) for name, place in places for axis, value in place.items()]
        numbers += [(f"tool_lengths, H{number}", value) for number, value in self.tool_lengths.items()]
        for name, value in [
            *numbers,
            ("arc_tolerance", self.arc_tolerance or 0.0),
            ("least_increment", self.least_increment),
        ]:
            if not isfinite(value):
                raise InputError(f"settings of the program reader, {name}: expected a finite number, got {value}")

    def place(self, position: Mapping[str, float], machine: Machine, name: str) -> list[float]:
        """A position as a list in the machine's axis order; ``name`` stands in the message.

        Raises InputError where it names an axis that the machine does not have.
        """
        for axis in position:
            if axis not in machine.axes:
                raise InputError(
                    f"settings of the program reader, {name}: machine {machine.name} has no axis {axis}; "
                    f"it has {', '.join(machine.axes)}"
                )
        return [float(position.get(axis, 0.0)) for axis in machine.axes]
