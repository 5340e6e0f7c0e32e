"""What a cylindrical gear is cut out of: a disc or a ring."""

from __future__ import annotations

import numpy as np

from gearsim.geometry.turned import Turned
from gearsim.surfaces.cylindrical_gear import CylindricalGear


def gear_stock(gear: CylindricalGear, rim: float) -> Turned:
    """A disc with its real tip diameter, or a ring with that bore; ``rim`` [mm] of material behind the roots."""
    back = gear.root_radius - gear.sign * rim
    inner, outer = sorted((back, gear.tip_radius))
    b = gear.facewidth
    return Turned(np.array([[inner, 0.0], [outer, 0.0], [outer, -b], [inner, -b]]))
