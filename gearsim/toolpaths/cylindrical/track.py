"""A track: what the tool does on the gear, before it is put on a machine."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray


@dataclass(frozen=True)
class Track:
    """Stations of the tool: ``heading`` (n,) [rad] and ``tip`` (n, 3) [mm], workpiece frame; see ``GearTable``.

    ``rapid`` (n,) says how a station is reached from the one before. ``lever`` (n,) [mm], times the rate of the
    heading, bounds the speed of the contact on the way there (0 off the flank). ``lean`` (n,) [rad] is added to the
    tilt of the tool's axis.
    """

    heading: NDArray[np.floating]
    tip: NDArray[np.floating]
    rapid: NDArray[np.bool_]
    lever: NDArray[np.floating]
    lean: NDArray[np.floating]

    def __len__(self) -> int:
        return len(self.heading)

    @property
    def radius(self) -> NDArray:
        """Distance of the tips from the gear's axis [mm], (n,)."""
        return np.hypot(self.tip[:, 0], self.tip[:, 1])

    def reversed(self) -> Track:
        """The same stations in the opposite order, on a flank."""
        lever = np.concatenate([[0.0], self.lever[:0:-1]])
        return Track(self.heading[::-1], self.tip[::-1], self.rapid[::-1], lever, self.lean[::-1])


def track(
    heading: ArrayLike, tip: NDArray, rapid: bool = False, lever: ArrayLike = 0.0, lean: ArrayLike = 0.0
) -> Track:  # fmt: skip
    """A track whose stations are all reached in one way; a heading, lever or lean may stand for all."""
    n = len(tip)
    heading, lever, lean = (np.broadcast_to(np.asarray(x, dtype=float), n) for x in (heading, lever, lean))
    return Track(heading, np.asarray(tip, dtype=float), np.full(n, rapid), lever, lean)


def join(*tracks: Track) -> Track:
    """Tracks one after the other."""
    columns = zip(*((t.heading, t.tip, t.rapid, t.lever, t.lean) for t in tracks), strict=True)
    return Track(*(np.concatenate(column) for column in columns))


def polar(radius: ArrayLike, angle: ArrayLike, z: ArrayLike) -> NDArray:
    """Points (n, 3) [mm] from cylindrical coordinates."""
    r, a, z = np.broadcast_arrays(np.atleast_1d(radius), angle, z)
    return np.stack([r * np.cos(a), r * np.sin(a), z], axis=-1)


def moved_out(tip: NDArray, radius: float, z: float | None = None) -> NDArray:
    """A tip (3,) moved radially to a radius, and to a height where one is given, as (1, 3)."""
    out = tip * (radius / np.hypot(tip[0], tip[1]), radius / np.hypot(tip[0], tip[1]), 1.0)
    if z is not None:
        out[2] = z
    return out[None]


def across(heading: float) -> NDArray:
    """The direction (3,) in which the tangent to the base cylinder leaves the touch point at a heading."""
    return np.array([sin(heading), -cos(heading), 0.0])
