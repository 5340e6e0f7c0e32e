"""One step between two programmed poses, run in each of the ways Zhou tells apart (2015, section 4.1.2)."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, radians, sin, tan

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.catalogue import apt
from gearsim.cutters.profile import Profile
from gearsim.machines.catalogue import head_head_cb
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


def zhou_apt_step(pivot_length: float = 200.0) -> NCStep:
    """Zhou's first example (2015, section 4.1.3, figure 4.5): an APT cutter on the C/B head.

    The head's ``pivot_length`` [mm] is ours; it moves nothing but ``nc_axes``.
    """
    cutter = _five_parameter_apt(45.0, 10.0, 3.0, radians(10.0), radians(10.0))
    return _step(cutter, pivot_length, (50.0, 50.0, 10.0), 18.0, 18.0)


def zhou_flat_step(pivot_length: float = 200.0) -> NCStep:
    """Zhou's second example (2015, section 4.1.3, figure 4.6): a flat end mill; see ``zhou_apt_step``."""
    cutter = _five_parameter_apt(35.0, 15.0, 0.0, 0.0, 0.0)
    return _step(cutter, pivot_length, (60.0, 60.0, 10.0), 18.0, 27.0)


def _step(cutter: Profile, pivot_length: float, end: tuple[float, float, float], b_deg: float, c_deg: float) -> NCStep:
    rotary = np.radians([[0.0, 0.0], [b_deg, c_deg]])
    return NCStep(cutter, head_head_cb(pivot_length), np.array([(0.0, 0.0, 0.0), end]), rotary)


def _five_parameter_apt(height: float, e: float, r: float, upper: float, lower: float) -> Profile:
    """APT cutter from Zhou's {H, R_l, R_t, psi_u, psi_l} (figure 4.1): the corner's tangency settles d and f."""
    f = r / cos(lower) + e * tan(lower)
    meet = (e + r * cos(upper) - (f - r * sin(upper)) * tan(upper)) / (1.0 - tan(lower) * tan(upper))
    return apt(2.0 * meet, r, e, f, lower, upper, height)
