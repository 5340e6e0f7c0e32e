"""One step between two programmed poses, run in each of the ways Zhou tells apart (2015, section 4.1.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.machines.chain import Machine
from gearsim.machines.inverse import reach_tip
from gearsim.motion.axes import AxisMotion, TipMotion
from gearsim.motion.guiding import guided, line
from gearsim.motion.sources import CLMotion, CurveMotion


@dataclass(frozen=True)
class NCStep:
    """Two blocks of a program with tool-centre-point control, and the cutter it is for.

    ``tips`` (2, 3) [mm], workpiece frame; ``rotary`` (2, r) [rad] in the machine's order. All four motions
    pass through both poses; only what lies between differs.
    """

    cutter: Profile
    machine: Machine
    tips: NDArray[np.floating]
    rotary: NDArray[np.floating]

    @property
    def axes(self) -> NDArray[np.floating]:
        """The tool axis in both poses, (2, 3)."""
        turned = self.nc_tip.pose(np.zeros(2, dtype=int), np.array([0.0, 1.0]), 0)
        return turned.axis.value

    @property
    def theoretical(self) -> CurveMotion:
        """Tip and top of the cutter's axis guided along straight lines (4.4); the thesis leaves the curves open."""
        tops = self.tips + self.cutter.height * self.axes
        return guided(line(*self.tips), line(*tops))

    @property
    def cl(self) -> CLMotion:
        """Straight tip, axis turned in one plane at a constant rate (4.6 to 4.13)."""
        return CLMotion(self.tips, self.axes)

    @property
    def nc_tip(self) -> TipMotion:
        """NC code with tool-centre-point control (4.15 to 4.17)."""
        return TipMotion(self.machine, self.tips, self.rotary)

    @property
    def nc_axes(self) -> AxisMotion:
        """NC code with all axes linear: the slides that reach both tips, and the same rotary positions."""
        slides = len(self.machine.joints) - self.rotary.shape[1]
        values = np.hstack([np.zeros((2, slides)), self.rotary])
        return AxisMotion(self.machine, reach_tip(self.machine, values, self.tips))
