"""Down to which depth a roughing cutter stays off the intended slot, and the passes that keep an allowance to it."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.geometry.series import Series
from gearsim.toolpaths.lengthwise_line import LengthwiseLine
from gearsim.toolpaths.roughing import RoughPath, Strategy, mouth_depth, root_depth, rough_pose
from gearsim.toolpaths.slot_clearance import Closest, SlotClearance

_BELOW = 1.0  # mm under the root, where every cutter cuts the bottom land
_ROUNDS = 60
_SETTLED = 1e-9
_STATIONS = 33
_MOST_PASSES = 200


class CriticalDepth(NamedTuple):
    """At places along a slot, shape (n,): ``depth`` H [mm] at which interference begins, and the tip's ``lift`` [mm]
    over the root cone there; ``met``: what the cutter touches."""

    depth: NDArray
    lift: NDArray
    met: Closest


def critical_depth(
    line: LengthwiseLine, slot: SlotClearance, cutter: Profile, strategy: Strategy, parameter: NDArray,
    allowance: float = 0.0,
) -> CriticalDepth:  # fmt: skip
    """How deep a cutter may go with ``allowance`` [mm] to the slot, at parameters of the line, shape (n,).

    With allowance 0 the depth at which interference begins (Zhou 2015, figure 4.12). Where nothing of the slot is near
    it lies a millimetre under the root. Raises InputError for a cutter that does not even enter the slot's mouth.
    """
    spine = line.frames(np.asarray(parameter, dtype=float), 0)

    def met(depth: NDArray, where: NDArray) -> Closest:
        tip, axis = (part.value[where] for part in rough_pose(line, strategy, spine, Series(depth[None])))
        return slot.closest(cutter, tip, axis)

    everywhere = np.ones(len(spine.cone.value), dtype=bool)
    above, root = mouth_depth(line, spine).value, root_depth(line, strategy, spine).value
    free = met(above, everywhere).distance - allowance
    if free.min() < 0.0:
        i = int(np.argmin(free))
        raise InputError(
            f"the roughing cutter does not enter the slot: with its tip on the face cone at cone distance "
            f"{spine.cone.value[i]:.4g} mm it misses {-free[i]:.4g} mm of an allowance of {allowance:g} mm; choose a "
            "smaller diameter or allowance"
        )
    depth = _last_free(lambda *at: met(*at).distance - allowance, above, root + _BELOW, free)
    return CriticalDepth(depth, root - depth, met(depth, everywhere))


def rough_paths(
    line: LengthwiseLine, slot: SlotClearance, cutter: Profile, strategy: Strategy, most: float, allowance: float
) -> list[RoughPath]:
    """Passes that each go at most ``most`` [mm] deeper, the last as deep as ``allowance`` [mm] to the slot lets it.

    The last one runs at one height over the root cone: the least that keeps the allowance all along. Raises InputError
    for a cutter that does not enter the slot, and for too many passes.
    """
    along = np.linspace(*line.ends, _STATIONS)
    lift = float(critical_depth(line, slot, cutter, strategy, along, allowance).lift.max())
    spine = line.frames(np.linspace(*line.face, _STATIONS), 0)
    way = float((root_depth(line, strategy, spine).value - lift - mouth_depth(line, spine).value).max())
    count = ceil(way / most - 1e-9)
    if not 1 <= count <= _MOST_PASSES:
        raise InputError(
            f"roughing {way:.4g} mm deep by {most:g} mm a pass takes {count} passes; expected 1 to {_MOST_PASSES}: "
            "choose another depth a pass"
        )
    return [RoughPath(line, strategy, (k + 1) / count, lift) for k in range(count)]


def _last_free(room: Callable[[NDArray, NDArray], NDArray], low: NDArray, high: NDArray, at_low: NDArray) -> NDArray:
    """Where falling functions reach 0 between ``low``, where they are not negative, and ``high`` (there, if nowhere).

    ``room`` takes arguments, shape (n,), and which of them are asked. By regula falsi with halved ends (Illinois), all
    at once; what is returned lies on the free side.
    """
    at_high, last = room(high, np.ones(len(high), dtype=bool)), np.zeros(len(low))
    low, high = np.where(at_high >= 0.0, high, low), high.copy()
    at_low, at_high = at_low.copy(), at_high.copy()
    for _ in range(_ROUNDS):
        asked = (high - low > _SETTLED) & (at_low > _SETTLED)
        if not asked.any():
            break
        a, b = at_low[asked], at_high[asked]
        middle = low.copy()
        middle[asked] += (high - low)[asked] * a / (a - b)
        now, again = room(middle, asked), last[asked]
        up = now >= 0.0
        at_low[asked] = np.where(up, now, np.where(again < 0.0, 0.5 * a, a))
        at_high[asked] = np.where(up, np.where(again > 0.0, 0.5 * b, b), now)
        last[asked] = np.where(up, 1.0, -1.0)
        low[asked], high[asked] = np.where(up, middle[asked], low[asked]), np.where(up, high[asked], middle[asked])
    return low
