"""Headings and tips as axis values of a machine whose table turns the gear about its own axis."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Joint, Machine
from gearsim.machines.inverse import Solver, reach_tip, wrap

_OFF = 1e-9
_LEAN = 1e-3  # tilt [rad] by which a parallel tool axis shows which way the table's zero lies


@dataclass(frozen=True)
class GearTable:
    """A machine whose tool axis keeps its ``tilt`` [rad] from the gear's axis while the table turns the gear.

    At the heading theta the tool axis is T = (-sin theta sin tilt, cos theta sin tilt, cos tilt): tilt beta_b is the
    contact line of a flank, 0 an upright tool, 90 deg a radial one (at the polar angle theta + 90 deg). The table's
    value is theta plus a constant and the tilting axis stands still: on a B/C table C = theta - 90 deg, B = -tilt
    (Groover 3.38, 3.39, 3.44 with p = 1, without their arctangents). So a tip that moves linearly in the turning
    frame moves linearly in all axes, and spur gears, whose tool axis says nothing of C, need no rule of their own.

    Raises InputError where the axis nearest the workpiece is no table about the gear's axis.
    """

    machine: Machine
    tilt: float

    def __post_init__(self) -> None:
        self._sense  # noqa: B018 - checks the table
        self._still  # noqa: B018 - checks the tilt

    def values(self, heading: ArrayLike, tip: NDArray, lean: ArrayLike = 0.0) -> NDArray:
        """Axis values (n, k) [mm, rad] for headings (n,) [rad], not wrapped, and tips (n, 3) [mm].

        ``lean`` (n,) [rad] is added to the tilt.
        """
        table, tilting = (self.machine.column(joint) for joint in self._rotaries)
        values = np.zeros((len(tip), len(self.machine.axes)))
        zero, tilted = self._still[:2]
        values[:, table] = zero + self._sense * np.asarray(heading, dtype=float)
        values[:, tilting] = tilted + self._tilt_sense * np.asarray(lean, dtype=float)
        return reach_tip(self.machine, values, tip)

    def turned(self, values: NDArray, angle: float) -> NDArray:
        """Axis values that do the same to the gear turned by ``angle`` [rad]: only the table differs."""
        turned = np.array(values)
        turned[..., self.column] += self._sense * angle
        return turned

    @property
    def column(self) -> int:
        """The table's place among the axis values."""
        return self.machine.column(self._rotaries[0])

    @cached_property
    def _solver(self) -> Solver:
        return Solver(self.machine, frame=False)

    @property
    def _rotaries(self) -> tuple[Joint, ...]:
        return self._solver.rotaries[:2]

    @cached_property
    def _sense(self) -> float:
        """+1 where the table's axis points along the gear's, -1 where against it."""
        joint = self.machine.work[-1] if self.machine.work else None
        if joint is not None and joint.is_rotary:
            place = self.machine.work_mount.inverse()
            direction = place.direction(np.asarray(joint.direction))
            point = place.direction(np.asarray(joint.point)) + place.translation
            if abs(abs(direction[2]) - 1.0) < _OFF and np.hypot(*point[:2]) < _OFF:
                return float(np.sign(direction[2]))
        name = "none" if joint is None else joint.name
        raise InputError(
            f"machine {self.machine.name} cannot turn the gear: the work axis nearest the workpiece is {name}, it must "
            "be a rotary table about the gear's axis (z through the workpiece's origin)"
        )

    @cached_property
    def _still(self) -> tuple[float, float, int]:
        """The table's value at heading 0, the tilting axis's, and their branch: nearest -45 deg within its limits."""
        lean = self.tilt if abs(sin(self.tilt)) > _LEAN else _LEAN
        zeros = self._turn(lean)[0]
        _, tilts = self._turn(self.tilt)
        joint = self._rotaries[1]
        fits = (tilts >= joint.lower) & (tilts <= joint.upper)
        if not fits.any():
            tilted = " or ".join(f"{np.degrees(t):.4g}" for t in tilts)
            raise InputError(
                f"machine {self.machine.name}: axis {joint.name} must stand at {tilted} deg, outside its limits of "
                f"{np.degrees(joint.lower):.4g} to {np.degrees(joint.upper):.4g} deg"
            )
        best = int(np.argmin(np.where(fits, np.abs(wrap(zeros + 0.25 * pi)), np.inf)))
        return float(zeros[best]), float(tilts[best]), best

    @cached_property
    def _tilt_sense(self) -> float:
        """+1 where the tilting axis turns as the tool's tilt, -1 where against it."""
        _, still, branch = self._still
        leaning = self._turn(self.tilt + _LEAN)[1][branch]
        return float(np.sign(wrap(leaning - still)))

    def _turn(self, tilt: float) -> tuple[NDArray, NDArray]:
        """Both branches of table and tilting axis at heading 0."""
        first, second, _ = self._solver.turn(np.array([[0.0, sin(tilt), cos(tilt)]]))
        return first[:, 0], second[:, 0]
