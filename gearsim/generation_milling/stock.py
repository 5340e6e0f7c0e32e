"""What a gear is cut out of, and what is left of it: a disc or ring, the box around a space, a transverse section."""

from __future__ import annotations

from math import ceil, sin

import numpy as np

from gearsim.geometry.rays import RayBundle
from gearsim.geometry.rigid import Rigid
from gearsim.geometry.turned import Turned
from gearsim.simulation.dexels import DexelBox
from gearsim.surfaces.cylindrical_gear import CylindricalGear

_AROUND = 1.0


def gear_stock(gear: CylindricalGear, rim: float) -> Turned:
    """A disc with its real tip diameter, or a ring with that bore; ``rim`` [mm] of material behind the roots."""
    back = gear.root_radius - gear.sign * rim
    inner, outer = sorted((back, gear.tip_radius))
    b = gear.facewidth
    return Turned(np.array([[inner, 0.0], [outer, 0.0], [outer, -b], [inner, -b]]))


def space_box(gear: CylindricalGear, pitch: float) -> DexelBox:
    """The box around space 0, some of its teeth on both sides."""
    inner, outer = sorted((gear.root_radius, gear.tip_radius))
    middle = np.linspace(0.0, -gear.facewidth, 9)
    sweep = float(np.abs(gear.space_centre(0, middle)).max()) + 0.75 * gear.pitch_angle
    side = outer * sin(min(sweep, 1.5))
    lower = np.array([0.9 * inner - _AROUND, -side, -gear.facewidth - _AROUND])
    return DexelBox(Rigid(np.eye(3), np.zeros(3)), lower, np.array([outer + _AROUND, side, _AROUND]), pitch)


def section_rays(gear: CylindricalGear, rim: float, pitch: float) -> RayBundle:
    """Rays along x through the whole gear at half its facewidth."""
    radius = max(gear.tip_radius, gear.root_radius + rim * gear.is_internal) + _AROUND
    count = ceil(2.0 * radius / pitch)
    y = radius * (2.0 * (np.arange(count) + 0.5) / count - 1.0)
    origin = np.stack([np.full(count, -radius), y, np.full(count, -0.5 * gear.facewidth)], axis=1)
    return RayBundle(origin, np.tile([1.0, 0.0, 0.0], (count, 1)), np.zeros(count), np.full(count, 2.0 * radius))
