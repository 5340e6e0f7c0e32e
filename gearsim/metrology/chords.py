"""Rays that look at a whole stock, and their chords in it: where there is material before anything is cut."""

from __future__ import annotations

import numpy as np

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.solid import Solid
from gearsim.simulation.dexels import DexelBox

_CELLS = 128


def blank_rays(stock: Solid) -> RayBundle:
    """Rays along x, y and z through a whole blank, 128 cells along its longest edge."""
    lower, upper = stock.box
    pitch = min(float((upper - lower).max()) / _CELLS, float((upper - lower).min()))
    box = DexelBox(Rigid(np.eye(3), np.zeros(3)), lower, upper, pitch)
    return join_rays([box.rays(axis) for axis in range(3)])


def stock_chords(stock: Solid, rays: RayBundle, least: float) -> RayBundle:
    """The rays' chords in a stock within their windows, a ray each; chords up to ``least`` [mm] are left out."""
    ray, start, end = stock.chords(rays.origin, rays.direction)
    start, end = np.maximum(start, rays.start[ray]), np.minimum(end, rays.end[ray])
    inside = end - start > least
    ray, start, end = ray[inside], start[inside], end[inside]
    return RayBundle(rays.origin[ray], rays.direction[ray], start, end)
