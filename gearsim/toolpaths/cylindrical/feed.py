"""How long blocks take: as fast as the feed allows at a block's fastest moment (Groover 2018, chapter 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.series import Series
from gearsim.machines.chain import Machine

LARGEST_F = 9999.0
SHORTEST_S = 60.0 / LARGEST_F
_RADIAL = 1e-6


def block_seconds(
    machine: Machine, values: NDArray, rapid: NDArray, lever: NDArray, table: int, feed: float
) -> NDArray:
    """Times [s] of the blocks that lead to axis values (n, k), (n,); nan for rapids and the first.

    The speeds on the gear of the tool's axis, from its end up to the top face, and of the contact, ``lever`` [mm] times
    the turn of axis ``table``, stay at or below ``feed`` [mm/min]; no block is shorter than an inverse-time F of
    9999 states.
    """
    before, change = values[:-1], np.diff(values, axis=0)
    contact = np.abs(change[:, table]) * lever[1:]
    way = np.maximum(fastest_axis(machine, before, change), contact)
    seconds = np.maximum(60.0 * way / feed, SHORTEST_S)
    return np.concatenate([[np.nan], np.where(rapid[1:], np.nan, seconds)])


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


def cutting_seconds(seconds: NDArray) -> float:
    """Time spent in feed [s]."""
    return float(np.nansum(seconds))
