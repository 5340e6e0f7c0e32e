"""Cylindrical involute gears, external and internal, after ISO 21771."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import atan, cos, degrees, isfinite, pi, sin, sqrt, tan
from numbers import Integral
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.errors import InputError
from gearsim.geometry.involute import inverse_roll_inv, roll_inv

Side = Literal["left", "right"]
SIDES: tuple[Side, Side] = ("left", "right")


def flank_sign(side: Side) -> int:
    """f of a flank: +1 for the right one, -1 for the left one (ISO 21771, seen from +z)."""
    if side not in SIDES:
        raise InputError(f"a flank is 'left' or 'right', got {side!r}")
    return 1 if side == "right" else -1


@dataclass(frozen=True)
class CylindricalGear:
    """A gear between its top face z = 0 and z = -facewidth; lengths in mm, angles in rad.

    | parameter | meaning |
    | --- | --- |
    | teeth | number of teeth z; negative: an internal gear |
    | module, pressure_angle | m_n and alpha_n in the normal section at the reference cylinder |
    | helix_angle | beta at the reference cylinder, positive: right hand (of the helix itself, internal too) |
    | facewidth | b |
    | profile_shift | x; positive thickens the teeth and moves them to the tip, internal too |
    | addendum, dedendum | of the basic rack, in modules |
    | tip_alteration | k, in modules; positive lengthens the teeth |

    Radii are positive, and an internal gear's tip circle lies inside its root circle: R_a = R + s (x + h_a + k) m_n,
    R_f = R - s (h_f - x) m_n, with s = sign(z). Raises InputError for gears that cannot be.
    """

    teeth: int
    module: float
    pressure_angle: float
    helix_angle: float = 0.0
    facewidth: float = 10.0
    profile_shift: float = 0.0
    addendum: float = 1.0
    dedendum: float = 1.25
    tip_alteration: float = 0.0

    @classmethod
    def from_transverse(
        cls,
        teeth: int,
        transverse_module: float,
        transverse_pressure_angle: float,
        helix_angle: float,
        facewidth: float,
        **rest: float,
    ) -> CylindricalGear:
        """The same gear from m_t and alpha_t: m_n = m_t cos(beta), tan(alpha_n) = tan(alpha_t) cos(beta)."""
        _check_angles(transverse_pressure_angle, helix_angle)
        module = transverse_module * cos(helix_angle)
        pressure_angle = atan(tan(transverse_pressure_angle) * cos(helix_angle))
        return cls(teeth, module, pressure_angle, helix_angle, facewidth, **rest)

    def __post_init__(self) -> None:
        _check_numbers(self)
        _check_angles(self.pressure_angle, self.helix_angle)
        _check_circles(self)
        _check_pointed(self)

    @property
    def sign(self) -> int:
        """s: +1 external, -1 internal."""
        return 1 if self.teeth > 0 else -1

    @property
    def is_internal(self) -> bool:
        return self.teeth < 0

    @property
    def count(self) -> int:
        """Number of teeth, |z|."""
        return abs(self.teeth)

    @property
    def transverse_module(self) -> float:
        return self.module / cos(self.helix_angle)

    @property
    def transverse_pressure_angle(self) -> float:
        return atan(tan(self.pressure_angle) / cos(self.helix_angle))

    @property
    def base_helix_angle(self) -> float:
        """beta_b, with the sign of the helix: tan(beta_b) = tan(beta) cos(alpha_t)."""
        return atan(tan(self.helix_angle) * cos(self.transverse_pressure_angle))

    @property
    def twist(self) -> float:
        """kappa [rad/mm]: the turn of a transverse section for each mm along +z."""
        return tan(self.base_helix_angle) / self.base_radius

    @property
    def lead(self) -> float:
        """Axial travel of a full turn [mm], positive for a right hand; infinite for a spur gear."""
        return 2.0 * pi / self.twist if self.twist else float("inf")

    @property
    def reference_radius(self) -> float:
        return 0.5 * self.count * self.transverse_module

    @property
    def base_radius(self) -> float:
        return self.reference_radius * cos(self.transverse_pressure_angle)

    @property
    def tip_radius(self) -> float:
        reach = (self.profile_shift + self.addendum + self.tip_alteration) * self.module
        return self.reference_radius + self.sign * reach

    @property
    def root_radius(self) -> float:
        return self.reference_radius - self.sign * (self.dedendum - self.profile_shift) * self.module

    @property
    def pitch_angle(self) -> float:
        """2 pi / |z| [rad]."""
        return 2.0 * pi / self.count

    @property
    def tooth_half_angle(self) -> float:
        """psi_b: half the angle of a tooth at the base circle [rad], also where flanks have no point there."""
        at_reference = (pi + 4.0 * self.profile_shift * tan(self.pressure_angle)) / (2.0 * self.count)
        return at_reference + self.sign * float(roll_inv(tan(self.transverse_pressure_angle)))

    @property
    def space_half_angle(self) -> float:
        """eta_b: half the angle of a space at the base circle [rad], pi/|z| - psi_b."""
        return pi / self.count - self.tooth_half_angle

    @property
    def tip_roll(self) -> float:
        """Roll angle at the tip circle [rad]; 0 where an internal gear's tip lies inside the base circle."""
        return _roll(self.tip_radius / self.base_radius)

    @property
    def root_roll(self) -> float:
        """Roll angle at the root circle [rad]; 0 where the root lies inside the base circle."""
        return _roll(self.root_radius / self.base_radius)

    @property
    def tip_form_radius(self) -> float:
        """Where the involute ends at the tip [mm]: the tip circle, or the base circle if that lies outside it."""
        return max(self.tip_radius, self.base_radius)

    @property
    def root_form_radius(self) -> float:
        """Where the involute ends at the root [mm]: the root or the base circle; no tool is thought of here."""
        return max(self.root_radius, self.base_radius)

    def roll(self, radius: ArrayLike) -> NDArray:
        """Roll angles [rad] of radii [mm], any shape. Raises InputError inside the base circle."""
        ratio = np.asarray(radius, dtype=float) / self.base_radius
        if not np.all(ratio >= 1.0 - 1e-12):
            raise InputError(
                f"no involute inside the base circle: a radius must be at least {self.base_radius:g} mm, "
                f"got {np.min(radius):g} mm"
            )
        return np.sqrt(np.maximum((ratio - 1.0) * (ratio + 1.0), 0.0))

    def radius(self, roll: ArrayLike) -> NDArray:
        """Radii [mm] of roll angles [rad], any shape."""
        return self.base_radius * np.hypot(1.0, np.asarray(roll, dtype=float))

    def half_space(self, radius: ArrayLike) -> NDArray:
        """Half the angle of a space [rad] at radii [mm] outside the base circle, any shape."""
        return self.space_half_angle + self.sign * roll_inv(self.roll(radius))

    def half_tooth(self, radius: ArrayLike) -> NDArray:
        """Half the angle of a tooth [rad] at radii [mm] outside the base circle, any shape."""
        return self.tooth_half_angle - self.sign * roll_inv(self.roll(radius))

    def space_centre(self, space: ArrayLike, z: ArrayLike) -> NDArray:
        """Polar angle phi [rad] of the middle of spaces 0 to |z| - 1 at heights z [mm]; space 0 on +X at z = 0."""
        return self.pitch_angle * np.asarray(space) + self.twist * np.asarray(z, dtype=float)

    def pointed_limit(self) -> float:
        """The tip radius [mm] at which teeth come to a point: the largest, or an internal gear's smallest.

        0 for an internal gear whose teeth still have thickness at the base circle.
        """
        turn = self.sign * self.tooth_half_angle
        if turn <= 0.0 and self.is_internal:
            return 0.0
        return float(self.radius(inverse_roll_inv(max(turn, 0.0))))

    def rack_form_roll(self, depth: float = 1.0) -> float:
        """Where a generating rack leaves the flank of an external gear [rad]; negative: it undercuts.

        ``depth`` is the rack's straight part below its datum line, in modules (ISO 53: h_FfP = 1).
        Raises InputError for an internal gear, which no rack can cut.
        """
        if self.is_internal:
            raise InputError("a rack cannot generate an internal gear; only external gears have a rack form circle")
        angle = self.transverse_pressure_angle
        return tan(angle) - (depth - self.profile_shift) * self.module / (self.base_radius * sin(angle))

    def undercut_limit(self, depth: float = 1.0) -> float:
        """The least profile shift x with which that rack does not undercut: h - |z| sin²(alpha_t) / (2 cos(beta)).

        Minus infinity for an internal gear, which no rack can cut.
        """
        if self.is_internal:
            return float("-inf")
        return depth - self.count * sin(self.transverse_pressure_angle) ** 2 / (2.0 * cos(self.helix_angle))

    def space_limit(self) -> float:
        """The root radius [mm] at which the flanks of a space meet: the smallest, or an internal gear's largest.

        0 for an external gear whose spaces are still open at the base circle.
        """
        turn = -self.sign * self.space_half_angle
        if turn <= 0.0 and not self.is_internal:
            return 0.0
        return float(self.radius(inverse_roll_inv(max(turn, 0.0))))


