"""From a generating motion to a machine's table of axis values (Litvin and Chen 1994, sections 2 and 3).

The head's frame, known at every roll angle, is handed to the machine's inverse at evenly spaced ones: their
(1), (2) and (16) to (19) for the Phoenix, the same for any machine that reaches it. Between two rows all axes
run linearly (`motion.axes.AxisMotion`), so the machined flank errs by the second order of the step.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry.pose import FrameSeries
from gearsim.machines.chain import Machine
from gearsim.machines.path import AxisPath, axis_values, axis_values_of_frames
from gearsim.motion.axes import AxisMotion

Frames = Callable[[NDArray, int], FrameSeries]


def roll_axes(
    machine: Machine,
    frames: Frames,
    start: float,
    end: float,
    rows: int,
    *,
    with_turn: bool = True,
    near: ArrayLike | None = None,
) -> AxisPath:
    """A table of ``rows`` axis values for the roll angles from ``start`` to ``end`` [rad], evenly spaced.

    ``frames`` takes roll angles, shape (n,), and an order (`CradleGenerator.frames`). ``with_turn``: the
    machine's last rotary axis carries the tool's own turn mu as well, which a head with evenly spaced blades
    needs only for face hobbing (18); otherwise it stays at zero, or the machine has none. ``near`` (k,) picks
    the branch: axis values to start near. Raises InputError for fewer than two rows, or where the machine
    cannot bring the tool there.
    """
    if rows < 2:
        raise InputError(f"a table of axis values needs at least 2 rows, got {rows}")
    tip, axis, radial = (part.value for part in frames(np.linspace(start, end, rows), 0))
    if not with_turn:
        return axis_values(machine, tip, axis, near)
    return axis_values_of_frames(machine, np.stack([radial, np.cross(axis, radial), axis], axis=-1), tip, near)


def roll_motion(path: AxisPath) -> AxisMotion:
    """What the machine makes of a table: all axes linear from row to row.

    Raises InputError where the table overruns the machine's travel.
    """
    if path.overruns:
        raise InputError(f"machine {path.machine.name}: " + "; ".join(str(o) for o in path.overruns))
    return AxisMotion(path.machine, path.values)
