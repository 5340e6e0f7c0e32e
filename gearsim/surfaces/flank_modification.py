"""Designed deviations of a gear flank: reliefs, slopes and crownings, in the normal section."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import CylindricalGear


@dataclass(frozen=True)
class Relief:
    """Material taken off from the roll ``start`` [rad] to the end of the flank, ``amount`` [mm] there.

    It grows with (roll - start) to the power ``power``: 1 linear, 2 parabolic.
    """

    amount: float
    start: float
    power: int = 1


@dataclass(frozen=True)
class FlankModification:
    """Deviations [mm] along the outward normal; amounts in the transverse plane are these over cos(beta_b).

    | parameter | meaning |
    | --- | --- |
    | tip_relief, root_relief | material taken off toward the end of the involute at the tip, at the root |
    | profile_slope | material added, linear in roll from 0 at the root end to the amount at the tip end |
    | profile_crowning | material taken off at both ends, parabolic in roll, 0 in the middle |
    | helix_slope | material added, linear from 0 at the top face to the amount at the bottom face |
    | helix_crowning | material taken off at both faces, parabolic, 0 in the middle of the facewidth |

    Raises InputError for numbers that are not finite or another power than 1 or 2.
    """

    tip_relief: Relief | None = None
    root_relief: Relief | None = None
    profile_slope: float = 0.0
    profile_crowning: float = 0.0
    helix_slope: float = 0.0
    helix_crowning: float = 0.0

    def __post_init__(self) -> None:
        for name, value in ((f.name, getattr(self, f.name)) for f in fields(self)):
            numbers = (value.amount, value.start) if isinstance(value, Relief) else (value or 0.0,)
            if not all(isfinite(x) for x in numbers):
                raise InputError(f"{name} must be of finite numbers, got {value}")
            if isinstance(value, Relief) and value.power not in (1, 2):
                raise InputError(f"{name} must be linear (power 1) or parabolic (power 2), got power {value.power}")

    def check(self, gear: CylindricalGear) -> None:
        """Raises InputError where a relief of this gear would begin outside the involute."""
        low, high = sorted((gear.root_roll, gear.tip_roll))
        for name in ("tip_relief", "root_relief"):
            relief = getattr(self, name)
            if relief is not None and not low < relief.start < high:
                raise InputError(
                    f"{name} must start within the flank's roll, {low:.6g} to {high:.6g} rad, got {relief.start:g}"
                )

    @property
    def kinks(self) -> tuple[float, ...]:
        """Rolls [rad] at which reliefs begin."""
        return tuple(relief.start for relief in (self.tip_relief, self.root_relief) if relief is not None)

    def profile(self, gear: CylindricalGear, roll: NDArray) -> NDArray:
        """The part that depends on roll [rad], shape (n,), with its first and second derivative: shape (3, n)."""
        root, tip = gear.root_roll, gear.tip_roll
        along = _powers(roll, root, tip)
        total = self.profile_slope * along[1] + _crowning(self.profile_crowning, along)
        for relief, end in ((self.tip_relief, tip), (self.root_relief, root)):
            if relief is not None:
                fall = _powers(roll, relief.start, end)
                total = total - relief.amount * np.where(fall[1][0] > 0.0, fall[relief.power], 0.0)
        return total

    def lead(self, gear: CylindricalGear, z: NDArray) -> NDArray:
        """The part that depends on the height z [mm], shape (n,), with its derivatives: shape (3, n)."""
        along = _powers(z, 0.0, -gear.facewidth)
        return self.helix_slope * along[1] + _crowning(self.helix_crowning, along)


def _powers(x: NDArray, start: float, end: float) -> tuple[NDArray, NDArray, NDArray]:
    """t^0, t and t² of t = (x - start) / (end - start), each with its derivatives by x: shape (3, n)."""
    rate = 1.0 / (end - start)
    t, one = rate * (x - start), np.ones(np.shape(x))
    powers = (one, 0 * one, 0 * one), (t, rate * one, 0 * one), (t * t, 2.0 * rate * t, 2.0 * rate**2 * one)
    constant, linear, square = (np.stack(p) for p in powers)
    return constant, linear, square


def _crowning(amount: float, along: tuple[NDArray, NDArray, NDArray]) -> NDArray:
    """-amount (2 t - 1)²."""
    constant, linear, square = along
    return -amount * (4.0 * square - 4.0 * linear + constant)