def _roll(ratio: float) -> float:
    return sqrt((ratio - 1.0) * (ratio + 1.0)) if ratio > 1.0 else 0.0


def _check_angles(pressure_angle: float, helix_angle: float) -> None:
    if not 0.0 < pressure_angle < 0.5 * pi:
        raise InputError(f"pressure angle must lie between 0 and 90 deg, got {degrees(pressure_angle):g} deg")
    if not abs(helix_angle) < 0.5 * pi:
        raise InputError(f"helix angle must lie between -90 and 90 deg, got {degrees(helix_angle):g} deg")


def _check_numbers(gear: CylindricalGear) -> None:
    for name in (f.name for f in fields(gear)):
        if not isfinite(getattr(gear, name)):
            raise InputError(f"{name} must be a finite number, got {getattr(gear, name)}")
    if not isinstance(gear.teeth, Integral) or gear.teeth == 0:
        raise InputError(f"teeth must be a whole number, negative for an internal gear and not 0; got {gear.teeth}")
    for name in ("module", "facewidth"):
        if getattr(gear, name) <= 0.0:
            raise InputError(f"{name} must be positive, got {getattr(gear, name):g} mm")


def _check_circles(gear: CylindricalGear) -> None:
    tip, root, base = gear.tip_radius, gear.root_radius, gear.base_radius
    height = gear.addendum + gear.tip_alteration + gear.dedendum
    if height <= 0.0:
        raise InputError(
            f"the tip circle lies below the root circle: addendum + tip_alteration + dedendum = {height:g}"
        )
    inner, outer = ("tip", "root") if gear.is_internal else ("root", "tip")
    radii = {"tip": tip, "root": root}
    if radii[inner] <= 0.0:
        limit = gear.reference_radius / gear.module
        what = "profile_shift + addendum + tip_alteration" if gear.is_internal else "dedendum - profile_shift"
        raise InputError(f"the {inner} radius is {radii[inner]:g} mm: {what} must be below {limit:g}")
    if radii[outer] <= base:
        raise InputError(
            f"no involute flank: the {outer} radius {radii[outer]:g} mm must exceed the base radius {base:g} mm"
        )


def _check_pointed(gear: CylindricalGear) -> None:
    for what, limit, radius, factor, sign in (
        ("teeth", gear.pointed_limit(), gear.tip_radius, "tip_alteration", gear.sign),
        ("spaces", gear.space_limit(), gear.root_radius, "dedendum", -gear.sign),
    ):
        if limit > 0.0 and sign * (limit - radius) <= 0.0:
            bound = "below" if sign > 0 else "above"
            best = getattr(gear, factor) - abs(radius - limit) / gear.module
            end = "tip" if what == "teeth" else "root"
            raise InputError(
                f"{what} come to a point: the {end} radius must stay {bound} {limit:.6g} mm, got {radius:.6g} mm; "
                f"{factor} must be below {best:.6g}"
            )
