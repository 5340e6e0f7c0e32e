"""The control both readers run a program on: offsets, tool table, home; what each of them wants to be told."""

from __future__ import annotations

from dataclasses import dataclass, field

from gearsim.machines.catalogue import table_table_bc
from gearsim.programs.gcode import ReadSettings

MACHINE = table_table_bc()
AXES = "XYZABC"
SYSTEMS = ("G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3")

INCH = 25.4
NO_TOOLS = {999: 0.0}  # a table has at least one row

Place = dict[str, float]


@dataclass(frozen=True)
class Control:
    """Tables in mm and degrees; the machine stands at its zero before the first block."""

    offsets: dict[str, Place] = field(default_factory=dict)
    tools: dict[int, float] = field(default_factory=dict)
    home: Place = field(default_factory=dict)
    block_delete: bool = False

    def settings(self) -> ReadSettings:
        """The control as gearsim's reader wants it."""
        return ReadSettings(
            offsets={name: _angles(place) for name, place in self.offsets.items()},
            tool_lengths=self.tools or NO_TOOLS,
            home=_angles(self.home),
            start={},
            block_delete=self.block_delete,
            block_limit=20_000,
        )

    def parameter_file(self) -> str:
        """LinuxCNC's file of parameters; the stand-alone interpreter's machine counts in inches."""
        values = {number: 0.0 for number in (*range(5161, 5170), *range(5181, 5190), *range(5210, 5220))}
        values[5220] = 1.0
        for i, name in enumerate(SYSTEMS):
            values |= {5221 + 20 * i + k: 0.0 for k in range(10)}
            values |= {
                5221 + 20 * i + AXES.index(axis): _inches(axis, v) for axis, v in self.offsets.get(name, {}).items()
            }
        values |= {5161 + AXES.index(axis): _inches(axis, v) for axis, v in self.home.items()}
        return "".join(f"{number}\t{value:.14f}\n" for number, value in sorted(values.items()))

    def tool_table(self) -> str:
        """LinuxCNC's tool table; a pocket for every tool."""
        table = self.tools or NO_TOOLS
        return "".join(f"T{number} P{number} Z{length / INCH:.14f} D0\n" for number, length in table.items())


def _angles(place: Place) -> Place:
    """Linear values as they are, rotary ones in radians."""
    degree = 0.017453292519943295
    return {axis: value * (degree if axis in "ABC" else 1.0) for axis, value in place.items()}


def _inches(axis: str, value: float) -> float:
    return value if axis in "ABC" else value / INCH
