"""How fast a tool runs over the workpiece while all axes of its machine move linearly."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.series import Series
from gearsim.machines.chain import Machine

_RADIAL = 1e-6


def fastest_axis(machine: Machine, before: NDArray, change: NDArray) -> NDArray:
    """Largest speed on the workpiece of the tool's axis up to z = 0 [mm per block], (n,); all axes change linearly.

    In the frame that turns with the table a point of the tool is linear in time, so its velocity is, too, and its
    speed is largest at one end of the block; along the tool it is largest at one end of the length in question.
    """
    speeds = []
    for at in (before, before + change):
        axes = [Series(np.stack([at[:, i], change[:, i]])) for i in range(at.shape[1])]
        pose = machine.forward_series(axes)
        upright = pose.axis.value[:, 2] > _RADIAL
        rise = np.where(upright, pose.axis.value[:, 2], 1.0)
        length = np.where(upright, np.maximum(-pose.tip.value[:, 2], 0.0) / rise, 0.0)
        for up in (0.0, length[:, None]):
            speeds.append(np.linalg.norm(pose.tip.c[1] + up * pose.axis.c[1], axis=-1))
    return np.max(speeds, axis=0)
