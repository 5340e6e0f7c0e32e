"""How far a cutter at given poses stays off the intended slot: exact surfaces against the cutter's signed distance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.cutters.profile import Profile
from gearsim.errors import InputError
from gearsim.surfaces.patch import ToothSurface

_LENGTHS, _HEIGHTS = 65, 9
_STRIPS = {"flank": 3, "fillet": 1, "bottom": 1}
_ZOOMS = 14
_AT_ONCE = 1 << 20


class Closest(NamedTuple):
    """For poses, shape (n,): the least signed distance [mm] between cutter and slot (negative: it cuts the tooth),
    which of the patches it is on, and where, ``place`` (n, 3)."""

    distance: NDArray
    patch: NDArray
    place: NDArray


class _Net(NamedTuple):
    """A strip of a patch: its parameters over fractions of length and height, shape (lengths, heights), its points,
    and how far [mm] at most a point of the strip lies from one of the net."""

    patch: int
    u: NDArray
    v: NDArray
    points: NDArray
    near: float


@dataclass(frozen=True)
class SlotClearance:
    """The surfaces of one tooth slot, from toe to heel and from tip to tip; neighbouring slots are not looked at."""

    patches: Sequence[ToothSurface]

    def closest(self, cutter: Profile, tips: NDArray, axes: NDArray) -> Closest:
        """Where the cutter comes closest to the slot at poses: tips [mm] and unit axes, both shape (n, 3).

        Nets of points find the places that may be it, ever finer ones about each on the exact surface settle it: the
        distance is that of a point of the surface, so never less than the truth.
        """
        coarse = [self._on_net(net, cutter, tips, axes) for net in self._nets]
        bound = np.min([distance for distance, _ in coarse], axis=0)
        best = Closest(np.full(len(tips), np.inf), np.zeros(len(tips), dtype=int), np.zeros((len(tips), 3)))
        for net, (distance, at) in zip(self._nets, coarse, strict=True):
            asked = np.flatnonzero(distance - net.near <= bound)
            if len(asked):
                found, place = self._settled(net, cutter, tips[asked], axes[asked], at[asked])
                nearer = found < best.distance[asked]
                best.distance[asked[nearer]] = found[nearer]
                best.patch[asked[nearer]] = net.patch
                best.place[asked[nearer]] = place[nearer]
        return best

    def require_room(self, cutter: Profile, tips: NDArray, axes: NDArray, least: float, who: str, remedy: str) -> None:
        """Raise InputError where the cutter comes nearer than ``least`` [mm]: by whom what is cut, and what helps."""
        met = self.closest(cutter, tips, axes)
        i = int(np.argmin(met.distance))
        if met.distance[i] < least:
            patch = self.patches[met.patch[i]]
            cone, _ = patch.blank.cone_height(met.place[i])
            raise InputError(
                f"{who} cuts {-1e3 * met.distance[i]:.4g} um into the intended {patch.name} at cone distance "
                f"{cone:.4g} mm; {remedy}"
            )

    def _on_net(self, net: _Net, cutter: Profile, tips: NDArray, axes: NDArray) -> tuple[NDArray, NDArray]:
        """Least distance from a net's points, and which point (lengthwise, heightwise) it is."""
        points = net.points.reshape(-1, 3)
        least, index = np.empty(len(tips)), np.empty(len(tips), dtype=int)
        step = max(1, _AT_ONCE // len(points))
        for begin in range(0, len(tips), step):
            own = slice(begin, begin + step)
            distance = _distance(cutter, points, tips[own, None], axes[own, None])
            index[own] = np.argmin(distance, axis=1)
            least[own] = distance.min(axis=1)
        return least, np.stack(np.divmod(index, net.u.shape[1]), axis=1)

    def _settled(
        self, net: _Net, cutter: Profile, tips: NDArray, axes: NDArray, at: NDArray
    ) -> tuple[NDArray, NDArray]:
        """The least distance on a strip, and where, by halving a window of five by five points about it."""
        last = np.array(net.u.shape) - 1.0
        at, half = at.astype(float), 1.0
        offsets = np.stack(np.meshgrid(*[np.linspace(-1.0, 1.0, 5)] * 2, indexing="ij"), axis=-1).reshape(-1, 2)
        every = np.arange(len(tips))
        for _ in range(_ZOOMS):
            asked = np.clip(at[:, None] + half * offsets, 0.0, last)
            u, v = _between(net.u, asked), _between(net.v, asked)
            points = self.patches[net.patch].jet(u.ravel(), v.ravel()).r.reshape(*u.shape, 3)
            distance = _distance(cutter, points, tips[:, None], axes[:, None])
            best = np.argmin(distance, axis=1)
            at, half = asked[every, best], 0.5 * half
        return distance[every, best], points[every, best]

    @cached_property
    def _nets(self) -> tuple[_Net, ...]:
        nets = []
        for k, patch in enumerate(self.patches):
            edges = np.linspace(0.0, 1.0, _STRIPS[patch.part] + 1)
            nets += [self._net(k, low, high) for low, high in pairwise(edges)]
        return tuple(nets)

    def _net(self, k: int, low: float, high: float) -> _Net:
        shape, patch = (_LENGTHS, _HEIGHTS), self.patches[k]
        sides = np.linspace(0.0, 1.0, _LENGTHS), np.linspace(low, high, _HEIGHTS)
        u, v = patch.locate(*(g.ravel() for g in np.meshgrid(*sides, indexing="ij")))
        points = patch.jet(u, v).r.reshape(*shape, 3)
        cell = [np.nanmax(np.linalg.norm(np.diff(points, axis=axis), axis=-1)) for axis in (0, 1)]
        return _Net(k, u.reshape(shape), v.reshape(shape), points, 0.5 * float(np.hypot(*cell)))


def _distance(cutter: Profile, points: NDArray, tips: NDArray, axes: NDArray) -> NDArray:
    """Signed distances of points from the cutter, infinite where there is no point."""
    off = points - tips
    z = (off * axes).sum(axis=-1)
    r = np.linalg.norm(off - z[..., None] * axes, axis=-1)
    return np.where(np.isfinite(r), cutter.signed_distance(np.nan_to_num(r), np.nan_to_num(z)), np.inf)


def _between(net: NDArray, at: NDArray) -> NDArray:
    """A net's values, linear between its nodes, at node numbers (..., 2)."""
    low = np.minimum(at.astype(int), np.array(net.shape) - 2)
    a, b = np.moveaxis(at - low, -1, 0)
    i, j = np.moveaxis(low, -1, 0)
    here, there = net[i, j] * (1 - b) + net[i, j + 1] * b, net[i + 1, j] * (1 - b) + net[i + 1, j + 1] * b
    return here * (1 - a) + there * a
