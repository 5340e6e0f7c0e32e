"""A finished cylindrical gear as a solid whose faces are all named, each to be judged by a tolerance of its own."""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.gear_outline import FLANK, TIP, WALL, GearOutline
from gearsim.surfaces.part import Tolerance

_BLOCK = 1 << 18  # points located at once: each takes some dozens of numbers meanwhile


@dataclass(frozen=True)
class FinishedGear:
    """A gear between its faces, of whole teeth, with a bore (an internal one: an outside) of radius ``back`` [mm]; 0:
    none.

    Tolerances: ``flank`` of the faces left and right (the flanks of all spaces), ``root`` of the face root (root lands,
    fillets, and walls under the involutes), ``body`` of tip, top face, bottom face and bore or outside. ``design``:
    what the flanks are meant to deviate from involutes.
    """

    outline: GearOutline
    back: float
    flank: Tolerance
    root: Tolerance
    body: Tolerance
    design: FlankModification | None = None

    @property
    def volume(self) -> float:
        """Its volume [mm³] without the design, in closed form: a helix does not change a section."""
        return self.outline.area(self.back) * self.outline.gear.facewidth

    @property
    def tolerances(self) -> dict[str, Tolerance]:
        """Of each face, by its name, in the order in which ``by_face`` counts them."""
        flanks = {"left": self.flank, "right": self.flank}
        back = ("outside" if self.outline.gear.is_internal else "bore",) * (self.back > 0.0)
        return flanks | {"root": self.root} | dict.fromkeys(("tip", "top face", "bottom face", *back), self.body)

    def by_face(self, points: NDArray) -> tuple[NDArray, NDArray]:
        """Signed distances [mm] of points, shape (n, 3), negative inside, and which faces they are nearest to, (n,).

        Along normals, exactly beside lands, faces, flanks (helical ones, too) and a spur gear's fillets; beside a
        helical gear's fillets to the first order; no more than the true distance outside of two faces at once.
        """
        blocks = np.array_split(points, 1 + len(points) // _BLOCK)
        distance, face = zip(*map(self._locate, blocks), strict=True)
        return np.concatenate(distance), np.concatenate(face)

    def signed_distance(self, points: NDArray) -> NDArray:
        """Distances [mm] of points, shape (n, 3), as ``by_face`` gives them."""
        return self.by_face(points)[0]

    def _locate(self, points: NDArray) -> tuple[NDArray, NDArray]:
        gear = self.outline.gear
        radius, z = np.hypot(points[:, 0], points[:, 1]), points[:, 2]
        turn = np.arctan2(points[:, 1], points[:, 0]) - gear.twist * z
        turn -= gear.pitch_angle * np.round(turn / gear.pitch_angle)
        foot = self.outline.foot(radius, np.abs(turn))
        tooth = foot.distance / np.hypot(1.0, gear.twist * foot.lever)
        tooth -= np.where(foot.piece == FLANK, self._meant(radius, z, turn, tooth), 0.0)
        flank = np.where(turn * gear.sign < 0.0, 0, 1)
        tip = (foot.piece == TIP) | ((foot.piece == WALL) & gear.is_internal)
        face = np.where(foot.piece == FLANK, flank, np.where(tip, 3, 2))
        back = [gear.sign * (self.back - radius)] if self.back > 0.0 else []
        every = np.stack([tooth, z, -gear.facewidth - z, *back])
        nearest = np.argmax(every, axis=0)
        return every.max(axis=0), np.where(nearest == 0, face, nearest + 3)

    def _meant(self, radius: NDArray, z: NDArray, turn: NDArray, off: NDArray) -> NDArray:
        """How far [mm] flanks are meant to stand off involutes where points ``off`` those [mm] are nearest, (n,)."""
        if self.design is None:
            return np.zeros(radius.shape)
        gear = self.outline.gear
        lean = gear.base_helix_angle
        roll = gear.roll(np.maximum(radius, gear.base_radius)) - gear.sign * off * cos(lean) / gear.base_radius
        height = z - off * np.sign(turn) * sin(lean)
        return self.design.profile(gear, roll)[0] + self.design.lead(gear, height)[0]
