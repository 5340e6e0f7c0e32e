"""How the machine that cuts differs from the one that was planned for: errors whose effect is known by their cause."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from gearsim.cutters.end_mills import flat
from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.rigid import Rigid
from gearsim.machines.chain import Machine
from gearsim.machines.errors import MachineErrors, RealMachine, RotaryErrors
from gearsim.programs.operation import Tool


@dataclass(frozen=True)
class Disturbance:
    """Errors of the real machine, tool and set-up [mm].

    | error | meaning |
    | --- | --- |
    | tool_radius | the end mill's radius is larger by this much |
    | tool_runout | the tool's axis lies this far off the spindle's: its flutes sweep a larger circle |
    | pivot | the first rotary axis of the table passes this far (X, Y, Z) off where the program puts it |
    | eccentricity | the gear's axis lies this far off the table's, along the gear's X |
    | axes | the errors of the machine's axes, the pivot's added to them |
    """

    tool_radius: float = 0.0
    tool_runout: float = 0.0
    pivot: tuple[float, float, float] = (0.0, 0.0, 0.0)
    eccentricity: float = 0.0
    axes: MachineErrors = field(default=MachineErrors())

    def cutter(self, tool: Tool) -> Profile:
        """What the spinning tool sweeps: a cylinder over its flutes."""
        return flat(tool.diameter + 2.0 * (self.tool_radius + abs(self.tool_runout)), tool.flute_length)

    def machine(self, nominal: Machine) -> RealMachine | None:
        """The machine that runs the program; None where its axes have no errors.

        Raises InputError where it has no rotary axis to be off, and for errors of axes that it has not.
        """
        if not any(self.pivot):
            return self.axes.real(nominal)
        turned = next((joint.name for joint in nominal.work if joint.is_rotary), None)
        if turned is None:
            raise InputError(f"pivot error: machine {nominal.name} has no rotary axis on the work side")
        own = self.axes.rotaries.get(turned, RotaryErrors())
        x, y, z = np.add(own.offset, self.pivot).tolist()
        rotaries = {**self.axes.rotaries, turned: replace(own, offset=(x, y, z))}
        return replace(self.axes, rotaries=rotaries).real(nominal)

    @property
    def mounting(self) -> Rigid:
        """From the table's frame to that of the gear as it is mounted."""
        return Rigid(np.eye(3), np.array([-self.eccentricity, 0.0, 0.0]))
