"""Lost motion of axes: a carriage follows its drive by a play, and stays where it is until the play is used up.

The drive stands at c, the carriage at c + o with o from 0 to the play b: while the drive goes on in the positive
direction o falls to 0 and stays there; going back, o rises to b. Within a block o = clip(o - way, 0, b).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.programs.blocks import Blocks

_SHORTEST = 1e-9  # of a block's time


@dataclass(frozen=True)
class Stretches:
    """Parts of blocks in which what every axis has lost is linear in time; ``block`` (p,) is ascending.

    ``start`` and ``end`` (p,) are parts of the block's time, 0 to 1; ``before`` and ``after`` (p, k) [mm, rad] what is
    lost at both.
    """

    block: NDArray[np.integer]
    start: NDArray[np.floating]
    end: NDArray[np.floating]
    before: NDArray[np.floating]
    after: NDArray[np.floating]


def stretches(blocks: Blocks, play: NDArray, chosen: NDArray[np.integer]) -> Stretches:
    """The stretches of the ``chosen`` blocks, for plays (k,) [mm, rad], none of them negative.

    The axes start as after a way in the positive direction: nothing lost. The way of a block goes evenly from its
    start to its end: exact where all axes are linear; under tip control the play is used up in the right block, and an
    axis that turns back within one is off by at most its play there. Raises InputError for arcs in which one does.
    """
    _check_arcs(blocks, play)
    way = blocks.values - blocks.before
    first = np.concatenate([np.zeros((1, len(play))), _played(way, play)[:-1]])[chosen]
    way = way[chosen]
    moving = np.where(way == 0.0, 1.0, way)
    used_up = np.where(way == 0.0, 0.0, np.where(way > 0.0, first, first - play) / moving)
    edges = np.sort(np.concatenate([np.zeros((len(way), 1)), used_up], axis=1), axis=1)
    inside = (edges > _SHORTEST) & (edges < 1.0 - _SHORTEST) & (np.diff(edges, axis=1, prepend=-1.0) > _SHORTEST)
    inside[:, 0] = True
    row, start = np.nonzero(inside)[0], edges[inside]
    end = np.where(np.append(np.diff(row) > 0, True), 1.0, np.append(start[1:], 1.0))
    before, after = (np.clip(first[row] - way[row] * t[:, None], 0.0, play) for t in (start, end))
    return Stretches(chosen[row], start, end, before, after)


def _played(way: NDArray, play: NDArray) -> NDArray:
    """What is lost at the end of each of n ways (n, k), nothing being lost at the first one's start.

    Each takes o to clip(o - way, 0, play). Such maps, o to clip(o + shift, low, high), compose to their like, so that
    all first ones together are found by doubling.
    """
    shift, low, high = -way, np.zeros_like(way), np.broadcast_to(play, way.shape).copy()
    step = 1
    while step < len(way):
        own, least, most = shift[step:], low[step:], high[step:]
        joined = [np.clip(end[:-step] + own, least, most) for end in (low, high)]
        shift[step:] = own + shift[:-step]
        low[step:], high[step:] = joined
        step *= 2
    return np.clip(shift, low, high)


def _check_arcs(blocks: Blocks, play: NDArray) -> None:
    """Raise InputError for an arc that turns an axis with play back, where its radius points along that axis."""
    arcs = np.flatnonzero(blocks.sweep != 0.0)
    if not len(arcs) or not play[:3].any():
        return
    sweep, normal = blocks.sweep[arcs], np.eye(3)[blocks.normal[arcs]]
    arm = (blocks.before[arcs, :3] - blocks.centre[arcs]) * (1.0 - normal)
    side = np.cross(normal, arm) * np.sign(sweep)[:, None]
    angle = np.arctan2(side, arm) % np.pi
    first = np.where(angle > _SHORTEST, angle, np.pi)
    back = (first < np.abs(sweep)[:, None] - _SHORTEST) & (normal == 0.0) & (play[:3] > 0.0)
    if back.any():
        i, axis = np.argwhere(back)[0]
        block, machine = arcs[i], blocks.machine
        raise InputError(
            f"block {block + 1} (line {blocks.line[block]}) for {machine.name}: {machine.axes[axis]} turns back within "
            "an arc, where its backlash is not defined here; end the arc there, or write it as straight blocks"
        )
