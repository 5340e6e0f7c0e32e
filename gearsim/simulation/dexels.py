"""Tri-dexels: three bundles of parallel rays through a box, and the stock left in them after cutting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Solid
from gearsim.simulation.intervals import IntervalSet, stretches, subtract
from gearsim.simulation.room import require_room

_MOST_CELLS = 20_000


@dataclass(frozen=True)
class DexelBox:
    """A box in a local frame: ``lower`` and ``upper`` corners [mm] and the ``pitch`` [mm] of its rays."""

    frame: Rigid
    lower: NDArray[np.floating]
    upper: NDArray[np.floating]
    pitch: float

    def __post_init__(self) -> None:
        if not np.all(self.upper - self.lower >= self.pitch):
            raise InputError(f"dexel pitch {self.pitch:g} mm is larger than the box {self.upper - self.lower} mm")
        longest = float(np.max(self.upper - self.lower))
        if not longest <= _MOST_CELLS * self.pitch:
            raise InputError(
                f"dexel pitch {self.pitch:g} mm is too fine: the box is {longest:.4g} mm long; wanted is at least "
                f"{longest / _MOST_CELLS:.2g} mm"
            )

        cells = (self.upper - self.lower) / self.pitch
        rays = sum(float(np.delete(cells, k).prod()) for k in range(3))
        require_room(rays, f"dexel pitch {self.pitch:g} mm", "raise simulation.dexel_pitch_mm")

    @property
    def counts(self) -> NDArray[np.integer]:
        """Rays along each edge of the box."""
        return np.ceil((self.upper - self.lower) / self.pitch).astype(int)

    def centres(self, axis: int) -> NDArray:
        """Cell centres along one edge [mm]; the cells are of one size, at most the pitch."""
        n = int(self.counts[axis])
        return self.lower[axis] + (self.upper[axis] - self.lower[axis]) * (np.arange(n) + 0.5) / n

    def cell_area(self, axis: int) -> float:
        """Cross-section [mm²] that one ray of a bundle stands for."""
        size = (self.upper - self.lower) / self.counts
        return float(np.delete(size, axis).prod())

    def rays(self, axis: int) -> RayBundle:
        """The bundle along local x, y or z (0, 1, 2), through the cell centres, first other axis slowest."""
        others = [k for k in range(3) if k != axis]
        first, second = np.meshgrid(*(self.centres(k) for k in others), indexing="ij")
        n = first.size
        local = np.empty((n, 3))
        local[:, axis] = self.lower[axis]
        local[:, others[0]], local[:, others[1]] = first.ravel(), second.ravel()
        direction = np.tile(self.frame.rotation[:, axis], (n, 1))
        length = np.full(n, float(self.upper[axis] - self.lower[axis]))
        return RayBundle(self.frame.point(local), direction, np.zeros(n), length)


@dataclass(frozen=True)
class DexelStock:
    """One bundle after cutting: the material left in the box and the volumes [mm³] before and after."""

    rays: RayBundle
    left: IntervalSet
    stock_volume: float
    left_volume: float

    @property
    def removed_volume(self) -> float:
        return self.stock_volume - self.left_volume

    def cut_points(self) -> tuple[NDArray, NDArray]:
        """Points [mm] where a segment ended the material, shape (n, 3), and the segments, shape (n,)."""
        ray = np.concatenate([self.left.ray, self.left.ray])
        tau = np.concatenate([self.left.lo, self.left.hi])
        segment = np.concatenate([self.left.lo_segment, self.left.hi_segment])
        made = segment >= 0
        ray, tau = ray[made], tau[made]
        return self.rays.origin[ray] + tau[:, None] * self.rays.direction[ray], segment[made]


def machined_stock(box: DexelBox, axis: int, blank: Solid, removed: IntervalSet) -> DexelStock:
    """What a blank leaves in one bundle of a box after the intervals ``removed`` are taken out."""
    rays = box.rays(axis)
    ray, start, end = blank.chords(rays.origin, rays.direction)
    start, end = np.clip(start, 0.0, rays.end[ray]), np.clip(end, 0.0, rays.end[ray])
    full = stretches(len(rays), ray, start, end)
    left = subtract(full, removed)
    area = box.cell_area(axis)
    return DexelStock(rays, left, area * full.length, area * left.length)
