"""The conventional cradle generator of bevel and hypoid gears: settings to the head's motion past the gear.

Frames, all right-handed, z of the head and of the machine pointing from the tool into the gear:

- gear: z along the gear axis, pitch apex (crossing point) at the origin, the gear at rest;
- machine: z the cradle axis, x along the root line away from the apex, so that for a cradle at its centre
  the tip plane z = 0 touches the root cone;
- head: z the head's axis, x its reference direction.

From the gear outward (Zhou 2015, A.1, with the head's orientation of Litvin and Chen 1994, (9)):

    Rz(-work angle) . along z by -machine_centre_to_back . Ry(-(90 deg - machine_root_angle))
    . shift (0, blank_offset, -sliding_base) . Rz(cradle_angle + phi) . along x by radial_distance
    . Rz(swivel + 90 deg) . Ry(tilt)

Both papers describe this one machine: Litvin and Chen's x axis is the gear's z here, their -z the gear's x,
their cradle and pinion turn the other way (their theta_c is -cradle_angle). A vector in a plane is a complex
number and each turn a factor exp(i angle), so all derivatives come from truncated series.

The tool frame has its z axis from the tip to the shank: it is the head's, turned by 180 deg about x.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, degrees, pi, sin

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.pose import FrameSeries, PoseSeries
from gearsim.geometry.series import Series


@dataclass(frozen=True)
class CradleGenerator:
    """Machine settings; lengths in mm, angles in rad, signs as in Zhou (A.1).

    | setting | meaning |
    | --- | --- |
    | radial_distance | cradle axis to head centre (S_r) |
    | cradle_angle | head centre's direction from x at phi = 0 (basic cradle angle q); negative: left-hand gear |
    | machine_root_angle | gear axis to the machine's x axis (gamma_m) |
    | ratio_of_roll | work angle per cradle angle (m_bc) |
    | tilt, swivel | head axis against the cradle axis, and the direction it leans to (i, j) |
    | sliding_base | positive withdraws the tip plane from the gear (Delta X_B) |
    | blank_offset | cradle axis over the gear axis along y (Delta E_m) |
    | machine_centre_to_back | positive moves the cradle axis from the pitch apex against z (Delta X_D) |
    | modified_roll | C, D, E, F, ...: work angle = ratio (phi - C phi^2 - D phi^3 - ...) (Zhou 3.2) |

    Raises InputError for settings no machine has.
    """

    radial_distance: float
    cradle_angle: float
    machine_root_angle: float
    ratio_of_roll: float
    tilt: float = 0.0
    swivel: float = 0.0
    sliding_base: float = 0.0
    blank_offset: float = 0.0
    machine_centre_to_back: float = 0.0
    modified_roll: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        problems = []
        if self.radial_distance < 0.0:
            problems.append(f"radial distance {self.radial_distance:g} mm must not be negative (turn the cradle angle)")
        if not abs(self.tilt) < 0.5 * pi:
            problems.append(f"tilt {degrees(self.tilt):g} deg must lie between -90 and 90 deg")
        if not abs(self.machine_root_angle) <= 0.5 * pi:
            problems.append(
                f"machine root angle {degrees(self.machine_root_angle):g} deg must lie in -90 to 90 deg "
                "(is it in degrees?)"
            )
        if problems:
            raise InputError("impossible generator settings: " + "; ".join(problems))

    def work_angle(self, phi: Series) -> Series:
        """Rotation of the gear [rad] for a cradle rotation phi [rad]; derivatives included (Zhou 3.2, 3.3)."""
        polynomial = Series(np.zeros_like(phi.c))
        for coefficient in reversed(self.modified_roll):
            polynomial = (polynomial + coefficient) * phi
        return (phi - polynomial * phi) * self.ratio_of_roll

    def frames(self, phi: NDArray, order: int) -> FrameSeries:
        """The tool's frame in the gear frame as series in the cradle angle phi [rad], shape (n,).

        The tip is the head's centre in the tip plane, the axis points away from the gear.
        """
        angle = Series.variable(phi, order)
        cradle = series.exp((angle + self.cradle_angle) * 1j)
        lean = cradle * (1j * np.exp(1j * self.swivel))
        work = series.exp(self.work_angle(angle) * -1j)
        across = series.stack(
            [cradle * self.radial_distance + 1j * self.blank_offset, lean * sin(self.tilt), lean * cos(self.tilt)]
        )
        into = Series(np.zeros(across.c.shape)) + np.array([-self.sliding_base, cos(self.tilt), -sin(self.tilt)])
        tip, into_gear, radial = (Series(c) for c in np.moveaxis(self._turned(across, into, work.column).c, -2, 0))
        centre = np.array([0.0, 0.0, -self.machine_centre_to_back])
        return FrameSeries(tip + centre, -into_gear, radial)

    def poses(self, phi: NDArray, order: int) -> PoseSeries:
        """The head's centre and axis as series in the cradle angle phi [rad], shape (n,)."""
        return self.frames(phi, order).pose

    def plunge(self, back: NDArray, order: int) -> PoseSeries:
        """The cradle and the work at rest, the head ``back`` [mm] from full depth along its axis, shape (n,).

        The infeed of a non-generated (Formate) gear; series in ``back``.
        """
        tip, axis = self.poses(np.zeros(np.shape(back)), 0)
        infeed = Series.variable(back, order)
        still = Series(np.zeros((order + 1, *axis.value.shape)))
        return PoseSeries(infeed.column * axis.value + tip.value, still + axis.value)

    def other_hand(self) -> CradleGenerator:
        """The settings of the mirror image (y to -y): a cradle angle phi there is -phi here."""
        turned = tuple(c if k % 2 else -c for k, c in enumerate(self.modified_roll))
        return replace(
            self, cradle_angle=-self.cradle_angle, swivel=pi - self.swivel, blank_offset=-self.blank_offset,
            modified_roll=turned,
        )  # fmt: skip

    def _turned(self, across: Series, into: Series, work: Series) -> Series:
        """Machine-frame vectors (x + i y, z) in the gear frame: by the root angle, then by the work's turn."""
        c, s = cos(self.machine_root_angle), sin(self.machine_root_angle)
        planar = Series((across.real * s - into * c).c + 1j * across.imag.c) * work
        return series.stack([planar.real, planar.imag, across.real * c + into * s])
