"""The ruled spiral bevel tooth slot (Zhou 2015, sections 3.2 and 3.3) in closed form.

A circular arc in the crown gear's reference plane is wound onto the pitch cone; in the plane normal to
the generator at each of its points stands one profile: bottom land, two fillets, two straight flanks.
The slot is symmetric in that plane, not in space: its walls are the ``convex`` and the ``concave`` flank.

Not in the source: the arc may be straight (`STRAIGHT`, an arc of infinite radius), and the slot may widen with the
cone distance, so that its width on the pitch cone is in proportion to it. Both together at a spiral angle of 0 are
the straight bevel gear: flanks in planes through the apex.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, inf, pi, sin, tan
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearsim.errors import InputError
from gearsim.geometry import series
from gearsim.geometry.series import Series
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Side
from gearsim.surfaces.ruled_patch import ToothPatch
from gearsim.surfaces.slot_checks import check_slot

STRAIGHT = inf
"""The lengthwise radius [mm] of a straight lengthwise line."""


class Spine(NamedTuple):
    """Profile frames along the lengthwise curve, as series in its parameter phi (workpiece frame).

    phi [rad] is the arc's angle from the mean point; on a straight line the length over the mean cone distance.

    ``cone`` is the cone distance [mm]; x runs along the generator, z along the pitch cone's normal,
    y = z cross x; ``origin`` is the profile's origin on the root cone.
    """

    cone: Series
    origin: Series
    x: Series
    y: Series
    z: Series


@dataclass(frozen=True)
class RuledBevelTooth:
    """A slot of the ruled spiral bevel gear; lengths in mm, angles in rad (Zhou tables 3.3 and 3.7).

    ``hand`` is the gear's hand of spiral; ``start_angle`` turns the whole slot about the gear axis. ``tapered``:
    the slot's width on the pitch cone is in proportion to the cone distance, and ``bottom_half_width`` is that at the
    mean cone distance; else one profile stands all along.
    """

    blank: BevelBlank
    spiral_angle: float
    hand: Literal["left", "right"]
    lengthwise_radius: float
    bottom_half_width: float
    fillet_radius: float
    pressure_angle: float
    start_angle: float = 0.0
    tapered: bool = False

    def __post_init__(self) -> None:
        problems = []
        if not 0.0 < self.pressure_angle < 0.5 * pi:
            problems.append("the pressure angle must lie between 0 and 90 degrees")
        if self.fillet_radius < 0.0 or self.bottom_half_width < 0.0:
            problems.append("fillet radius and bottom half width must not be negative")
        elif self.fillet_height >= self.blank.whole_depth_at(self.blank.toe):
            problems.append(
                f"the fillet ends at height {self.fillet_height:.3g} mm, above the tooth's tip at the toe "
                f"({self.blank.whole_depth_at(self.blank.toe):.3g} mm): the working flank would be empty"
            )
        if not self.lengthwise_radius > 0.0:
            problems.append(f"the lengthwise radius {self.lengthwise_radius:g} mm must be positive")
        narrowest = self.bottom_half_width + min(self.widening * k * self.blank.face_width for k in (-0.5, 0.5))
        if not problems and narrowest < 0.0:
            problems.append(
                f"the bottom half width {self.bottom_half_width:g} mm at the mean cone distance must be at least "
                f"{self.bottom_half_width - narrowest:.4g} mm: the tapered slot has no bottom at its narrow end"
            )
        if problems:
            raise InputError("impossible ruled tooth: " + "; ".join(problems))

    @property
    def _turn(self) -> float:
        """theta_t of Zhou 3.17: the spiral angle's complement; its sign is the hand (left is positive)."""
        return (0.5 * pi - self.spiral_angle) * (1.0 if self.hand == "left" else -1.0)

    @property
    def widening(self) -> float:
        """Growth of the slot's half width over the cone distance, where it is tapered.

        At height 0 over the pitch cone it is to be w R / R_mean; the root cone's slope takes its share of that.
        """
        if not self.tapered:
            return 0.0
        blank, slope = self.blank, tan(self.pressure_angle)
        at_pitch = float(self.half_width(blank.dedendum_at(blank.mean)))
        return at_pitch / blank.mean - slope * tan(blank.pitch - blank.root_angle)

    def shift(self, spine: Spine) -> Series:
        """What the taper adds to the slot's half width [mm] along the spine."""
        return (spine.cone - self.blank.mean) * self.widening

    @property
    def _centre(self) -> complex:
        """The lengthwise circle's centre in the crown plane (Zhou 3.18), mean point on the real axis."""
        return self.blank.mean - self.lengthwise_radius * complex(cos(self._turn), sin(self._turn))

    def phi_at(self, cone: NDArray | float) -> NDArray:
        """Lengthwise parameters [rad] at which the curve reaches cone distances [mm] (inverse of 3.22).

        Raises InputError where the circle or line never comes that far in or out.
        """
        if self.lengthwise_radius == STRAIGHT:
            return self._along_the_line(np.asarray(cone, dtype=float))
        centre, radius = self._centre, self.lengthwise_radius
        cosine = (np.asarray(cone) ** 2 - abs(centre) ** 2 - radius**2) / (2.0 * radius * abs(centre))
        if np.abs(cosine).max(initial=0.0) > 1.0:
            raise InputError(
                f"the lengthwise circle of radius {radius:g} mm stays between cone distances "
                f"{abs(abs(centre) - radius):.4g} and {abs(centre) + radius:.4g} mm; "
                f"{np.min(cone):.4g} to {np.max(cone):.4g} mm is needed"
            )
        at_mean = (self._turn - atan2(centre.imag, centre.real) + pi) % (2.0 * pi) - pi
        return np.copysign(np.arccos(cosine), at_mean) - at_mean

    def _along_the_line(self, cone: NDArray) -> NDArray:
        """As `phi_at`, on a straight line: it comes as near to the apex as its foot."""
        mean, lean = self.blank.mean, -sin(self._turn)
        foot = mean * abs(cos(self._turn))
        if cone.min(initial=np.inf) < foot:
            raise InputError(
                f"the straight lengthwise line stays beyond cone distance {foot:.4g} mm; {cone.min():.4g} mm is needed"
            )
        return -lean + np.copysign(np.sqrt(np.maximum(cone**2 - foot**2, 0.0)) / mean, lean)

    def spine(self, phi: NDArray, order: int) -> Spine:
        """Profile frames at lengthwise parameters phi [rad], shape (n,), to a derivative order.

        Zhou 3.19-3.25 and 3.36-3.38. The crown-plane point is a complex number, whose logarithm holds the
        cone distance and the polar angle with all their derivatives (3.44; 3.26 prints cos for csc).
        """
        if self.lengthwise_radius == STRAIGHT:
            way = 1j * complex(cos(self._turn), sin(self._turn)) * self.blank.mean
            crown = Series.variable(phi, order) * way + self.blank.mean
        else:
            turn = Series.variable(phi, order) + self._turn
            crown = self.lengthwise_radius * series.exp(turn * 1j) + self._centre
        polar = series.log(crown)
        cone = series.exp(polar.real)
        pitch = self.blank.pitch
        around = series.exp((polar.imag / sin(pitch) + self.start_angle) * 1j)
        c, s, nil = around.real, around.imag, Series(np.zeros_like(cone.c))
        x = series.stack([c * sin(pitch), s * sin(pitch), nil + cos(pitch)])
        z = series.stack([c * cos(pitch), s * cos(pitch), nil - sin(pitch)])
        y = series.stack([s, -c, nil])
        slope = tan(pitch - self.blank.root_angle)
        depth = cone * slope + float(self.blank.dedendum_at(0.0))
        return Spine(cone, x * cone.column - z * depth.column, x, y, z)

    @property
    def fillet_height(self) -> float:
        """Height h [mm] of the fillet's end, where the working flank begins (Zhou 3.33)."""
        return self.fillet_radius * (1.0 - sin(self.pressure_angle))

    @property
    def fillet_half_width(self) -> float:
        """Half width [mm] of the slot where the working flanks begin (Zhou 3.33, taken positive)."""
        return self.bottom_half_width + self.fillet_radius * cos(self.pressure_angle)

    def half_width(self, h: NDArray | float) -> NDArray | float:
        """Half width [mm] of the slot at profile height h [mm] of the working flank (Zhou 3.34)."""
        return self.fillet_half_width + (h - self.fillet_height) * tan(self.pressure_angle)

    def across(self, spine: Spine) -> NDArray:
        """Ratio of a width normal to the lengthwise curve to the same width in the profile plane."""
        tangent = series.unit(spine.origin.derivative()).value
        return np.abs((np.cross(spine.z.value, tangent) * spine.y.value).sum(1))

    def side_sign(self, side: Side) -> float:
        """+1 where the wall stands on the profile's +y side: the convex one in a left-hand gear."""
        return (1.0 if side == "convex" else -1.0) * (1.0 if self.hand == "left" else -1.0)

    def flank(self, side: Side) -> ToothPatch:
        """The working flank of one side; v is the profile height h [mm]."""
        return ToothPatch(self, "flank", side)

    def fillet(self, side: Side) -> ToothPatch:
        """The fillet of one side; v is the arc angle [rad] from the bottom land."""
        return ToothPatch(self, "fillet", side)

    @property
    def bottom(self) -> ToothPatch:
        """The bottom land; v is the profile's y [mm], from the concave wall to the convex one."""
        return ToothPatch(self, "bottom", "convex")

    def check(self) -> None:
        """Raise InputError for a slot that no gear has (`check_slot`)."""
        check_slot(self.flank("concave"), self.flank("convex"), [self.bottom])

    @property
    def patches(self) -> list[ToothPatch]:
        """The whole slot, from the concave tip down and up to the convex tip."""
        concave, convex = ([self.flank(side), self.fillet(side)] for side in ("concave", "convex"))
        return [*concave, self.bottom, *reversed(convex)]
