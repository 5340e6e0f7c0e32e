"""Blocks of a machine from a path of the tool: the inverse along the path, and the time each block takes."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.machines.chain import Machine
from gearsim.machines.path import axis_values
from gearsim.programs.blocks import Blocks
from gearsim.programs.cldata import RAPID, CLProgram


def blocks_from_path(
    machine: Machine,
    tips: NDArray,
    axes: NDArray,
    feed: float,
    tip_control: bool,
    *,
    rapid: ArrayLike = False,
    reach: float = 0.0,
    near: ArrayLike | None = None,
) -> Blocks:
    """Blocks from each point of a path to the next; tips [mm] and unit axes are (n, 3), workpiece frame.

    ``feed`` [mm/min] is what neither the tip nor the point ``reach`` [mm] up the tool axis runs faster than, both
    taken straight between the points. ``rapid`` (n - 1,) marks rapids; ``near`` as in ``axis_values``. Raises
    InputError for fewer than two points, a feed that is not positive, poses out of the machine's reach and
    travel limits overrun.
    """
    tips, axes = np.asarray(tips, dtype=float), np.asarray(axes, dtype=float)
    if len(tips) < 2:
        raise InputError(f"a path needs at least 2 points, got {len(tips)}")
    if not feed > 0.0:
        raise InputError(f"a feed must be positive, got {feed:g} mm/min")
    path = axis_values(machine, tips, axes, near)
    if path.overruns:
        raise InputError(f"machine {machine.name}: {path.overruns[0]}")
    n = len(tips) - 1
    moves_rapidly = np.broadcast_to(np.asarray(rapid, dtype=bool), (n,))
    ways = [np.linalg.norm(np.diff(tips + up * axes, axis=0), axis=1) for up in (0.0, reach)]
    seconds = np.where(moves_rapidly, np.nan, 60.0 * np.maximum(*ways) / feed)
    return Blocks(
        machine=machine,
        start=path.values[0],
        values=path.values[1:],
        rapid=moves_rapidly,
        tip_control=np.full(n, tip_control),
        seconds=seconds,
        line=np.zeros(n, dtype=int),
        tool=np.zeros(n, dtype=int),
        operation=np.zeros(n, dtype=int),
        sweep=np.zeros(n),
        centre=np.zeros((n, 3)),
        normal=np.full(n, 2),
    )


def blocks_from_cl(
    machine: Machine, program: CLProgram, feed: float, tip_control: bool, *, reach: float = 0.0
) -> Blocks:
    """Blocks of a whole CL program, rapids included; what lies between two of its paths is a rapid, too."""
    points = [len(path.tips) for path in program.paths]
    starts = np.cumsum([0, *points[:-1]])
    rapid = np.repeat([path.name == RAPID for path in program.paths], points)
    rapid[starts] = True
    tips, axes = (np.concatenate([getattr(p, part) for p in program.paths]) for part in ("tips", "axes"))
    same = np.concatenate([[False], (np.diff(np.hstack([tips, axes]), axis=0) == 0.0).all(axis=1)])
    return blocks_from_path(machine, tips[~same], axes[~same], feed, tip_control, rapid=rapid[~same][1:], reach=reach)
