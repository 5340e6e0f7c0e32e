"""The root of one space of a cylindrical gear as a surface: land, fillets and the walls under the involutes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearsim.surfaces.gear_outline import GearOutline
from gearsim.surfaces.involute import FlankJet, polar_frame
from gearsim.surfaces.patch import Way

_OFF = 1.618e-4  # of the facewidth: a ray in the very plane in which a tool's end moves touches it all along
_WINDOW = 0.2  # of the module: less than half a space and half a tooth


@dataclass(frozen=True)
class GearRoot:
    """The root of space 0 over u = way from its middle [mm], towards the right flank positive, and v = height z [mm].

    From flank to flank as the outline has it (a `surfaces.patch.Patch`); curvature jumps where its pieces meet.
    """

    outline: GearOutline

    @property
    def name(self) -> str:
        return "root"

    @property
    def blank(self) -> None:
        """No blank: a surface of its own, without bounds."""
        return None

    @property
    def ends(self) -> tuple[float, float, float]:
        """Where, from the middle on, the land, the fillet and the wall end [mm]."""
        outline, gear = self.outline, self.outline.gear
        land = gear.root_radius * outline.centre[1]
        fillet = land + outline.fillet * outline.span
        wall = 0.0 if gear.is_internal else max(gear.base_radius - outline.form_radius, 0.0)
        return land, fillet, fillet + wall

    @property
    def ways(self) -> tuple[Way, Way]:
        reach = self.ends[2]
        return Way("z along the face [mm]", 0.0, -self.outline.gear.facewidth), Way("across [mm]", -reach, reach)

    def locate(self, length: ArrayLike, height: ArrayLike) -> tuple[NDArray, NDArray]:
        """From the top to the bottom face, and across from the left to the right flank (as +y sees them)."""
        across = 2.0 * np.asarray(height, dtype=float) - 1.0
        down = np.asarray(length, dtype=float) + _OFF
        return self.ends[2] * across, -self.outline.gear.facewidth * down

    def windows(self, u: NDArray, v: NDArray) -> tuple[NDArray, NDArray]:
        reach = np.full(np.shape(u), _WINDOW * self.outline.gear.module)
        return reach, reach

    def jet(self, u: ArrayLike, v: ArrayLike) -> FlankJet:
        """Points, tangents, second derivatives and normals at u and v [mm], shape (...)."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        turn, twist = self.outline.gear.twist * v, self.outline.gear.twist
        point, along, bend, normal = (_turned(part, turn) for part in self._section(u))
        up = np.array([0.0, 0.0, 1.0])
        r, rv = point + v[..., None] * up, twist * np.cross(up, point) + up
        lean = -twist * np.einsum("...i,...i->...", np.cross(up, point), normal)
        tilted = normal + lean[..., None] * up
        tilted /= np.linalg.norm(tilted, axis=-1, keepdims=True)
        return FlankJet(r, along, rv, bend, twist * np.cross(up, along), -(twist**2) * point, tilted)

    def _section(self, u: NDArray) -> tuple[NDArray, NDArray, NDArray, NDArray]:
        """Points, first and second derivatives and normals of the outline, shape (..., 3), each with its z = 0."""
        gear, (far, middle) = self.outline.gear, self.outline.centre
        way, side, s = np.abs(u), np.where(u < 0.0, -1.0, 1.0), gear.sign
        land, fillet, _ = self.ends
        out, around = polar_frame(np.minimum(way, land) / gear.root_radius)
        radius = np.full(u.shape, gear.root_radius)
        parts = [radius[..., None] * out, around, -out / gear.root_radius, s * out]
        if self.outline.fillet:
            turn = np.clip(way - land, 0.0, fillet - land) / self.outline.fillet
            axis, across = polar_frame(np.full(u.shape, middle))
            c, n = np.cos(turn)[..., None], np.sin(turn)[..., None]
            inward = s * c * axis - n * across
            arc = [far * axis - self.outline.fillet * inward, s * n * axis + c * across,
                   inward / self.outline.fillet, inward]  # fmt: skip
            parts = [np.where((way > land)[..., None], a, p) for a, p in zip(arc, parts, strict=True)]
        out, around = polar_frame(np.full(u.shape, gear.space_half_angle))
        wall = [(self.outline.form_radius + way - fillet)[..., None] * out, out, 0.0 * out, -around]
        mirror = np.stack([np.ones(u.shape), side, np.ones(u.shape)], axis=-1)
        point, along, bend, normal = (
            mirror * np.where((way > fillet)[..., None], w, p) for w, p in zip(wall, parts, strict=True)
        )
        return point, side[..., None] * along, bend, normal


def _turned(vectors: NDArray, turn: NDArray) -> NDArray:
    """Vectors (..., 3) turned about z by angles (...)."""
    c, s = np.cos(turn), np.sin(turn)
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.stack([c * x - s * y, s * x + c * y, z], axis=-1)
