"""How long blocks take: as fast as the feed allows at a block's fastest moment (Groover 2018, chapter 4)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearsim.machines.axis_speed import fastest_axis
from gearsim.machines.chain import Machine

LARGEST_F = 9999.0
SHORTEST_S = 60.0 / LARGEST_F


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


def cutting_seconds(seconds: NDArray) -> float:
    """Time spent in feed [s]."""
    return float(np.nansum(seconds))
