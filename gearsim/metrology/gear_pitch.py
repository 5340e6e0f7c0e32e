"""Pitch deviations and runout of a cylindrical gear from its flanks at the measuring circle (ISO 1328-1:2013).

Flanks are numbered by their spaces, counter-clockwise as seen from the datum face. A pitch deviation is positive where
the arc from the flank before is too long.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side, flank_sign


@dataclass(frozen=True)
class PitchResult:
    """Pitch deviations [um] of the |z| flanks of one side, arcs at the measuring circle; nan where not ``complete``.

    ``single_um`` (|z|,): f_pi from the flank before; ``cumulative_um`` (|z|,): F_pi, the place of each flank against
    flank 0.
    """

    side: Side
    single_um: NDArray[np.floating]
    cumulative_um: NDArray[np.floating]

    @property
    def complete(self) -> bool:
        """Whether every flank was measured."""
        return bool(np.isfinite(self.cumulative_um).all())

    @property
    def single(self) -> float:
        """f_p [um]: the largest single pitch deviation, without its sign."""
        return float(np.max(np.abs(self.single_um)))

    @property
    def total(self) -> float:
        """F_p [um]: the total cumulative pitch deviation."""
        return float(np.ptp(self.cumulative_um))


@dataclass(frozen=True)
class Runout:
    """``radial_um`` (|z|,): how far outward a ball sits that touches both flanks of each space at the circle."""

    radial_um: NDArray[np.floating]

    @property
    def total(self) -> float:
        """F_r [um]."""
        return float(np.ptp(self.radial_um))


def pitch_deviations(
    gear: CylindricalGear, side: Side, normal_mm: ArrayLike, radius: float | None = None
) -> PitchResult:
    """Pitch deviations from the normal deviations (|z|,) [mm] of one side's flanks at one circle and one height z.

    A flank turned by an angle moves along its normal by -f s R_b cos(beta_b) times it. ``radius`` [mm] of the
    measuring circle: the reference circle unless given. Raises InputError unless there is a value for every flank
    (nan: not measured).
    """
    normal = _of_all_flanks(gear, side, normal_mm)
    turned = -flank_sign(side) * gear.sign * normal / (gear.base_radius * cos(gear.base_helix_angle))
    place = 1e3 * (gear.reference_radius if radius is None else radius) * turned
    if not np.isfinite(place).all():
        place = np.full_like(place, np.nan)
    return PitchResult(side, place - np.roll(place, 1), place - place[0])


def runout(gear: CylindricalGear, left_mm: ArrayLike, right_mm: ArrayLike, radius: float | None = None) -> Runout:
    """Runout from the normal deviations (|z|,) [mm] of the left and right flanks of all spaces at one circle.

    A ball that touches both flanks at the circle lies where their transverse normals meet the middle of the space:
    it sees the pressure angle xi + s eta_b, and by it moves outward s (left + right) / (2 sin) for transverse
    deviations. Raises InputError as ``pitch_deviations``.
    """
    left, right = _of_all_flanks(gear, "left", left_mm), _of_all_flanks(gear, "right", right_mm)
    angle = gear.roll(gear.reference_radius if radius is None else radius) + gear.sign * gear.space_half_angle
    return Runout(1e3 * gear.sign * (left + right) / (2.0 * sin(angle) * cos(gear.base_helix_angle)))


def _of_all_flanks(gear: CylindricalGear, side: Side, normal_mm: ArrayLike) -> NDArray:
    normal = np.asarray(normal_mm, dtype=float)
    if normal.shape != (gear.count,):
        raise InputError(f"pitch, {side} flanks: deviations have shape {normal.shape}, expected ({gear.count},)")
    return normal
