"""The transverse section of a finished cylindrical gear: root lands, fillets, flanks and tip lands in one outline."""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, atan2, cos, inf, pi, sin, sqrt
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry.involute import roll_inv
from gearsim.surfaces.cylindrical_gear import CylindricalGear

LAND, FILLET, WALL, FLANK, TIP = range(5)
_EDGE = 1e-9  # of a piece, in mm or rad: what lies on the joint of two belongs to one at least


class Foot(NamedTuple):
    """Of points, shape (n,): ``distance`` [mm] in the transverse plane, out of the material positive, the ``piece`` of
    the outline that is nearest, and the ``lever`` [mm] of its normal there about the gear's axis.
    """

    distance: NDArray[np.floating]
    piece: NDArray[np.integer]
    lever: NDArray[np.floating]


@dataclass(frozen=True)
class GearOutline:
    """Half a pitch of a gear's transverse section, from the middle of a space to the middle of a tooth.

    The root land on the root circle goes over into the flank by an arc of radius ``fillet`` [mm] tangent to both (0: a
    sharp corner). Where an external gear's root, or an internal one's tip, lies inside the base circle, a radial wall
    stands between the circle and where the involute begins. (ISO 53 gives the fillet of the rack; what it generates is
    a trochoid, an end mill's fillet is an arc.) Raises InputError for a fillet that does not fit the space.
    """

    gear: CylindricalGear
    fillet: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.fillet < inf:
            raise InputError(f"fillet_radius_mm must be 0 or more, got {self.fillet:g}")
        if not _fits(self.gear, self.fillet):
            raise InputError(
                f"fillet_radius_mm: an arc of {self.fillet:g} mm does not fit between the root circle and the flanks "
                f"of a space; it must be below {_largest(self.gear):.4g}"
            )

    @property
    def centre(self) -> tuple[float, float]:
        """Radius [mm] and angle [rad] from the space's middle of the fillet's centre."""
        return _centre(self.gear, self.fillet)

    @property
    def form_roll(self) -> float:
        """Where the involute ends at the root [rad]; 0 at a wall."""
        return _form_roll(self.gear, self.fillet)

    @property
    def form_radius(self) -> float:
        """Where the fillet ends on the flank, or on the radial wall below it [mm]."""
        gear, far = self.gear, self.centre[0]
        if _on_wall(gear, self.fillet):
            return sqrt(far**2 - self.fillet**2)
        return float(gear.radius(self.form_roll))

    @property
    def tip_angle(self) -> float:
        """From the space's middle to the edge of the tip land [rad]."""
        return float(self.gear.half_space(self.gear.tip_form_radius))

    @property
    def span(self) -> float:
        """Angle [rad] of the fillet's arc, from the root land on."""
        out, along = self._fillet_end
        return atan2(along, -self.gear.sign * out) if self.fillet else 0.0

    def half_angle(self, radius: NDArray) -> NDArray:
        """From the space's middle to the outline [rad] at radii [mm] between root and tip, any shape."""
        gear, (far, angle) = self.gear, self.centre
        flank = gear.half_space(np.maximum(radius, gear.base_radius))
        cosine = (radius**2 + far**2 - self.fillet**2) / (2.0 * radius * far)
        fillet = angle + np.arccos(np.clip(cosine, -1.0, 1.0))
        return np.where(gear.sign * (radius - self.form_radius) < 0.0, fillet, flank)

    def holds(self, radius: NDArray, angle: NDArray) -> NDArray:
        """Whether points at radii [mm] and angles [rad], 0 to pi/z from a space's middle, lie in the material, (n,)."""
        s, gear = self.gear.sign, self.gear
        inner, outer = sorted((gear.root_radius, gear.tip_radius))
        tooth = angle > self.half_angle(np.clip(radius, inner, outer))
        return (s * (radius - gear.tip_radius) < 0.0) & ((s * (radius - gear.root_radius) <= 0.0) | tooth)

    def foot(self, radius: NDArray, angle: NDArray) -> Foot:
        """Where points at radii [mm] and angles [rad], 0 to pi/z from a space's middle, are nearest to, shape (n,)."""
        pieces = (self._land, self._fillet, self._wall, self._flank, self._tip)
        away, lever = zip(*(piece(radius, angle) for piece in pieces), strict=True)
        nearest = np.argmin(away, axis=0)
        at = (nearest, np.arange(len(radius)))
        sign = np.where(self.holds(radius, angle), -1.0, 1.0)
        return Foot(sign * np.array(away)[at], nearest, np.array(lever)[at])

    def area(self, back: float) -> float:
        """Area [mm²] of the whole section between the outline and the circle of radius ``back`` [mm], in closed form.

        Seen from the axis the involute sweeps R_b² (xi_2³ - xi_1³) / 6, since r² d(phi) = R_b² xi² d(xi).
        """
        gear, (far, middle) = self.gear, self.centre
        lands = gear.root_radius**2 * middle + gear.tip_radius**2 * (pi / gear.count - self.tip_angle)
        involute = gear.base_radius**2 * abs(gear.tip_roll**3 - self.form_roll**3) / 3.0
        _, y = self._fillet_end
        arc = far * y - gear.sign * self.fillet**2 * self.span
        swept = lands + involute + arc - back**2 * pi / gear.count
        return gear.count * gear.sign * swept

    @property
    def _fillet_end(self) -> tuple[float, float]:
        """Where the fillet meets the flank, seen from its centre: outward and towards the flank [mm]."""
        far, middle = self.centre
        way = float(self.half_angle(np.array(self.form_radius))) - middle
        return self.form_radius * cos(way) - far, self.form_radius * sin(way)

    def _land(self, radius: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
        return _arc(radius, angle, self.gear.root_radius, 0.0, self.centre[1])

    def _tip(self, radius: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
        return _arc(radius, angle, self.gear.tip_radius, self.tip_angle, pi / self.gear.count)

    def _fillet(self, radius: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
        far, middle = self.centre
        out, along = radius * np.cos(angle - middle) - far, radius * np.sin(angle - middle)
        turn, reach = np.arctan2(along, -self.gear.sign * out), np.hypot(out, along)
        within = (turn >= -_EDGE) & (turn <= self.span + _EDGE) & (self.fillet > 0.0)
        lever = far * np.divide(along, reach, out=np.zeros_like(reach), where=reach > 0.0)
        return np.where(within, np.abs(reach - self.fillet), np.inf), lever

    def _wall(self, radius: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
        gear = self.gear
        start = gear.tip_radius if gear.is_internal else self.form_radius
        turn = angle - gear.space_half_angle
        out = radius * np.cos(turn)
        within = (out >= start - _EDGE) & (out <= gear.base_radius + _EDGE) & (start < gear.base_radius)
        return np.where(within, np.abs(radius * np.sin(turn)), np.inf), out

    def _flank(self, radius: NDArray, angle: NDArray) -> tuple[NDArray, NDArray]:
        gear, base = self.gear, self.gear.base_radius
        roll = np.sqrt(np.maximum((radius / base - 1.0) * (radius / base + 1.0), 0.0))
        off = base * (gear.space_half_angle + gear.sign * roll_inv(roll) - angle)
        foot = roll - gear.sign * off / base
        low, high = sorted((self.form_roll, gear.tip_roll))
        within = (radius >= base) & (foot >= low - _EDGE) & (foot <= high + _EDGE)
        return np.where(within, np.abs(off), np.inf), np.full(radius.shape, base)


def _arc(radius: NDArray, angle: NDArray, at: float, start: float, end: float) -> tuple[NDArray, NDArray]:
    """Distances from an arc about the gear's axis, and levers of its normals; beyond it from its ends."""
    beside = np.sin(0.5 * (angle - np.clip(angle, start, end)))
    return np.sqrt((radius - at) ** 2 + 4.0 * radius * at * beside**2), np.zeros(radius.shape)


def _on_wall(gear: CylindricalGear, fillet: float) -> bool:
    """Whether an external gear's fillet ends below the base circle."""
    return not gear.is_internal and (gear.root_radius + fillet) ** 2 - fillet**2 <= gear.base_radius**2


def _centre(gear: CylindricalGear, fillet: float) -> tuple[float, float]:
    """Radius [mm] and angle [rad] of a fillet's centre: on the flank's parallel, as far from the root circle; nan where
    there is none.
    """
    far, s = gear.root_radius + gear.sign * fillet, gear.sign
    if _on_wall(gear, fillet):
        return far, gear.space_half_angle - asin(fillet / far)
    if far < gear.base_radius:
        return far, float("nan")
    parallel = gear.space_half_angle - fillet / gear.base_radius
    return far, parallel + s * float(roll_inv(gear.roll(far)))


def _form_roll(gear: CylindricalGear, fillet: float) -> float:
    """Where a fillet ends on the involute [rad]; 0 below it."""
    if _on_wall(gear, fillet):
        return 0.0
    return float(gear.roll(gear.root_radius + gear.sign * fillet)) - gear.sign * fillet / gear.base_radius


def _fits(gear: CylindricalGear, fillet: float) -> bool:
    far, angle = _centre(gear, fillet)
    return far > 0.0 and angle >= 0.0 and gear.sign * (gear.tip_roll - _form_roll(gear, fillet)) > 0.0


def _largest(gear: CylindricalGear) -> float:
    """The largest fillet [mm] that fits, to a part in a billion."""
    low, high = 0.0, gear.root_radius
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _fits(gear, middle) else (low, middle)
    return low
