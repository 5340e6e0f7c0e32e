"""What a cylindrical gear is cut out of: a disc or a ring."""

from __future__ import annotations

import numpy as np

from gearsim.geometry.turned import Turned
from gearsim.surfaces.cylindrical_gear import CylindricalGear


def back_radius(gear: CylindricalGear, rim: float) -> float:
    """Radius [mm] of the bore, or of an internal gear's outside, with ``rim`` [mm] of material behind the roots.

    0: a gear without a bore, where the rim reaches to the axis.
    """
    return max(gear.root_radius - gear.sign * rim, 0.0)


def gear_stock(gear: CylindricalGear, rim: float) -> Turned:
    """A disc with its real tip diameter, or a ring with that bore; ``rim`` [mm] of material behind the roots."""
    inner, outer = sorted((back_radius(gear, rim), gear.tip_radius))
    b = gear.facewidth
    return Turned(np.array([[inner, 0.0], [outer, 0.0], [outer, -b], [inner, -b]]))
