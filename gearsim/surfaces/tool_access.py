"""How far down a space the end mill that generates one flank can go before it meets the other."""

from __future__ import annotations

from math import cos, sin, tan

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.geometry.involute import inverse_roll_inv
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign


def reachable_roll(gear: CylindricalGear, side: Side, tool_radius: float, z: float = 0.0) -> tuple[float, float]:
    """Rolls [rad] between which an end mill generates a flank at height z and leaves the involute on both.

    The cylinder's axis lies along the contact line, its end at the contact point, its flutes reach the top face.
    Empty where the first exceeds the second. The other flank counts beyond its root, too. Three limits:

    - the other flank: the distances of a point of the axis from the two flanks add up to 2 R_b cos(beta_b) (eta_b
      + s inv), so with y = xi + s N / R_b and N = r / cos(beta_b) the tool touches both where
      y - atan(y) = s (N / R_b - eta_b) (Groover 3.26 in closed form). That is the root end of the range; an
      external gear has it only if N > R_b eta_b.
    - the base circle: xi >= 0, and on concave flanks R_b xi / cos(beta_b) >= r (missing in Groover).
    - helical flanks: the contact line's roll changes by kappa for each mm of height (3.33 with abs(tan beta_b), and
      for external gears too): toward the root on flanks that face up, toward the tip on others. Flutes above must
      keep both limits; the tool's end meets the other flank r sin(beta_b) away in height. On the safe side by no
      more than kappa r sin(beta_b).
    """
    offset = tool_radius / (cos(gear.base_helix_angle) * gear.base_radius)
    faces_up = flank_sign(side) * gear.sign * gear.twist > 0.0
    above = abs(gear.twist * z)
    lean = max(above if faces_up else 0.0, abs(gear.twist * tool_radius * sin(gear.base_helix_angle)))
    turn = gear.sign * (offset - gear.space_half_angle)
    both = float(inverse_roll_inv(turn)) - gear.sign * offset
    if gear.is_internal:
        concave = tool_radius * cos(gear.base_helix_angle) / gear.base_radius + (0.0 if faces_up else above)
        return max(gear.tip_roll, concave), min(gear.root_roll, both - lean)
    base = above if faces_up else 0.0
    return max(gear.root_roll, base, both + lean if turn > 0.0 else 0.0), gear.tip_roll


def largest_tool_diameter(gear: CylindricalGear) -> float:
    """The end mill [mm] that touches both flanks of a space just as it generates them where the involute ends.

    That is at the root form circle (Groover's MATLAB program takes the tooth's width at the tip).
    """
    return tool_diameter_at(gear, gear.root_roll)


def tool_diameter_at(gear: CylindricalGear, roll: float) -> float:
    """The end mill [mm] that touches both flanks of a space just as it generates them at a roll [rad].

    Its centre then lies in the space's middle: tan(xi + s eta_b) = xi + s N / R_b, with N = r / cos(beta_b). A
    helical space takes less, by the lean that `reachable_roll` counts.
    """
    offset = gear.sign * gear.base_radius * (tan(roll + gear.sign * gear.space_half_angle) - roll)
    return 2.0 * offset * cos(gear.base_helix_angle)


def tool_reach(gear: CylindricalGear, roll: ArrayLike, tool_radius: float) -> NDArray:
    """Radii [mm] to which an end mill deepens the space as it generates the flank at rolls [rad], any shape.

    Beyond the root circle the tool cuts into the root.
    """
    centre = np.asarray(roll, dtype=float) + gear.sign * tool_radius * cos(gear.base_helix_angle) / gear.base_radius
    return gear.base_radius * np.hypot(1.0, centre) - gear.sign * tool_radius
