"""The patches of a ruled bevel tooth: bottom land, fillets and flanks as surfaces over the lengthwise curve."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, pi, sin, tan
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry import series
from gearsim.geometry.jets import SurfaceJet
from gearsim.geometry.series import Series
from gearsim.surfaces.blank import BevelBlank
from gearsim.surfaces.patch import Part, Side, Way, patch_name, slot_ways

if TYPE_CHECKING:
    from gearsim.surfaces.ruled_bevel import RuledBevelTooth, Spine


@dataclass(frozen=True)
class ToothPatch:
    """One part of the slot as a surface r(phi, v): ``flank``, ``fillet`` or ``bottom``."""

    tooth: RuledBevelTooth
    part: Part
    side: Side

    @property
    def name(self) -> str:
        return patch_name(self.part, self.side)

    @property
    def blank(self) -> BevelBlank:
        """The gear blank the tooth is cut into."""
        return self.tooth.blank

    @property
    def ways(self) -> tuple[Way, Way]:
        """Along the slot, and up or across it."""
        return slot_ways(self.blank, self.part)

    @property
    def parameters(self) -> tuple[str, str]:
        """What phi and v of a flank are called in tables."""
        return "phi_rad", "profile_height_mm"

    @property
    def start(self) -> float:
        """The v [mm or rad] at which the patch begins."""
        return {"flank": self.tooth.fillet_height, "fillet": 0.0, "bottom": -self.tooth.bottom_half_width}[self.part]

    def mean_profile(self, contact_height: float, offsets: NDArray) -> tuple[NDArray, NDArray, NDArray]:
        """phi, v and the plane's normal: see `ToothSurface`.

        The plane stands on the lengthwise curve's mean point, where phi is 0.
        """
        height = contact_height + np.asarray(offsets, dtype=float)
        return np.zeros(len(height)), height, self.tooth.spine(np.zeros(1), 0).x.value[0]

    def section(self, v: Series) -> tuple[Series, Series]:
        """The profile curve (y, z) [mm] in its plane as series in v (Zhou 3.32, 3.34)."""
        tooth, sign = self.tooth, self.tooth.side_sign(self.side)
        if self.part == "flank":
            return (sign * tan(tooth.pressure_angle)) * v + sign * float(tooth.half_width(0.0)), v
        if self.part == "bottom":
            return sign * v, v * 0.0
        turn = series.exp(v * 1j)
        y = (sign * tooth.fillet_radius) * turn.imag + sign * tooth.bottom_half_width
        return y, (-tooth.fillet_radius) * turn.real + tooth.fillet_radius

    def wall(self, spine: Spine) -> tuple[Series, Series]:
        """Origin and y direction of the profile along the spine: the taper moves walls, and stretches the bottom."""
        shift = self.tooth.shift(spine)
        if self.part == "bottom":
            half = self.tooth.bottom_half_width
            return spine.origin, spine.y * (shift * (1.0 / half) + 1.0).column if half else spine.y
        return spine.origin + spine.y * (shift * self.tooth.side_sign(self.side)).column, spine.y

    def jet(self, phi: NDArray, v: NDArray) -> SurfaceJet:
        """Points and derivatives, each of shape (n, 3), at parameters phi [rad] and v, shape (n,)."""
        phi, v = np.broadcast_arrays(np.asarray(phi, dtype=float), np.asarray(v, dtype=float))
        spine = self.tooth.spine(phi, 2)
        y, z = (s.column.derivatives() for s in self.section(Series.variable(v, 2)))
        o, ey, ez = (s.derivatives() for s in (*self.wall(spine), spine.z))
        lengthwise = [o[k] + y[0] * ey[k] + z[0] * ez[k] for k in range(3)]
        return SurfaceJet(
            lengthwise[0], lengthwise[1], y[1] * ey[0] + z[1] * ez[0], lengthwise[2],
            y[1] * ey[1] + z[1] * ez[1], y[2] * ey[0] + z[2] * ez[0], self.orientation,
        )  # fmt: skip

    @cached_property
    def orientation(self) -> float:
        """Sign that turns r_phi x r_v out of the material; phi runs heel to toe in a left-hand gear."""
        lengthwise = -1.0 if self.tooth.hand == "left" else 1.0
        return lengthwise * self.tooth.side_sign(self.side)

    def locate(self, length: NDArray, height: NDArray) -> tuple[NDArray, NDArray]:
        """Parameters (phi, v) of points given on the real blank, both shape (n,), each in [0, 1].

        ``length`` 0 is the toe, 1 the heel, by the point's own cone distance; ``height`` 0 is the patch's
        root-side edge, 1 its tip-side edge (for a flank, where it meets the face cone).
        """
        blank = self.tooth.blank
        length, height = np.broadcast_arrays(np.asarray(length, dtype=float), np.asarray(height, dtype=float))
        target = blank.toe + blank.face_width * length
        phi = self.tooth.phi_at(target)
        end = np.full(target.shape, self._nominal_end)
        for _ in range(30):
            if self.part == "flank":
                tip = self.jet(phi, end)
                cone, above = blank.cone_height(tip.r)
                end = end + np.asarray(blank.addendum_at(cone)) - above
            v = self.start + height * (end - self.start)
            at = self.jet(phi, v)
            step = (target - blank.cone_height(at.r)[0]) / self._cone_rate(at)
            phi = phi + step
            if np.abs(step).max(initial=0.0) < 1e-14:
                break
        return phi, v

    def windows(self, phi: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        """Half the tooth's thickness and half the slot's width [mm] about points, shape (n,).

        In the section normal to the lengthwise curve at the points' height; fillets and bottom land take
        the values where the working flank begins.
        """
        spine = self.tooth.spine(phi, 1)
        height = v if self.part == "flank" else np.full(np.shape(v), self.tooth.fillet_height)
        across = self.tooth.across(spine)
        slot = (np.asarray(self.tooth.half_width(height)) + self.tooth.shift(spine).value) * across
        radius = np.hypot(*spine.origin.value[:, :2].T) + height * cos(self.tooth.blank.pitch)
        return pi * radius / self.tooth.blank.teeth * across - slot, slot

    @property
    def _nominal_end(self) -> float:
        tooth = self.tooth
        if self.part == "flank":
            return float(tooth.blank.whole_depth_at(tooth.blank.mean))
        return tooth.bottom_half_width if self.part == "bottom" else 0.5 * pi - tooth.pressure_angle

    def _cone_rate(self, jet: SurfaceJet) -> NDArray:
        radius = np.hypot(jet.r[..., 0], jet.r[..., 1])
        radial = (jet.r[..., 0] * jet.ru[..., 0] + jet.r[..., 1] * jet.ru[..., 1]) / radius
        return radial * sin(self.tooth.blank.pitch) + jet.ru[..., 2] * cos(self.tooth.blank.pitch)
