"""Motions of a machine: what happens between two blocks of axis values (Zhou 2015, section 4.1.2, NC code).

With tool-centre-point control the tip runs straight on the workpiece while the rotary axes turn at constant
rates (4.15 to 4.17); without it all axes run linearly, and the tip's path is whatever the machine makes of it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.pose import FrameSeries, PoseSeries
from gearsim.geometry.series import Series
from gearsim.machines.chain import Machine


@dataclass(frozen=True)
class AxisMotion:
    """All axes linear in time between blocks: ``values`` (n, k) [mm, rad] in the machine's axis order.

    Raises InputError for fewer than two blocks or another number of axes.
    """

    machine: Machine
    values: NDArray[np.floating]

    def __post_init__(self) -> None:
        self.machine.constant(self.values)
        _check_count(len(self.values))

    @property
    def pieces(self) -> int:
        return len(self.values) - 1

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        """Poses at t (0 to 1) of the given pieces, both shape (n,)."""
        return self.frame(piece, t, order).pose

    def frame(self, piece: NDArray, t: NDArray, order: int) -> FrameSeries:
        """The same with the tool's own turn, for machines that control it."""
        return self.machine.frame_series(_linear(self.values, piece, t, order))


@dataclass(frozen=True)
class TipMotion:
    """Tool-centre-point control: straight tip, rotary axes linear in time.

    ``tips`` (n, 3) [mm], workpiece frame, are what a program with tool-centre-point control states; ``rotary``
    (n, r) [rad] are the machine's rotary axes in its order. Raises InputError for fewer than two blocks or
    shapes that do not fit.
    """

    machine: Machine
    tips: NDArray[np.floating]
    rotary: NDArray[np.floating]

    def __post_init__(self) -> None:
        names = [joint.name for joint in self.machine.joints if joint.is_rotary]
        if np.shape(self.tips) != (len(self.tips), 3) or np.shape(self.rotary) != (len(self.tips), len(names)):
            raise InputError(
                f"machine {self.machine.name}: expected tips of shape (n, 3) and rotary axes {', '.join(names)} of "
                f"shape (n, {len(names)}), got {np.shape(self.tips)} and {np.shape(self.rotary)}"
            )
        _check_count(len(self.tips))

    @property
    def pieces(self) -> int:
        return len(self.tips) - 1

    def pose(self, piece: NDArray, t: NDArray, order: int) -> PoseSeries:
        """Poses at t (0 to 1) of the given pieces, both shape (n,)."""
        return self.frame(piece, t, order).pose

    def frame(self, piece: NDArray, t: NDArray, order: int) -> FrameSeries:
        """The same with the tool's own turn, for machines that control it."""
        turns = _linear(self.rotary, piece, t, order)
        still = Series(np.zeros_like(turns[0].c))
        slides = len(self.machine.joints) - len(turns)
        turned = self.machine.frame_series([still] * slides + turns)
        tip = np.stack([s.c for s in _linear(self.tips, piece, t, order)], axis=-1)
        return FrameSeries(Series(tip), turned.axis, turned.radial)


def tip_control(machine: Machine, values: NDArray) -> TipMotion:
    """Axis values (n, k) [mm, rad] run with tool-centre-point control: same blocks, straight tip between them."""
    slides = sum(not joint.is_rotary for joint in machine.joints)
    return TipMotion(machine, machine.forward(values)[0], np.asarray(values, dtype=float)[:, slides:])


def _check_count(blocks: int) -> None:
    if blocks < 2:
        raise InputError(f"a motion needs at least 2 blocks of axis values, got {blocks}")


def _linear(rows: NDArray, piece: NDArray, t: NDArray, order: int) -> list[Series]:
    """Columns of rows (n, k), linear in t between consecutive rows, as series of shape (m,)."""
    piece, rows = np.asarray(piece), np.asarray(rows, dtype=float)
    time = Series.variable(t, order)
    start, change = rows[piece], rows[piece + 1] - rows[piece]
    return [time * change[:, i] + start[:, i] for i in range(rows.shape[1])]
