"""Where the flanks of a gear are probed: profile and helix lines and pitch points of every space, as rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearsim.geometry.rays import RayBundle, join_rays
from gearsim.metrology.gear_traces import GearTraces, helix_range, profile_range, transverse_um
from gearsim.metrology.samples import window_rays
from gearsim.surfaces.cylindrical_gear import CylindricalGear, Side
from gearsim.surfaces.flank_modification import FlankModification
from gearsim.surfaces.involute import InvoluteFlank

STATIONS = (0.1, 0.5, 0.9)
_EDGE = 1e-3  # of the facewidth: on the very edge of a face there is no normal


@dataclass(frozen=True)
class Probing:
    """Lines on the flanks of one side, the same on every space.

    Profiles run over ``roll`` (n,) [rad] from root to tip at the heights ``profile_z`` (k,) [mm]; helices over ``z``
    (m,) [mm] from the top face down at the rolls ``helix_roll`` (k,); one pitch point at the reference circle (the
    reached roll nearest to it) in the middle of the face.
    """

    gear: CylindricalGear
    side: Side
    roll: NDArray[np.floating]
    profile_z: NDArray[np.floating]
    z: NDArray[np.floating]
    helix_roll: NDArray[np.floating]

    @property
    def pitch_roll(self) -> float:
        """Roll [rad] of the pitch point."""
        return float(np.clip(self.gear.roll(self.gear.reference_radius), self.roll.min(), self.roll.max()))

    def rays(self, space: int) -> RayBundle:
        """Rays along the pure involute's normals: profiles, helices, the pitch point."""
        u = np.concatenate([np.tile(self.roll, len(self.profile_z)), np.repeat(self.helix_roll, len(self.z))])
        v = np.concatenate([np.repeat(self.profile_z, len(self.roll)), np.tile(self.z, len(self.helix_roll))])
        u, v = np.append(u, self.pitch_roll), np.append(v, -0.5 * self.gear.facewidth)
        flank = InvoluteFlank(self.gear, self.side, space)
        return window_rays(flank, u, v, flank.jet(u, v).normal)

    def traces(
        self, spaces: tuple[int, ...], normal_mm: NDArray, design: FlankModification | None
    ) -> tuple[GearTraces, GearTraces, NDArray]:
        """Profile and helix traces, and the pitch points' normal deviations [mm], from all rays' (spaces, rays)."""
        n, m, gear = self.profile_z.size * self.roll.size, self.helix_roll.size * self.z.size, self.gear
        um = transverse_um(normal_mm, gear.base_helix_angle)
        along = gear.base_radius * self.roll
        profile = GearTraces(
            "profile", self.side, spaces, tuple(map(float, self.profile_z)), along,
            um[:, :n].reshape(len(spaces), -1, self.roll.size), profile_range(float(along[0]), float(along[-1])),
            transverse_um(_designed(gear, design, self.roll, self.profile_z[:, None]), gear.base_helix_angle),
        )  # fmt: skip
        helix = GearTraces(
            "helix", self.side, spaces, tuple(float(d) for d in 2.0 * gear.radius(self.helix_roll)), self.z,
            um[:, n : n + m].reshape(len(spaces), -1, self.z.size), helix_range(gear.facewidth, gear.module),
            transverse_um(_designed(gear, design, self.helix_roll[:, None], self.z), gear.base_helix_angle),
        )  # fmt: skip
        return profile, helix, normal_mm[:, -1]


def probing(gear: CylindricalGear, side: Side, reached: tuple[float, float], points: int) -> Probing:
    """Lines of ``points`` each over the rolls ``reached`` [rad] from root to tip and over the whole facewidth."""
    root, tip = reached
    stations = np.array(STATIONS)
    return Probing(
        gear, side, np.linspace(root, tip, points), -stations * gear.facewidth,
        np.linspace(-_EDGE, _EDGE - 1.0, points) * gear.facewidth, root + stations * (tip - root),
    )  # fmt: skip


def _designed(gear: CylindricalGear, design: FlankModification | None, roll: NDArray, z: NDArray) -> NDArray:
    """Designed deviations [mm] at rolls and heights that broadcast."""
    roll, z = np.broadcast_arrays(roll, z)
    if design is None:
        return np.zeros(roll.shape)
    amount: NDArray = design.profile(gear, roll.ravel())[0] + design.lead(gear, z.ravel())[0]
    return amount.reshape(roll.shape)


def all_rays(probed: Probing, spaces: tuple[int, ...]) -> RayBundle:
    """The rays of one side's probing in some spaces, space after space."""
    return join_rays([probed.rays(space) for space in spaces])
